"""Where in the journal each envelope stands, for readers that missed some: eight bytes each, so that it reaches far back."""

from array import array
from collections.abc import Iterator

from blackboard.keeper.positions import BootLane

NOWHERE = 2**64 - 1
MAX_AHEAD = 100_000  # numbers beyond the last known one; what is further ahead cannot be found before the gap is closed

MAX_LANES = 5000  # those met first go first


class JournalIndex:
    """Offsets by lane and number, at most `limit` of them; of the lane that has most, the older half goes first."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._size = 0
        self._lanes: dict[BootLane, tuple[int, array[int]]] = {}  # the first number, and the offsets from it on

    def add(self, lane: BootLane, number: int, offset: int) -> None:
        """Note where an envelope stands."""
        known = self._lanes.get(lane)
        if known is None:
            known = self._lanes[lane] = (number, array("Q"))
            if len(self._lanes) > MAX_LANES:
                self._drop(next(iter(self._lanes)))
        first, offsets = known
        place = number - first
        if place == len(offsets):
            offsets.append(offset)
            self._size += 1
        elif 0 <= place < len(offsets):
            offsets[place] = offset
        elif place > len(offsets) and place - len(offsets) <= MAX_AHEAD:
            self._size += place + 1 - len(offsets)
            offsets.extend([NOWHERE] * (place - len(offsets)))
            offsets.append(offset)
        elif place < 0 and -place <= MAX_AHEAD:
            self._size += -place
            self._lanes[lane] = (number, array("Q", [offset] + [NOWHERE] * (-place - 1)) + offsets)
        if self._size > self._limit:
            self._halve()

    def between(self, lane: BootLane, first: int, last: int) -> Iterator[tuple[int, int]]:
        """Yield number and offset of those of a lane from `first` to `last` that are known, in order."""
        begin, offsets = self._lanes.get(lane, (1, array("Q")))
        for number in range(max(first, begin), min(last, begin + len(offsets) - 1) + 1):
            offset = offsets[number - begin]
            if offset != NOWHERE:
                yield number, offset

    def __len__(self) -> int:
        return self._size

    def _halve(self) -> None:
        lane = max(self._lanes, key=lambda name: len(self._lanes[name][1]))
        first, offsets = self._lanes[lane]
        half = (len(offsets) + 1) // 2
        if half == len(offsets):
            self._drop(lane)
        else:
            self._size -= half
            self._lanes[lane] = (first + half, offsets[half:])

    def _drop(self, lane: BootLane) -> None:
        self._size -= len(self._lanes.pop(lane)[1])
