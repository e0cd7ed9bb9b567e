"""How well a scan fits where, looked up in a raster: correlative scan matching.

The raster holds, for each cell, exp(-d^2 / 2 sigma^2) of the distance d to the nearest point, as 0..255. A search sums it over the
scan's points for every pose in a window, first on coarse cells that hold the best of their fine ones, then around the best
(Olson 2009, "Real-time correlative scan matching", section III).
"""

from dataclasses import dataclass
from math import ceil

import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import sliding_window_view

from knowledge_sources.laser_graph.poses import Floats, rotate

COARSE = 4  # fine cells in a coarse one
Bytes = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True, kw_only=True)
class Raster:
    """How fine a field is, and how far from a point something still fits."""

    cell_m: float
    sigma_m: float


BEAMS = Raster(cell_m=0.05, sigma_m=0.06)  # two sigmas of a common laser's noise (0.02 m) and half a cell


@dataclass(frozen=True, eq=False)
class Field:
    """A raster whose cell (0, 0) begins at `origin` (2,), metres; axis 0 is y."""

    raster: Raster
    origin: Floats
    fine: Bytes
    coarse: Bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class Window:
    """How far from the guess a search looks, in each direction."""

    shift_m: float
    turn_rad: float


def lay_field(points: Floats, reach: tuple[float, float, float, float], raster: Raster = BEAMS) -> Field:
    """Return the field of the points (n, 2) over the box `reach` (x_min, y_min, x_max, y_max)."""
    coarse_m = raster.cell_m * COARSE
    origin = np.floor(np.array(reach[:2]) / coarse_m) * coarse_m
    size = np.ceil((np.array(reach[2:]) - origin) / coarse_m).astype(int) * COARSE
    columns, rows = size
    marked = np.zeros((rows, columns), dtype=np.uint8)
    cells = np.floor((points - origin) / raster.cell_m).astype(int)
    cells = cells[((cells >= 0) & (cells < size)).all(axis=1)]
    marked[cells[:, 1], cells[:, 0]] = 255
    fine = _spread(_spread(marked, raster).T, raster).T
    coarse = fine.reshape(rows // COARSE, COARSE, columns // COARSE, COARSE).max(axis=(1, 3))
    return Field(raster, origin, np.ascontiguousarray(fine), coarse)


def _spread(values: Bytes, raster: Raster) -> Bytes:
    """Return the highest bell over each cell of a row of them: a two-dimensional bell is the product of two such."""
    out = values.copy()
    wide = values.astype(np.uint16)
    for k in range(1, ceil(2.5 * raster.sigma_m / raster.cell_m)):
        bell = round(256 * np.exp(-0.5 * (k * raster.cell_m / raster.sigma_m) ** 2))
        lower = ((wide * bell) >> 8).astype(np.uint8)
        np.maximum(out[k:], lower[:-k], out=out[k:])
        np.maximum(out[:-k], lower[k:], out=out[:-k])
    return out


def search(field: Field, points: Floats, guess: Floats, window: Window, best: int = 4) -> tuple[Floats, float]:
    """Return the pose (3,) in the window around `guess` at which the points (n, 2) fit best, and their mean fit in [0, 1].

    `best` coarse places are looked into; a tie goes to what was tried first, from low angles and low y.
    """
    longest_m = max(float(np.hypot(points[:, 0], points[:, 1]).max()), 1.0)
    cell_m = field.raster.cell_m
    coarse_m = cell_m * COARSE
    turn_step = coarse_m / longest_m
    turns = _steps(window.turn_rad, max(turn_step, 0.02))
    shift = ceil(window.shift_m / coarse_m)
    sums = _sums(field.coarse, field.origin, coarse_m, points, guess, turns, shift)
    flat = sums.reshape(-1)
    least = np.partition(flat, -best)[-best] if len(flat) > best else -1.0
    order = np.flatnonzero(flat >= least)
    order = order[np.argsort(-flat[order], kind="stable")][:best]
    winner, top = guess, -1.0
    fine_turns = _steps(float(turns[1] - turns[0]) / 2 if len(turns) > 1 else 0.0, max(turn_step / COARSE, 0.005))
    side = 2 * shift + 1
    for place in order:
        turn, row, column = place // (side * side), (place // side) % side, place % side
        centre = guess + np.array([(column - shift) * coarse_m, (row - shift) * coarse_m, turns[turn]])
        fine = _sums(field.fine, field.origin, cell_m, points, centre, fine_turns, COARSE // 2 + 1)
        k = int(np.argmax(fine))
        fit = float(fine.reshape(-1)[k])
        if fit > top:
            n = 2 * (COARSE // 2 + 1) + 1
            t, r, c = k // (n * n), (k // n) % n, k % n
            half = COARSE // 2 + 1
            winner = centre + np.array([(c - half) * cell_m, (r - half) * cell_m, fine_turns[t]])
            top = fit
    return winner, top / 255.0


def _steps(half: float, step: float) -> Floats:
    n = ceil(half / step)
    return np.linspace(-half, half, 2 * n + 1) if n else np.zeros(1)


def _sums(
    raster: Bytes, origin: Floats, cell_m: float, points: Floats, guess: Floats, turns: Floats, shift: int
) -> Floats:
    """Return the mean over the points for each turn and shift: (turns, 2 shift + 1, 2 shift + 1), y before x."""
    side = 2 * shift + 1
    padded = np.pad(raster, side)
    windows = sliding_window_view(padded, (side, side))
    poses = np.tile(guess, (len(turns), 1))
    poses[:, 2] += turns
    placed = rotate(poses[:, None, :], points[None]) + guess[:2]  # (turns, n, 2)
    cells = np.floor((placed - origin) / cell_m).astype(np.int64) + side - shift
    rows = np.clip(cells[..., 1], 0, windows.shape[0] - 1)
    columns = np.clip(cells[..., 0], 0, windows.shape[1] - 1)
    sums = np.empty((len(turns), side, side))
    for t in range(len(turns)):
        sums[t] = windows[rows[t], columns[t]].sum(axis=0, dtype=np.uint32)
    return sums / len(points)
