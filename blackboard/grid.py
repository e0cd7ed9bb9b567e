"""The empty-occupied-unknown grid as one array, put together from the tiles on the board, and cut into them again.

One byte a cell: 0 empty, 128 unknown, 255 occupied (Bou-Ghannam 1992, section 5.2.1).
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import floor
from typing import Any

import numpy as np
import numpy.typing as npt

from blackboard.errors import BoardError
from blackboard.messages.geometry import pack_array
from blackboard.messages.world import TILE_CELLS, GridTile

UNKNOWN = 128
EMPTY_MAX = 64  # a cell counts as empty up to this: half way from unknown to sure, so one reading alone does not decide
OCCUPIED_MIN = 192  # and as occupied from this on
MAX_CELLS = 50_000_000  # 350 m square at 5 cm, 50 MB: what lies beyond is a fault, not a building
HEADROOM_FRACTION = 0.5  # growing by a share of what is there keeps the copying amortised
UNIT_SLACK = 1e-9  # cell_m of two tiles may differ by rounding only

Cells = npt.NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class KnownPart:
    """The smallest rectangle with every cell that is not unknown: `cells` uint8 (rows, columns), lower left corner."""

    cells: Cells
    x_min_m: float
    y_min_m: float
    cell_m: float


class Grid:
    """A grid that grows by whole tiles. Row 0 is the lowest y, column 0 the lowest x; new cells are unknown.

    Raises BoardError for a tile of another cell size, and for what lies so far off that it would exceed MAX_CELLS.
    """

    def __init__(self, cell_m: float) -> None:
        self.cell_m = cell_m
        self._covered = (0, 0, 0, 0)  # tiles: first row, first column, past the last row, past the last column
        self._stored = (0, 0, 0, 0)
        self._store: Cells = np.empty((0, 0), np.uint8)
        self._taken: Cells = np.empty((0, 0), np.uint8)  # as it was when take_changed was last called

    @classmethod
    def from_tiles(cls, tiles: Iterable[GridTile]) -> "Grid | None":
        """Return the grid that the tiles make up; None when there are none."""
        tiles = list(tiles)
        if not tiles:
            return None
        grid = cls(tiles[0].cell_m)
        rows, columns = [t.row for t in tiles], [t.column for t in tiles]
        grid._cover_tiles(min(rows), min(columns), max(rows) + 1, max(columns) + 1, headroom=0.0)
        for tile in tiles:
            grid.update(tile)
        return grid

    @property
    def cells(self) -> Cells:
        """The covered part, uint8 (rows, columns): a view, good until the grid grows."""
        r0, c0, r1, c1 = self._covered
        row, column = self._stored[:2]
        return self._store[
            (r0 - row) * TILE_CELLS : (r1 - row) * TILE_CELLS, (c0 - column) * TILE_CELLS : (c1 - column) * TILE_CELLS
        ]

    @property
    def x_min_m(self) -> float:
        """Left edge of column 0, map frame."""
        return self._covered[1] * TILE_CELLS * self.cell_m

    @property
    def y_min_m(self) -> float:
        """Lower edge of row 0, map frame."""
        return self._covered[0] * TILE_CELLS * self.cell_m

    @property
    def empty(self) -> npt.NDArray[np.bool_]:
        """Which cells count as empty, (rows, columns)."""
        return self.cells <= EMPTY_MAX

    @property
    def occupied(self) -> npt.NDArray[np.bool_]:
        """Which cells count as occupied, (rows, columns)."""
        return self.cells >= OCCUPIED_MIN

    def update(self, tile: GridTile) -> None:
        """Put one tile in its place, growing as needed."""
        if abs(tile.cell_m - self.cell_m) > UNIT_SLACK:
            raise BoardError(f"grid tile {tile_id(tile)} has cell_m = {tile.cell_m:g}, the grid {self.cell_m:g}")
        self._cover_tiles(tile.row, tile.column, tile.row + 1, tile.column + 1)
        self._tile(self._store, tile.row, tile.column)[:] = tile.cells.unpack()

    def values_at(self, points: npt.NDArray[Any]) -> Cells:
        """Return the cell values, uint8 (n,), under points (n, 2) m, map frame; UNKNOWN outside."""
        cells = self.cells
        if not cells.size:
            return np.full(len(points), UNKNOWN, np.uint8)
        columns = np.floor(points[:, 0] / self.cell_m).astype(np.int64) - self._covered[1] * TILE_CELLS
        rows = np.floor(points[:, 1] / self.cell_m).astype(np.int64) - self._covered[0] * TILE_CELLS
        inside = (rows >= 0) & (rows < cells.shape[0]) & (columns >= 0) & (columns < cells.shape[1])
        found = cells[np.where(inside, rows, 0), np.where(inside, columns, 0)]
        found[~inside] = UNKNOWN
        return found

    def known_part(self) -> KnownPart | None:
        """Return the rectangle that holds every known cell (a view); None when nothing is known."""
        cells = self.cells
        known = cells != UNKNOWN
        rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
        if not len(rows):
            return None
        r0, r1, c0, c1 = int(rows[0]), int(rows[-1]), int(columns[0]), int(columns[-1])
        x_min_m, y_min_m = self.x_min_m + c0 * self.cell_m, self.y_min_m + r0 * self.cell_m
        return KnownPart(cells[r0 : r1 + 1, c0 : c1 + 1], x_min_m, y_min_m, self.cell_m)

    def cover(self, x_min_m: float, y_min_m: float, x_max_m: float, y_max_m: float) -> None:
        """Grow until this box, map frame, lies inside."""
        side_m = TILE_CELLS * self.cell_m
        self._cover_tiles(
            floor(y_min_m / side_m), floor(x_min_m / side_m), floor(y_max_m / side_m) + 1, floor(x_max_m / side_m) + 1
        )

    def flat(self) -> tuple[Cells, int, int, int]:
        """Return what a fast writer needs, good until the grid grows: every cell in one row (a view), the width of a
        row of the grid in it, and the row and column of its first cell. The cell that covers (x, y) stands at
        `(floor(y / cell_m) - first_row) * width + floor(x / cell_m) - first_column`.
        """
        row, column = self._stored[:2]
        return self._store.reshape(-1), self._store.shape[1], row * TILE_CELLS, column * TILE_CELLS

    def take_changed(self) -> list[GridTile]:
        """Return the tiles that changed since the last call, by row, then column."""
        rows, columns = self._stored[2] - self._stored[0], self._stored[3] - self._stored[1]
        differs = (self._store != self._taken).reshape(rows, TILE_CELLS, columns, TILE_CELLS)
        changed = []
        for r, c in np.argwhere(differs.any(axis=3).any(axis=1)):
            row, column = int(r) + self._stored[0], int(c) + self._stored[1]
            cells = self._tile(self._store, row, column)
            self._tile(self._taken, row, column)[:] = cells
            changed.append(GridTile(column=column, row=row, cell_m=self.cell_m, cells=pack_array(cells)))
        return changed

    def _tile(self, array: Cells, row: int, column: int) -> Cells:
        r, c = (row - self._stored[0]) * TILE_CELLS, (column - self._stored[1]) * TILE_CELLS
        return array[r : r + TILE_CELLS, c : c + TILE_CELLS]

    def _cover_tiles(self, r0: int, c0: int, r1: int, c1: int, headroom: float = HEADROOM_FRACTION) -> None:
        covered = (r0, c0, r1, c1)
        stored = self._stored if self._store.size else covered
        if self._store.size:
            a, b, c, d = self._covered
            covered = (min(a, r0), min(b, c0), max(c, r1), max(d, c1))
        spare_rows, spare_columns = int((stored[2] - stored[0]) * headroom), int((stored[3] - stored[1]) * headroom)
        wanted = (
            stored[0] if covered[0] >= stored[0] else covered[0] - spare_rows,
            stored[1] if covered[1] >= stored[1] else covered[1] - spare_columns,
            stored[2] if covered[2] <= stored[2] else covered[2] + spare_rows,
            stored[3] if covered[3] <= stored[3] else covered[3] + spare_columns,
        )
        if not self._store.size or wanted != self._stored:
            height, width = (wanted[2] - wanted[0]) * TILE_CELLS, (wanted[3] - wanted[1]) * TILE_CELLS
            if height * width > MAX_CELLS:
                raise BoardError(
                    f"the grid would be {width * self.cell_m:.0f} x {height * self.cell_m:.0f} m, over {MAX_CELLS}"
                    " cells: a pose or a tile lies far off; look at the newest map_from_odom and odom_from_robot"
                )
            moved = [self._moved(array, wanted, (height, width)) for array in (self._store, self._taken)]
            self._store, self._taken = moved
            self._stored = wanted
        self._covered = covered

    def _moved(self, array: Cells, wanted: tuple[int, int, int, int], shape: tuple[int, int]) -> Cells:
        larger = np.full(shape, UNKNOWN, np.uint8)
        if array.size:
            r, c = (self._stored[0] - wanted[0]) * TILE_CELLS, (self._stored[1] - wanted[1]) * TILE_CELLS
            larger[r : r + array.shape[0], c : c + array.shape[1]] = array
        return larger


def tile_id(tile: GridTile) -> str:
    """Return the id that a tile has on the board."""
    return f"{tile.column}_{tile.row}"


def way_is_empty(grid: Grid, start: tuple[float, float], end: tuple[float, float], half_width_m: float) -> bool:
    """Say whether all cells on the straight way between two places, so wide to either side and beyond its end, count as empty."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = float(np.hypot(dx, dy))
    along_x, along_y = (dx / length, dy / length) if length > 0.0 else (1.0, 0.0)
    step = grid.cell_m / 2
    forward = np.arange(0.0, length + half_width_m + step, step)
    aside = np.linspace(-half_width_m, half_width_m, 2 * int(np.ceil(half_width_m / step)) + 1)
    xs = start[0] + forward[:, None] * along_x - aside * along_y
    ys = start[1] + forward[:, None] * along_y + aside * along_x
    return bool((grid.values_at(np.stack([xs.ravel(), ys.ravel()], axis=1)) <= EMPTY_MAX).all())
