"""What was posted, against what the keeper has written down: the proof that nothing was lost.

Posted is what the hosts themselves say: the last number of every lane of every boot in their beats, and what stands in a host's
outbox when it was killed. Written down is what stands in the keeper's journal, number by number. What the keeper refused has
come, and is counted for itself.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock

import msgspec

from blackboard.errors import MessageError
from blackboard.link.envelope import read_origin
from blackboard.messages.hosts import HostBeat

Stream = tuple[str, str, str]  # host, boot, lane
_ORIGIN = b'"origin":['
_BEAT = msgspec.json.Decoder(HostBeat)


@dataclass(frozen=True)
class Account:
    """The comparison at the end of a run."""

    posted: int
    written: int
    refused: int
    twice: int  # written down more than once
    missing: dict[Stream, list[int]]
    in_outboxes: int = 0  # envelopes that still wait
    missed: int = 0  # by the boards of all hosts together, by their own words
    boots: dict[str, int] = field(default_factory=dict)

    @property
    def lost(self) -> int:
        """How many entries nobody has any more."""
        return sum(len(numbers) for numbers in self.missing.values())


class Ledger:
    """Takes note of what was posted; any thread may tell."""

    def __init__(self) -> None:
        self._posted: dict[Stream, int] = {}
        self._missed: dict[tuple[str, str], int] = {}
        self._lock = Lock()

    def note(self, stream: Stream, number: int) -> None:
        """A number was posted, and so were all before it."""
        with self._lock:
            self._posted[stream] = max(number, self._posted.get(stream, 0))

    def note_beat(self, key: str, payload: bytes) -> None:
        """A host has told how far it has posted."""
        beat = _BEAT.decode(payload)
        self._missed[(key.split("/")[3], beat.boot)] = beat.missed
        for lane, number in beat.lanes.items():
            self.note((key.split("/")[3], beat.boot, lane), number)

    def note_outbox(self, folder: Path) -> int:
        """A host is gone: what stands in its outbox was posted. Return how much that is."""
        count = 0
        for attachment in _kept(folder):
            count += 1
            try:
                origin = read_origin(attachment)
            except MessageError:
                continue  # cut off in the middle of writing: it was not posted
            self.note((origin.host, origin.boot, origin.lane), origin.number)
        return count

    def account(self, journal: Path, outboxes: Iterable[Path] = ()) -> Account:
        """Compare with a keeper's journal, and look what still waits."""
        written: defaultdict[Stream, Counter[int]] = defaultdict(Counter)
        for line in _lines(journal):
            stream, number = _origin(line)
            written[stream][number] += 1
        refused: defaultdict[Stream, set[int]] = defaultdict(set)
        for line in _lines(journal.with_name("refused.jsonl")):
            stream, number = _origin(line)
            refused[stream].add(number)
        waiting = sum(1 for folder in outboxes for _ in _kept(folder))
        streams = {*self._posted, *written, *refused}
        missing, posted = {}, 0
        for stream in sorted(streams):
            last = max(self._posted.get(stream, 0), max(written[stream], default=0), max(refused[stream], default=0))
            posted += last
            gone = [n for n in range(1, last + 1) if n not in written[stream] and n not in refused[stream]]
            if gone:
                missing[stream] = gone
        return Account(
            posted=posted,
            written=sum(len(numbers) for numbers in written.values()),
            refused=sum(len(numbers) for numbers in refused.values()),
            twice=sum(n - 1 for numbers in written.values() for n in numbers.values()),
            missing=missing,
            in_outboxes=waiting,
            missed=sum(self._missed.values()),
            boots=dict(Counter(host for host, _ in {(host, boot) for host, boot, _ in streams})),
        )


def _lines(path: Path) -> Iterator[bytes]:
    if path.exists():
        with path.open("rb") as file:
            yield from (line for line in file if line.endswith(b"\n"))


def _origin(line: bytes) -> tuple[Stream, int]:
    """Return who sent what a line holds; raise ValueError where it does not say."""
    place = line.rfind(_ORIGIN)
    if place < 0:
        raise ValueError(f"a line of the keeper's without an origin: {line[:100]!r}")
    text = line[place + len(_ORIGIN) - 1 :]
    host, boot, lane, number = msgspec.json.decode(text[: text.index(b"]") + 1], type=tuple[str, str, str, int])
    return (host, boot, lane), number


def _kept(folder: Path) -> Iterator[bytes]:
    """Yield the attachments of what stands in an outbox, whole lines only."""
    for path in sorted(folder.glob("*.outbox")):
        for line in path.read_bytes().split(b"\n")[:-1]:
            yield line.partition(b"\t")[0]
