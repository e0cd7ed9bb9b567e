"""The template cone of a sonar, laid over square cells (Bou-Ghannam 1992, section 5.2.1, step 2).

A template's cells are sorted by range, so the cone cut at any range is its first cells; `count_within` finds how many.
"""

from array import array
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, pi

import numpy as np
import numpy.typing as npt

HEADINGS = 720  # templates in a full turn: half a degree; the edge of a cone of 5 m is off by 2 cm at most
SECTORS = 8  # parts of a cone's width that can be blocked one by one: one bit each
RANGE_STEP_M = 0.01  # how finely a cone can be cut: a fifth of a cell
ROUNDING = 1e-9  # what lies on an edge lies inside, on either side alike


@dataclass(frozen=True, eq=False)
class Cone:
    """The cells of one cone around the cell that the sensor stands in, nearest first."""

    rows: npt.NDArray[np.int64]  # (n,) relative to the sensor's cell
    columns: npt.NDArray[np.int64]
    sectors: npt.NDArray[np.uint8]  # (n,) one bit for each sector that the cell covers part of
    count_within: "array[int]"  # number of cells no further than k * RANGE_STEP_M from the centre of the sensor's cell


@dataclass(frozen=True, eq=False)
class Disc:
    """All cells around a sensor: sorted by range, and their order by bearing."""

    rows: npt.NDArray[np.int64]
    columns: npt.NDArray[np.int64]
    ranges_m: npt.NDArray[np.float64]
    bearings_rad: npt.NDArray[np.float64]
    by_bearing: npt.NDArray[np.int64]
    sorted_bearings_rad: npt.NDArray[np.float64]


@lru_cache(maxsize=2)
def disc(radius_m: float, cell_m: float) -> Disc:
    """Return the cells within `radius_m` of the centre of cell (0, 0), ties in range by row, then column."""
    reach = ceil(radius_m / cell_m)
    rows, columns = (a.ravel() for a in np.mgrid[-reach : reach + 1, -reach : reach + 1])
    ranges = np.hypot(rows, columns) * cell_m
    order = np.argsort(ranges, kind="stable")
    order = order[ranges[order] <= radius_m + ROUNDING]
    rows, columns, ranges = rows[order], columns[order], ranges[order]
    bearings = np.arctan2(rows, columns)
    by_bearing = np.argsort(bearings, kind="stable")
    return Disc(rows, columns, ranges, bearings, by_bearing, bearings[by_bearing])


def cone(cone_rad: float, radius_m: float, cell_m: float, heading: int) -> Cone:
    """Return the cone of full width `cone_rad` whose axis points along `heading * 2 pi / HEADINGS`.

    The sensor's own cell belongs to it, and so does every cell whose centre does.
    """
    around = disc(radius_m, cell_m)
    axis_rad = (heading * 2 * pi / HEADINGS + pi) % (2 * pi) - pi
    half_rad = min(cone_rad / 2, pi)
    low_rad, high_rad = axis_rad - half_rad - ROUNDING, axis_rad + half_rad + ROUNDING
    chosen = [np.zeros(1, np.int64)]
    for turn in (-2 * pi, 0.0, 2 * pi):
        first, last = np.searchsorted(around.sorted_bearings_rad, (low_rad + turn, high_rad + turn))
        chosen.append(around.by_bearing[first:last])
    inside = np.unique(np.concatenate(chosen))
    ranges = around.ranges_m[inside]
    off_rad = (around.bearings_rad[inside] - axis_rad + pi) % (2 * pi) - pi
    off_rad[0] = 0.0
    limits = np.arange(ceil(radius_m / RANGE_STEP_M) + 2) * RANGE_STEP_M + ROUNDING
    return Cone(
        rows=around.rows[inside],
        columns=around.columns[inside],
        sectors=_sectors(ranges, off_rad, half_rad, cell_m),
        count_within=array("i", np.searchsorted(ranges, limits).astype(np.int32).tobytes()),
    )


def _sectors(
    ranges_m: npt.NDArray[np.float64], off_rad: npt.NDArray[np.float64], half_rad: float, cell_m: float
) -> npt.NDArray[np.uint8]:
    """Return which sectors each cell covers: those within half a cell of its centre."""
    reach_rad = np.minimum(0.5 * cell_m / np.maximum(ranges_m, 0.5 * cell_m), half_rad)
    per_rad = SECTORS / (2 * half_rad)
    first = np.clip(np.floor((off_rad - reach_rad + half_rad) * per_rad), 0, SECTORS - 1).astype(np.int64)
    last = np.clip(np.floor((off_rad + reach_rad + half_rad) * per_rad), 0, SECTORS - 1).astype(np.int64)
    return ((2 << last) - (1 << first)).astype(np.uint8)
