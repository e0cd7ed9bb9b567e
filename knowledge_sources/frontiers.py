"""Frontiers between what the grid knows to be empty and what it does not know, and room for a robot to stand before them."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, floor, hypot, sqrt
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, Grid, KnownPart
from knowledge_sources.room_to_move import Room, squared_distances

Mask = npt.NDArray[np.bool_]
Cornered = Grid | KnownPart | Room  # whatever says where its first cell lies and how large cells are
ROUNDING = 1e-6  # of a cell
BESIDE_M = 0.1  # between a frontier and where the robot's centre could come to beyond it: blur
EIGHT_NEIGHBOURS = np.ones((3, 3), dtype=np.bool_)


@dataclass(frozen=True, slots=True, kw_only=True)
class Frontier:
    """One piece of frontier: its cells' centre that lies nearest to their mean, and its length."""

    x_m: float
    y_m: float
    length_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """Where a robot can stand in known empty space."""

    x_m: float
    y_m: float


def frontier_mask(cells: npt.NDArray[np.uint8], depth_cells: int) -> Mask:
    """Return the empty cells (rows, columns) beside a block of undecided cells of depth_cells x depth_cells at least.

    Thinner undecided strips are the blurred front of a wall.
    """
    around = np.pad(
        (cells > EMPTY_MAX) & (cells < OCCUPIED_MIN), depth_cells, constant_values=True
    )  # nobody knows of it
    blocks = _widened(_narrowed(around, depth_cells), depth_cells)
    beside = np.zeros_like(blocks)
    beside[1:] |= blocks[:-1]
    beside[:-1] |= blocks[1:]
    beside[:, 1:] |= blocks[:, :-1]
    beside[:, :-1] |= blocks[:, 1:]
    mask: Mask = beside[depth_cells:-depth_cells, depth_cells:-depth_cells] & (cells <= EMPTY_MAX)
    return mask


def pieces(mask: Mask) -> list[npt.NDArray[np.int64]]:
    """Return the connected pieces of a mask (eight neighbours) as cells (n, 2) row, column; by their first cell."""
    labels, count = ndimage.label(mask, structure=EIGHT_NEIGHBOURS)  # numbered row by row
    cells = np.argwhere(mask)
    number = labels[mask]
    order = np.argsort(number, kind="stable")
    starts = np.searchsorted(number[order], np.arange(2, count + 1))
    return np.split(cells[order], starts) if count else []


def frontiers(mask: Mask, grid: Cornered, least_m: float) -> list[Frontier]:
    """Return the frontiers of at least this length in a mask of the grid's cells, the lowest first."""
    found = []
    for cells in pieces(mask):
        length_m = _length_cells(cells) * grid.cell_m
        if length_m < least_m:
            continue
        away = cells - cells.mean(axis=0)
        row, column = cells[int(np.argmin((away**2).sum(axis=1)))].tolist()
        x_m, y_m = cell_centre(grid, row, column)
        found.append(Frontier(x_m=x_m, y_m=y_m, length_m=length_m))
    return found


def within_reach(mask: Mask, places: Mask, reach_m: float, cell_m: float) -> Mask:
    """Return those cells of a mask that lie so near to some of these places."""
    near: Mask = squared_distances(places, ceil(reach_m / cell_m)) <= (reach_m / cell_m + ROUNDING) ** 2
    return mask & near


def could_be_reached(room: Room, radius_m: float, least_m2: float) -> Mask:
    """Return where the robot's centre may not be yet, and could if all that is unknown were empty.

    Only what it would come to from where it may be now, in pieces of at least this area; beyond the known part all is unknown.
    A gap in a wall that is too narrow for the robot leads nowhere.
    """
    radius = radius_m / room.cell_m + ROUNDING
    rim = ceil(radius) + 1
    unhindered = np.pad(room.squares > radius**2, rim, mode="edge")
    unhindered[[0, -1]] = unhindered[:, [0, -1]] = True
    labels, count = ndimage.label(unhindered)
    now = np.pad(room.open, rim)
    mine = np.zeros(count + 1, np.bool_)
    mine[labels[now]] = True
    mine[0] = False
    fresh = mine[labels] & ~now
    labels, count = ndimage.label(fresh, structure=EIGHT_NEIGHBOURS)
    large = np.bincount(labels.ravel(), minlength=count + 1) * room.cell_m**2 >= least_m2
    large[0] = False
    kept: Mask = large[labels][rim:-rim, rim:-rim]
    return kept


def open_place_near(grid: Grid, room: Room, x_m: float, y_m: float, reach_m: float) -> Standing | None:
    """Return the place nearest to (x, y), within reach_m of it, where the robot's centre may be and sees it."""
    row, column = room.cell(x_m, y_m)
    reach = ceil(reach_m / room.cell_m)
    r0, c0 = max(row - reach, 0), max(column - reach, 0)
    free = np.argwhere(room.open[r0 : max(row + reach + 1, 0), c0 : max(column + reach + 1, 0)]) + np.array([r0, c0])
    xs, ys = room.x_min_m + (free[:, 1] + 0.5) * room.cell_m, room.y_min_m + (free[:, 0] + 0.5) * room.cell_m
    distances = np.hypot(xs - x_m, ys - y_m)
    for best in np.argsort(distances, kind="stable").tolist():
        if distances[best] > reach_m:
            return None
        x, y = float(xs[best]), float(ys[best])
        if in_sight(grid, (x, y), (x_m, y_m), float(distances[best])):
            return Standing(x_m=x, y_m=y)
    return None


