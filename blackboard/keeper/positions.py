"""Up to where every lane has come without a gap, and what came beyond the gaps: the proof that nothing is missing."""

from bisect import bisect_right
from collections import OrderedDict
from collections.abc import Iterator

from blackboard.link.envelope import Origin, Positions

MAX_GAPS = 10_000  # of one lane; a number that would make one more is not noted, and so it comes again
BootLane = tuple[str, str, str]  # host, boot, lane


class Position:
    """Which numbers of one lane have come: all up to `up_to`, and the stretches `beyond`, in order, never touching."""

    __slots__ = ("beyond", "up_to")

    def __init__(self, up_to: int = 0, beyond: list[tuple[int, int]] | None = None) -> None:
        self.up_to = up_to
        self.beyond = list(beyond or ())

    def holds(self, number: int) -> bool:
        """Say whether a number has come."""
        if number <= self.up_to:
            return True
        place = bisect_right(self.beyond, (number, 2**62)) - 1
        return place >= 0 and self.beyond[place][0] <= number <= self.beyond[place][1]

    def add(self, number: int) -> bool:
        """Note a number; return whether it is new."""
        if number == self.up_to + 1:
            self.up_to = number
            if self.beyond and self.beyond[0][0] == number + 1:
                self.up_to = self.beyond.pop(0)[1]
            return True
        if self.holds(number):
            return False
        place = bisect_right(self.beyond, (number, 2**62))
        first = last = number
        if place < len(self.beyond) and self.beyond[place][0] == number + 1:
            last = self.beyond.pop(place)[1]
        if place > 0 and self.beyond[place - 1][1] == number - 1:
            place -= 1
            first = self.beyond.pop(place)[0]
        if first != last or len(self.beyond) < MAX_GAPS:
            self.beyond.insert(place, (first, last))
        return True

    def held(self, last: int) -> int:
        """Return how many numbers from 1 to `last` have come."""
        return min(self.up_to, last) + sum(max(0, min(b, last) - a + 1) for a, b in self.beyond)

    @property
    def highest(self) -> int:
        """The highest number that has come."""
        return self.beyond[-1][1] if self.beyond else self.up_to


class LanePositions:
    """The positions of every lane of every boot, those of `limit` boots at most; the longest silent go first."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._boots: OrderedDict[tuple[str, str], dict[str, Position]] = OrderedDict()
        self._heard_s: dict[tuple[str, str], float] = {}

    def at(self, host: str, boot: str, lane: str) -> Position:
        """Return a lane's position, a new one where nothing has come yet."""
        lanes = self._boots.get((host, boot))
        if lanes is None:
            lanes = self._boots[(host, boot)] = {}
            while len(self._boots) > self._limit:
                self._heard_s.pop(self._boots.popitem(last=False)[0], None)
        position = lanes.get(lane)
        if position is None:
            position = lanes[lane] = Position()
        return position

    def find(self, host: str, boot: str, lane: str) -> Position | None:
        """Return a lane's position; None where nothing has come."""
        return self._boots.get((host, boot), {}).get(lane)

    def holds(self, origin: Origin) -> bool:
        """Say whether an envelope has come."""
        position = self.find(origin.host, origin.boot, origin.lane)
        return position is not None and position.holds(origin.number)

    def hear(self, host: str, boot: str, now_s: float) -> None:
        """Note that a boot was heard of."""
        if (host, boot) in self._boots:
            self._heard_s[(host, boot)] = now_s
            self._boots.move_to_end((host, boot))

    def hear_newest(self, boots: int, now_s: float) -> None:
        """Take so many boots, those heard of last, as heard of now."""
        for host, boot in list(self._boots)[-boots:]:
            self._heard_s[(host, boot)] = now_s

    def told(self, since_s: float | None = None) -> Positions:
        """Return the numbers without a gap, by host, boot and lane: of all boots, or of those heard of since then."""
        told: Positions = {}
        for (host, boot), lanes in self._boots.items():
            if since_s is None or self._heard_s.get((host, boot), float("-inf")) >= since_s:
                told.setdefault(host, {})[boot] = {lane: position.up_to for lane, position in lanes.items()}
        return told

    def __iter__(self) -> Iterator[tuple[BootLane, Position]]:
        for (host, boot), lanes in self._boots.items():
            for lane, position in lanes.items():
                yield (host, boot, lane), position
