"""What echo a sonar would hear in a grid: that of the nearest occupied cell on any ray of its cone.

The minimum over rays, since a cone answers from wherever it first touches something, which is at its edge more often than on its
axis; a measured range put on the axis would be biased.
"""

from dataclasses import dataclass
from math import hypot

import numpy as np
import numpy.typing as npt

from blackboard.grid import Cells, Grid
from blackboard.messages.geometry import Pose
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.window import Heard

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

BEYOND_SIGMAS = 4.0  # rays end so far behind the measured range: what lies further is no nearer to explaining it
BLOCKS = 4  # echoes of like range are predicted together: near ones need short rays
BAND_CELLS = 2  # before a wall that are neither empty nor occupied, and say nothing of what is known


@dataclass(frozen=True, slots=True, eq=False)
class Expected:
    """For m poses and n sonars, (m, n): the expected range, inf where no echo is; whether the way to it has been seen."""

    ranges_m: Floats
    known: Bools


def cover(grid: Grid, heard: Heard, map_from_robot: Pose, params: SonarMatcherParams, slack_m: float) -> None:
    """Let the grid grow until it holds every ray of `expect`, from all poses within `slack_m` of `map_from_robot`."""
    if not len(heard.ranges_m):
        return
    offset_m = max(hypot(x_m, y_m) for x_m, y_m, _ in heard.sensors)
    reach_m = offset_m + float(heard.ranges_m[-1]) + BEYOND_SIGMAS * params.sigma_m + slack_m + 2 * grid.cell_m
    x_m, y_m = map_from_robot.x_m, map_from_robot.y_m
    grid.cover(x_m - reach_m, y_m - reach_m, x_m + reach_m, y_m + reach_m)


def expect(grid: Grid, heard: Heard, poses: Floats, params: SonarMatcherParams) -> Expected:
    """Return what would be heard from `poses` (m, 3), map_from_robot, in place of each echo. `cover` must have been called."""
    blocks = [
        _expect(grid, heard.sensors[block], heard.cones_rad[block], float(heard.ranges_m[block[-1]]), poses, params)
        for block in np.array_split(np.arange(len(heard.ranges_m)), BLOCKS)
        if len(block)
    ]
    return Expected(
        np.concatenate([block.ranges_m for block in blocks], axis=1),
        np.concatenate([block.known for block in blocks], axis=1),
    )


def _expect(
    grid: Grid, sensors: Floats, cones_rad: Floats, longest_m: float, poses: Floats, params: SonarMatcherParams
) -> Expected:
    flat, width, first_row, first_column = grid.flat()
    cell_m = grid.cell_m
    c, s = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
    x = (poses[:, :1] + c * sensors[:, 0] - s * sensors[:, 1]) / cell_m - first_column  # (m, n) cells
    y = (poses[:, 1:2] + s * sensors[:, 0] + c * sensors[:, 1]) / cell_m - first_row
    across = np.linspace(-0.5, 0.5, params.rays) if params.rays > 1 else np.zeros(1)
    bearings = (poses[:, 2:] + sensors[:, 2])[:, :, None] + cones_rad[:, None] * across  # (m, n, rays)
    steps = int(np.ceil((longest_m + BEYOND_SIGMAS * params.sigma_m) / cell_m))
    along = np.arange(steps, dtype=np.float32) + np.float32(0.5)  # one sample a cell
    columns = x.astype(np.float32)[:, :, None, None] + np.cos(bearings).astype(np.float32)[..., None] * along
    rows = y.astype(np.float32)[:, :, None, None] + np.sin(bearings).astype(np.float32)[..., None] * along
    places = rows.astype(np.int32)  # all coordinates are positive inside the grid
    places *= width
    places += columns.astype(np.int32)
    values: Cells = flat[places]  # (m, n, rays, steps)
    occupied: Bools = values >= params.occupied_from
    hit: Bools = np.any(occupied, axis=2)
    there: Bools = np.any(hit, axis=2)
    first = np.where(there, hit.argmax(axis=2), steps)
    unknown = ((values >= params.empty_below) & ~occupied).sum(axis=2).cumsum(axis=2)  # on all rays, up to each step
    before = np.clip(first - BAND_CELLS - 1, 0, steps - 1)
    passed = np.take_along_axis(unknown, before[..., None], axis=2)[..., 0]
    ranges_m = np.where(there, (first + 0.5) * cell_m + params.wall_behind_m, np.inf)
    return Expected(ranges_m, passed <= params.unknown_cells * params.rays)