def place_to_stand(
    grid: Grid, x_m: float, y_m: float, radius_m: float, reach_m: float, *, wall_m: float = 0.0
) -> Standing | None:
    """Return the place nearest to (x, y), within reach_m of it, where a robot of this radius stands on empty cells only.

    Nothing may stand between there and (x, y), except within wall_m of it.
    """
    cell_m = grid.cell_m
    widths = _disc_rows(radius_m / cell_m)
    size = len(widths) // 2
    span = ceil(reach_m / cell_m) + size
    column, row = floor((x_m - grid.x_min_m) / cell_m), floor((y_m - grid.y_min_m) / cell_m)
    blocked = ~_window(grid, row, column, span)
    side = 2 * (span - size) + 1
    until = np.zeros((2 * span + 1, 2 * span + 2), dtype=np.int32)  # blocked cells of a row, up to each column
    np.cumsum(blocked, axis=1, out=until[:, 1:])
    hit = np.zeros((side, side), dtype=np.bool_)
    for dr, width in enumerate(widths):  # the body row by row
        rows = until[dr : dr + side]
        hit |= rows[:, size + width + 1 :][:, :side] > rows[:, size - width :][:, :side]
    free = np.argwhere(~hit)
    if not len(free):
        return None
    xs, ys = cell_centre(grid, 0, 0)
    places = np.stack(
        [xs + (free[:, 1] + column - (span - size)) * cell_m, ys + (free[:, 0] + row - (span - size)) * cell_m]
    )
    distances = np.hypot(places[0] - x_m, places[1] - y_m)
    for best in np.argsort(distances, kind="stable").tolist():
        if distances[best] > reach_m:
            return None
        x, y = places[:, best].tolist()
        if in_sight(grid, (x, y), (x_m, y_m), float(distances[best]) - wall_m):
            return Standing(x_m=x, y_m=y)
    return None


def in_sight(grid: Grid, eye: tuple[float, float], place: tuple[float, float], until_m: float) -> bool:
    """Say whether nothing that is known stands on the first until_m of the way from one place to another."""
    way = np.array(place) - eye
    length_m = float(np.hypot(*way))
    steps = np.arange(0.0, min(until_m, length_m), grid.cell_m / 2)
    if not len(steps):
        return True
    return bool((grid.values_at(eye + steps[:, None] / length_m * way) < OCCUPIED_MIN).all())


def cell_centre(grid: Cornered, row: int, column: int) -> tuple[float, float]:
    """Return the middle of a cell, map frame."""
    return grid.x_min_m + (column + 0.5) * grid.cell_m, grid.y_min_m + (row + 0.5) * grid.cell_m


def unknown_near(mask: Mask, grid: Cornered, x_m: float, y_m: float, reach_m: float) -> float:
    """Return the length of the frontier within reach_m of a place."""
    reach = ceil(reach_m / grid.cell_m)
    column, row = floor((x_m - grid.x_min_m) / grid.cell_m), floor((y_m - grid.y_min_m) / grid.cell_m)
    r0, c0 = max(row - reach, 0), max(column - reach, 0)
    near = np.argwhere(mask[r0 : max(row + reach + 1, 0), c0 : max(column + reach + 1, 0)]) + np.array([r0, c0])
    near = near[np.hypot(near[:, 0] - row, near[:, 1] - column) <= reach]
    return float(len(near)) * grid.cell_m


def merged(places: Iterable[tuple[float, float]], reach_m: float) -> list[list[tuple[float, float]]]:
    """Return the places in groups: each joins the first group whose mean lies within reach_m, or starts one."""
    groups: list[list[tuple[float, float]]] = []
    for x, y in places:
        for group in groups:
            if hypot(x - sum(p[0] for p in group) / len(group), y - sum(p[1] for p in group) / len(group)) <= reach_m:
                group.append((x, y))
                break
        else:
            groups.append([(x, y)])
    return groups


def _length_cells(cells: npt.NDArray[np.int64]) -> int:
    """Return how far a piece spreads: the diagonal of its box."""
    spread = np.ptp(cells, axis=0) + 1
    return round(float(np.hypot(*(spread - 1))) + 1)


def _window(grid: Grid, row: int, column: int, span: int) -> Mask:
    """Return which cells within span of a cell are empty; outside the grid none is."""
    side = 2 * span + 1
    window = np.zeros((side, side), dtype=np.bool_)
    rows, columns = grid.cells.shape
    r0, r1, c0, c1 = (
        max(row - span, 0),
        min(row + span + 1, rows),
        max(column - span, 0),
        min(column + span + 1, columns),
    )
    if r0 < r1 and c0 < c1:
        part: Any = grid.cells[r0:r1, c0:c1] <= EMPTY_MAX
        window[r0 - row + span : r1 - row + span, c0 - column + span : c1 - column + span] = part
    return window


def _disc_rows(radius_cells: float) -> list[int]:
    """Return how many cells a disc reaches to either side of its middle column, row by row."""
    size = ceil(radius_cells)
    return [
        floor(sqrt(max(radius_cells**2 - step**2, 0.0))) for step in range(-size, size + 1) if abs(step) <= radius_cells
    ]


def _narrowed(mask: Mask, side: int) -> Mask:
    """Return where a side x side block of true cells has its lower left cell."""
    out = mask.copy()
    for step in range(1, side):
        out[:, :-step] &= mask[:, step:]
        out[:, -step:] = False
    rows = out.copy()
    for step in range(1, side):
        out[:-step] &= rows[step:]
        out[-step:] = False
    return out


def _widened(mask: Mask, side: int) -> Mask:
    """Return all cells of the blocks whose lower left cells are true."""
    out = mask.copy()
    for step in range(1, side):
        out[:, step:] |= mask[:, :-step]
    columns = out.copy()
    for step in range(1, side):
        out[step:] |= columns[:-step]
    return out
