"""What the grid has shown for long, against what it shows now: floor where something stands now, and things that are gone."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, Grid
from knowledge_sources.frontiers import Mask, pieces

States = npt.NDArray[np.int8]
Floats = npt.NDArray[np.float64]

UNKNOWN, EMPTY, OCCUPIED = 0, 1, 2
JOINED_CELLS = 2  # pieces with smaller gaps are one: a thing's far edges are seen by few beams


@dataclass(frozen=True, slots=True, eq=False)
class Difference:
    """A piece of cells that differ: their centres (n, 2) m, map frame."""

    appeared: bool
    places: Floats


class LongStanding:
    """What each cell is by long standing, and since when it shows what it shows. It grows with the grid."""

    def __init__(self, settled_s: float) -> None:
        self._settled_s = settled_s
        self._cell_m = 0.0
        self._x_min_m = self._y_min_m = 0.0
        self._settled: States = np.zeros((0, 0), dtype=np.int8)
        self._shown: States = np.zeros((0, 0), dtype=np.int8)
        self._since_s: Floats = np.zeros((0, 0))
        self._held: Mask = np.zeros((0, 0), dtype=np.bool_)

    def look(self, grid: Grid, now_s: float) -> None:
        """Take note of the grid as it is now. What an open question holds does not settle."""
        self._cover(grid)
        cells = grid.cells
        shown = np.where(cells <= EMPTY_MAX, EMPTY, np.where(cells >= OCCUPIED_MIN, OCCUPIED, UNKNOWN)).astype(np.int8)
        known = shown != UNKNOWN  # what is undecided for a while has not changed yet
        changed = known & (shown != self._shown)
        self._since_s[changed] = now_s
        self._shown[known] = shown[known]
        ripe = (self._shown != UNKNOWN) & (now_s - self._since_s >= self._settled_s) & ~self._held
        self._settled[ripe] = self._shown[ripe]

    def differences(self, now_s: float, lasted_s: float, near_m: float, least_cells: int) -> list[Difference]:
        """Return what has differed for `lasted_s` at least, in pieces of `least_cells` and more, where nothing is held.

        Left out are cells within `near_m` of what stands there by long standing, for what is gone of what still does: walls blur.
        """
        lasted = (now_s - self._since_s >= lasted_s) & ~self._held
        if not self._cell_m:
            return []
        near, stood = round(near_m / self._cell_m), self._settled == OCCUPIED
        walls, standing = _widened(stood, near), _widened(stood & (self._shown == OCCUPIED), near)
        found = []
        for appeared, mask in (
            (True, (self._settled == EMPTY) & (self._shown == OCCUPIED) & lasted & ~walls),
            (False, stood & (self._shown == EMPTY) & lasted & ~standing),
        ):
            for piece in pieces(_widened(mask, JOINED_CELLS)) if mask.any() else []:
                cells = piece[mask[piece[:, 0], piece[:, 1]]]
                if len(cells) >= least_cells:
                    found.append(Difference(appeared, self._places(cells)))
        return found

    def around(self, places: Floats, reach_m: float, appeared: bool) -> Floats:
        """Return the places of the cells within `reach_m` of some of these that differ likewise."""
        near = _widened(self._mask(places), round(reach_m / self._cell_m))
        settled, shown = (EMPTY, OCCUPIED) if appeared else (OCCUPIED, EMPTY)
        return self._places(np.argwhere(near & (self._settled == settled) & (self._shown == shown)))

    def hold(self, places: Floats, reach_m: float, hold: bool) -> None:
        """Keep the cells within `reach_m` of some places from settling, or let them."""
        self._held[_widened(self._mask(places), round(reach_m / self._cell_m))] = hold

    def settle(self, places: Floats, reach_m: float, occupied: bool) -> None:
        """Take it as it is from now on that something, or nothing, stands at those cells within `reach_m` that show so."""
        state = OCCUPIED if occupied else EMPTY
        near = _widened(self._mask(places), round(reach_m / self._cell_m)) & (self._shown == state)
        self._settled[near] = state

    def shown_occupied(self, places: Floats) -> float:
        """Return of which share of these places the grid shows that something stands there."""
        return float((self._shown[self._mask(places)] == OCCUPIED).mean()) if len(places) else 0.0

    def _mask(self, places: Floats) -> Mask:
        mask: Mask = np.zeros(self._settled.shape, dtype=np.bool_)
        columns = np.floor((places[:, 0] - self._x_min_m) / self._cell_m).astype(np.int64)
        rows = np.floor((places[:, 1] - self._y_min_m) / self._cell_m).astype(np.int64)
        inside = (rows >= 0) & (rows < mask.shape[0]) & (columns >= 0) & (columns < mask.shape[1])
        mask[rows[inside], columns[inside]] = True
        return mask

    def _places(self, cells: npt.NDArray[np.int64]) -> Floats:
        origin = np.array([self._x_min_m, self._y_min_m])
        places: Floats = origin + (cells[:, ::-1] + 0.5) * self._cell_m
        return places

    def _cover(self, grid: Grid) -> None:
        """Grow to the grid's size."""
        shape = grid.cells.shape
        if shape == self._settled.shape and (grid.x_min_m, grid.y_min_m) == (self._x_min_m, self._y_min_m):
            return
        row = round((self._y_min_m - grid.y_min_m) / grid.cell_m)
        column = round((self._x_min_m - grid.x_min_m) / grid.cell_m)
        rows, columns = self._settled.shape

        def grown(old: npt.NDArray[Any]) -> npt.NDArray[Any]:
            new = np.zeros(shape, dtype=old.dtype)
            if old.size:
                new[row : row + rows, column : column + columns] = old
            return new

        self._settled, self._shown = grown(self._settled), grown(self._shown)
        self._since_s, self._held = grown(self._since_s), grown(self._held)
        self._cell_m, self._x_min_m, self._y_min_m = grid.cell_m, grid.x_min_m, grid.y_min_m


def _widened(mask: Mask, cells: int) -> Mask:
    """Return all cells within so many of a true one, along rows and columns."""
    wide = mask.copy()
    for step in range(1, cells + 1):
        wide[step:] |= mask[:-step]
        wide[:-step] |= mask[step:]
    rows = wide.copy()
    for step in range(1, cells + 1):
        wide[:, step:] |= rows[:, :-step]
        wide[:, :-step] |= rows[:, step:]
    return wide
