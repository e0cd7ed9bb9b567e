"""Which lines a robot should see from where it stands."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, radians

import numpy as np
import numpy.typing as npt

from blackboard.parameters import require
from knowledge_sources.line_estimates import LineEstimate

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewLimits:
    """What counts as in view."""

    range_m: float = 3.0  # so far a sonar surely hears a wall
    incidence_rad: float = radians(30.0)  # so far off its normal even a smooth wall answers
    least_m: float = 0.5  # of a line in view, for it to be expected: less gives too few echoes for a line
    step_m: float = 0.1
    end_m: float = 0.1  # of a line that hides nothing: ends are unsure

    def __post_init__(self) -> None:
        require(0.0 < self.range_m <= 1000.0, "range_m", self.range_m, "(0, 1000] metres")
        require(0.0 < self.incidence_rad <= pi / 2, "incidence_rad", self.incidence_rad, "(0, pi/2]")
        require(self.least_m > 0.0, "least_m", self.least_m, "more than 0")
        require(0.01 <= self.step_m <= 1.0, "step_m", self.step_m, "[0.01, 1] metres")
        require(self.end_m >= 0.0, "end_m", self.end_m, "0 and more")


def lines_in_view(
    lines: Sequence[LineEstimate],
    x_m: float,
    y_m: float,
    limits: ViewLimits,
    hiding: Sequence[LineEstimate] | None = None,
) -> list[int]:
    """Return which lines should be seen from (x, y): near, from their own side, and not hidden by others (`hiding`: all)."""
    walls = [line for line in (lines if hiding is None else hiding) if line.half_length_m > limits.end_m]
    starts, ends = _cut_ends(walls, limits.end_m)
    expected = []
    for number, line in enumerate(lines):
        points = _points_in_reach(line, x_m, y_m, limits)
        if len(points) * limits.step_m < limits.least_m:
            continue
        seen = points[~_hidden(points, x_m, y_m, starts, ends)]
        if len(seen) * limits.step_m >= limits.least_m:
            expected.append(number)
    return expected


def _points_in_reach(line: LineEstimate, x_m: float, y_m: float, limits: ViewLimits) -> Array:
    """Return points (n, 2) of the line that are in range and looked at steeply enough, from its own side."""
    (c, s), (nx, ny) = line.direction, line.normal
    out = (x_m - line.x_m) * nx + (y_m - line.y_m) * ny  # the robot, to the right of the line
    if (out < 0.0) != line.faces_left:
        return np.zeros((0, 2))
    foot = (x_m - line.x_m) * c + (y_m - line.y_m) * s
    count = max(int(2 * line.half_length_m / limits.step_m), 1)
    along = (np.arange(count) + 0.5) * (2 * line.half_length_m / count) - line.half_length_m
    away = np.abs(along - foot)
    reach = (np.hypot(away, out) <= limits.range_m) & (away <= abs(out) * np.tan(limits.incidence_rad))
    along = along[reach]
    return np.stack([line.x_m + along * c, line.y_m + along * s], axis=1)


def _cut_ends(walls: Sequence[LineEstimate], end_m: float) -> tuple[Array, Array]:
    starts, ends = np.zeros((len(walls), 2)), np.zeros((len(walls), 2))
    for i, wall in enumerate(walls):
        (c, s), reach = wall.direction, wall.half_length_m - end_m
        starts[i] = wall.x_m - reach * c, wall.y_m - reach * s
        ends[i] = wall.x_m + reach * c, wall.y_m + reach * s
    return starts, ends


def _hidden(points: Array, x_m: float, y_m: float, starts: Array, ends: Array) -> npt.NDArray[np.bool_]:
    """Return which points (n, 2) lie behind one of k walls, seen from (x, y); a wall within a tenth of the way hides none."""
    if len(starts) == 0:
        return np.zeros(len(points), dtype=np.bool_)
    eye = np.array([x_m, y_m])
    ray = points[:, None, :] - eye  # (n, 1, 2)
    wall, start = (ends - starts)[None], starts[None] - eye  # (1, k, 2)
    cross = ray[..., 0] * wall[..., 1] - ray[..., 1] * wall[..., 0]  # (n, k)
    safe = np.where(np.abs(cross) < 1e-12, np.inf, cross)
    at_ray = (start[..., 0] * wall[..., 1] - start[..., 1] * wall[..., 0]) / safe
    at_wall = (start[..., 0] * ray[..., 1] - start[..., 1] * ray[..., 0]) / safe
    hides = (at_ray > 0.0) & (at_ray < 0.9) & (at_wall > 0.0) & (at_wall < 1.0) & np.isfinite(safe)
    hidden: npt.NDArray[np.bool_] = hides.any(axis=1)
    return hidden
