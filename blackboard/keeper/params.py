"""Bounds and rhythms of the board keeper."""

from dataclasses import dataclass

from blackboard.parameters import require
from blackboard.vocabulary import MAX_MESSAGE_BYTES


@dataclass(frozen=True, slots=True, kw_only=True)
class KeeperParams:
    """What the keeper holds in memory at most, and how often it does what."""

    findable_envelopes: int = 4_000_000  # in the journal, for readers that missed some: 32 MB of memory for each robot
    answer_bytes: int = 64_000_000  # of what was missed, in one answer
    read_back_bytes: int = 16_000_000  # of journal, at a restart: minutes, and a quick start counts for more
    tombstones: int = 10_000  # retracted keys, so that nothing old brings them back
    robots: int = 64  # boards at most: a wrong program must not make one for each number it can think of
    boots: int = 1000  # starts of hosts whose positions are remembered, for each robot
    entry_bytes: int = MAX_MESSAGE_BYTES  # of one payload
    queue_envelopes: int = 200_000  # come, not looked at yet; what is beyond comes again by the posters' own doing
    queue_bytes: int = 256_000_000
    beat_s: float = 0.2
    beat_envelopes: int = 500  # a beat follows these at the latest
    gather_s: float = 0.001  # what comes within it is written in one go
    hung_s: float = 1.0  # a host that is linked and says nothing for so long hangs
    starting_s: float = 10.0  # one that has not said anything yet is still loading
    told_s: float = 60.0  # a silent start of a host stays in the beats for so long
    told_boots: int = 50  # those that stay in the beats after a restart, for as long
    checkpoint_s: float = 30.0
    checkpoint_bytes: int = 64_000_000  # of journal; what a restart has to read again

    def __post_init__(self) -> None:
        for name in (
            "findable_envelopes",
            "tombstones",
            "robots",
            "boots",
            "told_boots",
            "queue_envelopes",
            "beat_envelopes",
        ):
            require(getattr(self, name) >= 1, name, getattr(self, name), "1 and more")
        for name in ("answer_bytes", "read_back_bytes", "entry_bytes", "queue_bytes", "checkpoint_bytes"):
            require(getattr(self, name) >= 1000, name, getattr(self, name), "1000 bytes and more")
        for name in ("beat_s", "gather_s", "hung_s", "starting_s", "told_s", "checkpoint_s"):
            require(0 < getattr(self, name) <= 3600, name, getattr(self, name), "(0, 3600] seconds")
