"""What should have come by now, and has not: the figure behind `ski board status`.

A number is expected once a later one has come, or its host says that it was sent. Since it may be on its way, it counts as missing
only when it was expected a while ago.
"""

from dataclasses import dataclass

from blackboard.keeper.positions import BootLane, LanePositions
from blackboard.link.lanes import LANES

MAX_LANES = 10_000  # with what their hosts say; of boots long gone nothing more is expected


@dataclass(frozen=True, slots=True)
class LaneCount:
    """One lane's figures: numbers that its host sent (as far as is known), those held, those overdue."""

    host: str
    boot: str
    lane: str
    posted: int
    held: int
    missing: int


class Expectation:
    """Looks at the positions from time to time and remembers what was expected then."""

    def __init__(self) -> None:
        self._sent: dict[BootLane, int] = {}
        self._then: dict[BootLane, int] = {}
        self._before: dict[BootLane, int] = {}

    def say(self, host: str, boot: str, lanes: dict[str, int]) -> None:
        """Take note of what a host says that it has sent."""
        for lane in LANES:
            if lane in lanes:
                self._sent[(host, boot, lane)] = lanes[lane]

    def look(self, positions: LanePositions) -> None:
        """Remember what is expected at this moment; what was expected at the last look is due from now on."""
        self._before = self._then
        self._then = self._expected(positions)
        if len(self._sent) > MAX_LANES:
            known = dict(positions)
            self._sent = {name: number for name, number in self._sent.items() if name in known}

    def due_at_once(self, positions: LanePositions) -> None:
        """Take what is expected at this moment as due, as after a restart."""
        self._before = self._then = self._expected(positions)

    def counts(self, positions: LanePositions) -> list[LaneCount]:
        """Return the figures of every lane."""
        known = dict(positions)
        counts = []
        for name, posted in sorted(self._expected(positions).items()):
            position = known.get(name)
            due = self._before.get(name, 0)
            held = position.held(posted) if position is not None else 0
            missing = due - (position.held(due) if position is not None else 0)
            counts.append(LaneCount(*name, posted=posted, held=held, missing=missing))
        return counts

    def _expected(self, positions: LanePositions) -> dict[BootLane, int]:
        expected = {name: position.highest for name, position in positions}
        for name, number in self._sent.items():
            expected[name] = max(number, expected.get(name, 0))
        return expected
