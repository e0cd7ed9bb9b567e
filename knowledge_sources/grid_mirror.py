"""The grid on the board as one array, kept from one look to the next: only tiles that changed are unpacked."""

from blackboard.access import Access
from blackboard.entry import Entry
from blackboard.grid import Grid
from blackboard.kinds import GRID
from blackboard.messages.world import GridTile


class GridMirror:
    """A copy of the grid that follows the board. A source that holds one declares GRID among what it reads."""

    def __init__(self) -> None:
        self._grid: Grid | None = None
        self._tiles: dict[str, Entry[GridTile]] = {}

    def __reduce__(self) -> tuple[type["GridMirror"], tuple[()]]:
        return GridMirror, ()  # in a kept state: the next look takes all of it from the board

    @property
    def tiles(self) -> list[Entry[GridTile]]:
        """The tiles as of the last look."""
        return list(self._tiles.values())

    def look(self, board: Access) -> Grid | None:
        """Return the grid as it stands now; None where there is none."""
        standing = board.entries(GRID)
        if not self._tiles.keys() <= {entry.key for entry in standing}:  # a tile was taken back
            self._grid, self._tiles = None, {}
        for entry in standing:
            known = self._tiles.get(entry.key)
            if known is None or known.revision != entry.revision:
                self._tiles[entry.key] = entry
                if self._grid is None:
                    self._grid = Grid(entry.value.cell_m)
                self._grid.update(entry.value)
        return self._grid

    def tiles_in(self, x_min_m: float, y_min_m: float, x_max_m: float, y_max_m: float) -> list[Entry[GridTile]]:
        """Return the tiles that touch a box, as of the last look."""
        boxes = [(entry, entry.value.extent()) for entry in self._tiles.values()]
        return [e for e, b in boxes if b[0] <= x_max_m and b[2] >= x_min_m and b[1] <= y_max_m and b[3] >= y_min_m]
