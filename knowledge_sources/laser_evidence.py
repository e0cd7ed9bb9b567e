"""Laser beams as evidence in the grid: what lies before a beam's end goes down, the cell of its end goes up.

A beam speaks for what lies nearer to it than to its neighbours, unless these are far off: then for the cells that it crosses.
A cell changes at most once in each direction in a sweep. A beam without return says nothing: it may be invalid.
"""

from dataclasses import dataclass
from math import ceil, floor, pi, radians

import numpy as np
import numpy.typing as npt

from blackboard.grid import Grid
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserScan
from knowledge_sources.eou_params import EouGridParams

DENSE_RAD = radians(2.0)  # beams closer than this leave no cell between them where most walls are, up to 3 m
FANS = 4  # sizes of fans: a short sweep is spared the far cells

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class _Fan:
    """The cells around a sensor by bearing, in (-pi, pi] and once more a turn further on, so that any arc is one slice."""

    bearings_rad: npt.NDArray[np.float32]
    ranges_m: npt.NDArray[np.float32]
    offsets: Indices  # in the grid's flat array, from the sensor's cell


class LaserEvidence:
    """Folds sweeps into a grid. Fans are laid once and kept while the grid has the same width."""

    def __init__(self, params: EouGridParams) -> None:
        self._params = params
        self._fans: dict[int, _Fan] = {}
        self._width = 0

    def fold(self, grid: Grid, scan: LaserScan, map_from_laser: Pose) -> None:
        """Fold one sweep, which the grid must cover up to `laser_range_m`."""
        params, cell_m = self._params, self._params.cell_m
        ranges = np.array([r or 0.0 for r in scan.ranges_m])
        beams = np.flatnonzero(ranges)
        if not len(beams):
            return
        flat, width, first_row, first_column = grid.flat()
        if width != self._width:
            self._fans.clear()
            self._width = width
        x, y = map_from_laser.x_m / cell_m, map_from_laser.y_m / cell_m
        row, column = floor(y), floor(x)
        angles = map_from_laser.heading_rad + scan.angle_min_rad + scan.angle_step_rad * np.arange(len(ranges))
        cosines, sines = np.cos(angles), np.sin(angles)
        clear_m = np.minimum(ranges - params.clear_margin_m, params.laser_range_m)
        if 0.0 < abs(scan.angle_step_rad) <= DENSE_RAD:
            # ranges of a fan count from the centre of the sensor's cell: shift the end by where in it the sensor is
            ahead_m = ((x - column - 0.5) * cosines + (y - row - 0.5) * sines) * cell_m
            limits_m = np.where(clear_m > 0.0, clear_m + ahead_m, 0.0)
            passed = self._passed(limits_m, float(angles[0]), scan.angle_step_rad)
            passed += (row - first_row) * width + column - first_column
        else:
            passed = _crossed(np.maximum(clear_m, 0.0) / cell_m, x - first_column, y - first_row, cosines, sines, width)
        values = flat[passed]
        flat[passed] = np.maximum(values, params.laser_down) - params.laser_down
        ended = beams[ranges[beams] <= params.laser_range_m]
        end_columns = np.floor(x + ranges[ended] * cosines[ended] / cell_m).astype(np.int64) - first_column
        end_rows = np.floor(y + ranges[ended] * sines[ended] / cell_m).astype(np.int64) - first_row
        ends = end_rows * width + end_columns
        flat[ends] = np.minimum(flat[ends].astype(np.int16) + params.laser_up, 255)

    def _passed(self, limits_m: Floats, first_rad: float, step_rad: float) -> Indices:
        """Return offsets of the cells that lie nearer than the limit of the beam that they are nearest to."""
        if step_rad < 0.0:
            first_rad += (len(limits_m) - 1) * step_rad
            limits_m, step_rad = limits_m[::-1], -step_rad
        fan = self._fan(float(limits_m.max()))
        low_rad = (first_rad - step_rad / 2 + pi) % (2 * pi) - pi  # into the first turn of the fan
        edges = low_rad + step_rad * np.arange(len(limits_m) + 1)  # those after a whole turn lie in the fan's second
        bounds = np.searchsorted(fan.bearings_rad, edges.astype(np.float32), side="right")
        limits = np.repeat(limits_m.astype(np.float32), np.diff(bounds))
        first, past = bounds[0], bounds[-1]
        return fan.offsets[first:past][fan.ranges_m[first:past] < limits]

    def _fan(self, reach_m: float) -> _Fan:
        """Return the smallest fan that reaches so far."""
        longest_m = self._params.laser_range_m + self._params.cell_m
        size = min(max(ceil(reach_m / longest_m * FANS), 1), FANS)
        fan = self._fans.get(size)
        if fan is None:
            fan = self._fans[size] = _lay(longest_m * size / FANS, self._params.cell_m, self._width)
        return fan


def _lay(radius_m: float, cell_m: float, width: int) -> _Fan:
    reach = ceil(radius_m / cell_m)
    rows, columns = (a.ravel() for a in np.mgrid[-reach : reach + 1, -reach : reach + 1])
    ranges = np.hypot(rows, columns) * cell_m
    inside = ranges <= radius_m
    rows, columns, ranges = rows[inside], columns[inside], ranges[inside]
    bearings = np.arctan2(rows, columns)
    order = np.argsort(bearings, kind="stable")
    bearings, offsets = bearings[order], (rows * width + columns)[order]
    return _Fan(
        np.concatenate([bearings, bearings + 2 * pi]).astype(np.float32),
        np.tile(ranges[order], 2).astype(np.float32),
        np.tile(offsets, 2),
    )


def _crossed(clear: Floats, x: float, y: float, cosines: Floats, sines: Floats, width: int) -> Indices:
    """Return the cells that single beams cross, by points half a cell apart; lengths and places in cells of the grid."""
    along = np.arange(0.0, clear.max() + 0.5, 0.5)[:, None]
    columns, rows = np.floor(x + along * cosines), np.floor(y + along * sines)
    return (rows * width + columns)[along < clear].astype(np.int64)
