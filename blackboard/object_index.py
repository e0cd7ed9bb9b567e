"""The objects of a run by place, name, kind, area and description, linked to the grid (Bou-Ghannam 1992, section 4.4).

The grid says of a cell whether it is occupied, empty or unknown; the index says of what objects it is part, and of an object
where it is. An object is a member of any collection on the observation and hypothesis panels whose values have a place.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import hypot, inf
from typing import Any

import msgspec

from blackboard.errors import BoardError, MessageError, did_you_mean
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, Grid
from blackboard.journal import JournalLine
from blackboard.kinds import GRID, Kind
from blackboard.messages.base import Message
from blackboard.messages.geometry import Point
from blackboard.vocabulary import Vocabulary, decode
from blackboard.why import said_of

Place = tuple[float, float]
Area = tuple[float, float, float, float]
CELL = "cell"  # asked for like a kind: what is there, and what it is part of
CELL_REACH_CELLS = 2.0  # a wall's band is some four cells wide, and its line runs in the middle


@dataclass(frozen=True, slots=True)
class Object:
    """One object: its key and kind, its value, since when it stood as it is, and for and against."""

    key: str
    kind: Kind[Any]
    id: str
    value: Any
    stamp_s: float
    said: tuple[str, ...] = ()

    @property
    def description(self) -> str:
        """What can be searched: kind, id, and every word in the value."""
        return " ".join((self.kind.name, self.id, *_words(msgspec.to_builtins(self.value)))).lower()

    def distance_m(self, place: Place) -> float:
        """Return how far a place lies from the object: from its segment, its point, or the box around it."""
        start, end = getattr(self.value, "start", None), getattr(self.value, "end", None)
        if isinstance(start, Point) and isinstance(end, Point):
            return _from_segment_m(place, (start.x_m, start.y_m), (end.x_m, end.y_m))
        x0, y0, x1, y1 = self.value.extent()
        return hypot(max(x0 - place[0], 0.0, place[0] - x1), max(y0 - place[1], 0.0, place[1] - y1))


@dataclass(frozen=True, slots=True)
class Cell:
    """What the grid knows of one place."""

    state: str  # empty, occupied, unknown
    value: int


class ObjectIndex:
    """The objects that stood at the end of a run, or at a time in it, and its grid."""

    def __init__(self, objects: Iterable[Object], grid: Grid | None, kinds: Iterable[Kind[Any]]) -> None:
        self.objects = list(objects)
        self.grid = grid
        self._kinds = {kind.name: kind for kind in kinds}

    def find(
        self,
        kind: str | None = None,
        *,
        near: Place | None = None,
        within_m: float = inf,
        name: str | None = None,
        area: Area | None = None,
        words: Sequence[str] = (),
    ) -> list[Object]:
        """Return the objects of a kind (None: of all) that fit everything asked for: nearest first, or in order of posting.

        `name` is an id; `words` must all occur in the object's description. Raises BoardError for a kind that no object can have.
        """
        if kind is not None and kind not in self._kinds:
            raise BoardError(f"no objects are called '{kind}'{did_you_mean(kind, [*self._kinds, CELL])}")
        found = [
            o
            for o in self.objects
            if (kind is None or o.kind.name == kind)
            and (name is None or o.id == name)
            and (area is None or _touches(o.value.extent(), area))
            and all(word.lower() in o.description for word in words)
        ]
        if near is None:
            return found
        distances = [(o.distance_m(near), i) for i, o in enumerate(found)]
        return [found[i] for distance, i in sorted(distances) if distance <= within_m]

    def cell(self, place: Place) -> Cell:
        """Return what the grid says of a place: unknown where there is no grid."""
        if self.grid is None:
            return Cell("unknown", 128)
        column = int((place[0] - self.grid.x_min_m) // self.grid.cell_m)
        row = int((place[1] - self.grid.y_min_m) // self.grid.cell_m)
        rows, columns = self.grid.cells.shape
        if not (0 <= row < rows and 0 <= column < columns):
            return Cell("unknown", 128)
        value = int(self.grid.cells[row, column])
        return Cell("empty" if value <= EMPTY_MAX else "occupied" if value >= OCCUPIED_MIN else "unknown", value)

    def part_of(self, place: Place) -> list[Object]:
        """Return the objects that the cell at a place is part of, nearest first."""
        cell_m = self.grid.cell_m if self.grid is not None else 0.05
        return self.find(near=place, within_m=CELL_REACH_CELLS * cell_m)


def read_objects(lines: Iterable[JournalLine], vocabulary: Vocabulary, *, at_s: float | None = None) -> ObjectIndex:
    """Return the objects that stand at the end of a record, or at `at_s`; kinds that the vocabulary lacks are passed over."""
    kinds = {kind.path: kind for kind in vocabulary if _is_of_objects(kind)}
    newest: dict[str, JournalLine] = {}
    tiles: dict[str, JournalLine] = {}
    for line in lines:
        if at_s is not None and line.stamp_s > at_s:
            continue
        path = "/".join(line.key.split("/")[2:-1])
        store = newest if path in kinds else tiles if path == GRID.path else None
        if store is None:
            continue
        if line.event == "retracted":
            store.pop(line.key, None)
        else:
            store[line.key] = line
    objects = []
    for line in newest.values():
        kind = kinds["/".join(line.key.split("/")[2:-1])]
        said = said_of(line.endorsements)
        value = _decoded(kind, line)
        if value is not None and value.extent() is not None:
            objects.append(Object(line.key, kind, line.key.rpartition("/")[2], value, line.stamp_s, said))
    grid = Grid.from_tiles(value for line in tiles.values() if (value := _decoded(GRID, line)) is not None)
    return ObjectIndex(objects, grid, kinds.values())


def _decoded(kind: Kind[Any], line: JournalLine) -> Any:
    try:
        return decode(kind, line.key, bytes(line.value))
    except MessageError as error:
        raise BoardError(f"the record does not fit this version: {error}") from None


def _is_of_objects(kind: Kind[Any]) -> bool:
    has_place = kind.type.extent is not Message.extent
    return kind.collection and has_place and kind.panel in ("observations", "hypotheses") and kind is not GRID


def _words(plain: object) -> list[str]:
    if isinstance(plain, dict):
        return [word for name, value in plain.items() for word in (str(name), *_words(value))]
    if isinstance(plain, list | tuple):
        return [word for value in plain for word in _words(value)]
    return [plain] if isinstance(plain, str) else []


def _touches(extent: Area, area: Area) -> bool:
    return extent[0] <= area[2] and extent[2] >= area[0] and extent[1] <= area[3] and extent[3] >= area[1]


def _from_segment_m(place: Place, start: Place, end: Place) -> float:
    dx, dy = end[0] - start[0], end[1] - start[1]
    length2 = dx * dx + dy * dy
    t = 0.0 if length2 == 0 else ((place[0] - start[0]) * dx + (place[1] - start[1]) * dy) / length2
    t = min(1.0, max(0.0, t))
    return hypot(start[0] + t * dx - place[0], start[1] + t * dy - place[1])
