"""Where the centre of a round robot may be, on the grid: how near things are, which cells are closed, what the others cost.

A cell is closed where an occupied cell lies within the robot's radius, as for a place to stand. Occupied cells already reach some
2 cm into the free side of a wall, so a margin on top would close doors that the robot passes. Unknown cells count within less
than the radius: sonars leave strips of a cell or two undecided along walls and in the frames of doors, and what stands in them is
heard, and avoided, once the rim comes near. Open cells near something cost more, so that ways keep clear where there is room.
"""

from dataclasses import dataclass
from math import ceil, floor

import numpy as np
import numpy.typing as npt

from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, UNKNOWN, KnownPart
from knowledge_sources.ways_params import WaysParams

Mask = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]
Cells = npt.NDArray[np.uint8]
Squares = npt.NDArray[np.int16] | npt.NDArray[np.int32]
LARGEST_SHORT = 32_767
ROUNDING = 1e-6  # of a cell
BLUR_M = 0.1  # so wide the rim's surroundings are blurred on the grid
BLIND_M = 0.25  # and so far from the rim cones are narrower than cells, and leave some of them out


@dataclass(frozen=True, eq=False)
class Room:
    """Where a robot may be: `open` and `cost` (of a metre) by cells (rows, columns); `squares` are capped squared distances in
    cells to the nearest occupied one. `cells` are those of the grid, with what the robot covers. Lower left corner, map frame.
    """

    cells: Cells
    open: Mask
    cost: npt.NDArray[np.float32]
    squares: Squares
    x_min_m: float
    y_min_m: float
    cell_m: float

    def cell(self, x_m: float, y_m: float) -> tuple[int, int]:
        """Return the row and column of a place, which may lie outside."""
        return floor((y_m - self.y_min_m) / self.cell_m), floor((x_m - self.x_min_m) / self.cell_m)

    def centre(self, row: float, column: float) -> tuple[float, float]:
        """Return the middle of a cell, map frame."""
        return self.x_min_m + (column + 0.5) * self.cell_m, self.y_min_m + (row + 0.5) * self.cell_m

    def is_open(self, x_m: float, y_m: float) -> bool:
        """Say whether a place lies in an open cell."""
        row, column = self.cell(x_m, y_m)
        rows, columns = self.open.shape
        return 0 <= row < rows and 0 <= column < columns and bool(self.open[row, column])


def squared_distances(things: Mask, reach_cells: int) -> Squares:
    """Return each cell's squared distance, in cells, to the nearest of `things`; (reach_cells + 1)^2 where that is further.

    Exact within the reach: along rows first, then over the rows within reach of each.
    """
    rows, columns = things.shape
    cap = reach_cells + 1
    number = np.int16 if max(columns, rows) + 2 * cap < LARGEST_SHORT and 2 * cap * cap < LARGEST_SHORT else np.int32
    place = np.arange(columns, dtype=number)
    left = np.maximum.accumulate(np.where(things, place, number(-cap)), axis=1)
    right = np.minimum.accumulate(np.where(things, place, number(columns + cap))[:, ::-1], axis=1)[:, ::-1]
    along = np.minimum(np.minimum(place - left, right - place), number(cap)) ** 2
    nearest: Squares = along.copy()
    for step in range(1, min(reach_cells, rows - 1) + 1):
        other = along + number(step * step)
        np.minimum(nearest[step:], other[:-step], out=nearest[step:])
        np.minimum(nearest[:-step], other[step:], out=nearest[:-step])
    np.minimum(nearest, number(cap * cap), out=nearest)
    return nearest


def room_to_move(known: KnownPart, radius_m: float, place: tuple[float, float] | None, params: WaysParams) -> Room:
    """Return where a robot of this radius, which stands at `place` now (None: nobody knows), may be.

    Where its body is nothing stands. Where it stands too near to something it may leave over what is no tighter than its place.
    """
    cell_m = known.cell_m
    beyond = ceil((radius_m + params.comfort_m) / cell_m)
    row = column = -1
    cells = np.array(known.cells)
    if place is not None:
        row, column = floor((place[1] - known.y_min_m) / cell_m), floor((place[0] - known.x_min_m) / cell_m)
        _clear_body(cells, row, column, radius_m, cell_m)
    occupied = squared_distances(cells >= OCCUPIED_MIN, beyond)
    around = np.pad(cells > EMPTY_MAX, 1, constant_values=True)  # nobody knows what lies beyond
    unknown = squared_distances(around, beyond)[1:-1, 1:-1]
    radius, unknown_radius = radius_m / cell_m + ROUNDING, params.unknown_fraction * radius_m / cell_m + ROUNDING
    open_: Mask = (occupied > radius**2) & (unknown > unknown_radius**2)
    if place is not None:
        _let_out(open_, occupied, unknown, row, column, ceil(params.escape_m / cell_m))
    distance_m = np.sqrt(np.arange((beyond + 1) ** 2 + 1)) * cell_m
    nearness = (radius_m + params.comfort_m - distance_m) / max(params.comfort_m, cell_m)
    by_squares = (1.0 + params.near_cost * np.maximum(nearness, 0.0)).astype(np.float32)
    return Room(cells, open_, by_squares[unknown], occupied, known.x_min_m, known.y_min_m, cell_m)


def _clear_body(cells: Cells, row: int, column: int, radius_m: float, cell_m: float) -> None:
    """Empty what lies under the robot, but for its rim, and the cells near by of which nothing was heard: it would have been."""
    window, away = _window(cells.shape, row, column, ceil((radius_m + BLIND_M) / cell_m))
    if window is None:
        return
    part = cells[window]
    part[(away <= ((radius_m + BLIND_M) / cell_m) ** 2) & (part <= UNKNOWN)] = 0
    part[away <= (max(radius_m - BLUR_M, 0.0) / cell_m) ** 2] = 0


def _let_out(open_: Mask, occupied: Squares, unknown: Squares, row: int, column: int, reach: int) -> None:
    """Open, within reach, what is no tighter than the place that the robot stands at."""
    window, away = _window(open_.shape, row, column, reach)
    if window is None or not (0 <= row < open_.shape[0] and 0 <= column < open_.shape[1]) or open_[row, column]:
        return
    passable = (occupied[window] >= occupied[row, column]) & (unknown[window] >= unknown[row, column])
    open_[window] |= passable & (away <= reach * reach) & (occupied[window] > 0)
    open_[row, column] = True


def _window(
    shape: tuple[int, ...], row: int, column: int, reach: int
) -> tuple[tuple[slice, slice] | None, npt.NDArray[np.int64]]:
    """Return the part of an array within reach of a cell, and its cells' squared distances from that; None: nothing of it."""
    r0, r1 = max(row - reach, 0), min(row + reach + 1, shape[0])
    c0, c1 = max(column - reach, 0), min(column + reach + 1, shape[1])
    if r0 >= r1 or c0 >= c1:
        return None, np.empty((0, 0), np.int64)
    away = (np.arange(r0, r1)[:, None] - row) ** 2 + (np.arange(c0, c1)[None, :] - column) ** 2
    return (slice(r0, r1), slice(c0, c1)), away
