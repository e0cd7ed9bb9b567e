"""Laser beams as evidence in the grid: what lies before a beam's end goes down, the cell of its end goes up."""

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, floor, pi

import numpy as np
import numpy.typing as npt

from blackboard.grid import Grid
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserScan
from knowledge_sources.eou_params import EouGridParams


@dataclass(frozen=True, eq=False)
class _Fan:
    """The cells around a sensor by bearing, in [-pi, pi) and once more a turn further on, so that any arc is one slice."""

    bearings_rad: npt.NDArray[np.float32]
    ranges_m: npt.NDArray[np.float32]
    rows: npt.NDArray[np.int64]
    columns: npt.NDArray[np.int64]


@lru_cache(maxsize=64)
def _fan(radius_m: int, cell_m: float) -> _Fan:
    reach = ceil(radius_m / cell_m)
    rows, columns = (a.ravel() for a in np.mgrid[-reach : reach + 1, -reach : reach + 1])
    ranges = np.hypot(rows, columns) * cell_m
    inside = ranges <= radius_m
    rows, columns, ranges = rows[inside], columns[inside], ranges[inside]
    bearings = np.arctan2(rows, columns)
    order = np.argsort(bearings, kind="stable")
    bearings = bearings[order]
    return _Fan(
        np.concatenate([bearings, bearings + 2 * pi]).astype(np.float32),
        np.tile(ranges[order], 2).astype(np.float32),
        np.tile(rows[order], 2),
        np.tile(columns[order], 2),
    )


def fold_laser(grid: Grid, scan: LaserScan, map_from_laser: Pose, params: EouGridParams) -> None:
    """Fold one sweep into a grid, which must cover its range. A beam without return says nothing: it may be invalid."""
    ranges = np.array([0.0 if r is None else r for r in scan.ranges_m])
    step_rad, count = scan.angle_step_rad, len(ranges)
    if step_rad < 0:
        ranges, step_rad = ranges[::-1], -step_rad
        first_rad = scan.angle_min_rad + (count - 1) * scan.angle_step_rad
    else:
        first_rad = scan.angle_min_rad
    if not count or not ranges.any():
        return
    flat, width, first_row, first_column = grid.flat()
    cell_m = params.cell_m
    row, column = floor(map_from_laser.y_m / cell_m), floor(map_from_laser.x_m / cell_m)
    start_rad = map_from_laser.heading_rad + first_rad
    ends_at = ranges <= params.laser_range_m
    clear_m = np.minimum(np.where(ranges > 0, ranges - params.clear_margin_m, 0.0), params.laser_range_m)
    here = _passed(clear_m, start_rad, step_rad, cell_m)
    flat_here = (row - first_row + here[0]) * width + column - first_column + here[1]
    values = flat[flat_here]
    flat[flat_here] = np.maximum(values, params.laser_down) - params.laser_down
    hit = ends_at & (ranges > 0)
    angles = start_rad + step_rad * np.flatnonzero(hit)
    ends_x = np.floor((map_from_laser.x_m + ranges[hit] * np.cos(angles)) / cell_m).astype(np.int64)
    ends_y = np.floor((map_from_laser.y_m + ranges[hit] * np.sin(angles)) / cell_m).astype(np.int64)
    ends = np.unique((ends_y - first_row) * width + ends_x - first_column)
    flat[ends] = np.minimum(flat[ends].astype(np.int16) + params.laser_up, 255)


def _passed(
    clear_m: npt.NDArray[np.float64], start_rad: float, step_rad: float, cell_m: float
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return rows and columns, relative to the sensor's cell, of the cells that lie nearer than their beam is clear."""
    fan = _fan(max(1, ceil(float(clear_m.max()))), cell_m)
    low_rad = (start_rad - step_rad / 2 + pi) % (2 * pi) - pi  # into the first turn of the fan
    span_rad = min(step_rad * len(clear_m), 2 * pi)
    a, b = np.searchsorted(fan.bearings_rad, (low_rad, low_rad + span_rad)).tolist()
    beams = ((fan.bearings_rad[a:b] - np.float32(low_rad)) * np.float32(1.0 / step_rad)).astype(np.int32)
    limits = np.append(clear_m, 0.0).astype(np.float32)
    passed = np.flatnonzero(fan.ranges_m[a:b] < limits[np.minimum(beams, len(clear_m))])
    return fan.rows[a:b][passed], fan.columns[a:b][passed]
