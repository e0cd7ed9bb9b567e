"""What echo a sonar would hear in a grid: that of the nearest occupied cell on any ray of its cone.

The minimum over rays, since a cone answers from wherever it first touches something, which is at its edge more often than on its
axis; a measured range put on the axis would be biased. Only what lies near the measured range is looked at: nothing else could
have sent the echo.
"""

import numpy as np
import numpy.typing as npt

from blackboard.grid import UNKNOWN, Cells, Grid
from blackboard.messages.geometry import Pose
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.window import Heard

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

BEYOND_SIGMAS = 4.0  # what lies further from the measured range does not explain it
BAND_M = 0.15  # before a wall, where cells are neither empty nor occupied and say nothing of what is known
THICKEST_M = 0.3  # a band of occupied cells behind the first counts up to here
OUTSIDE = 1e3  # the expected range where nothing near the measured one answers


def take(heard: Heard, which: Bools) -> Heard:
    """Return some of the echoes."""
    return Heard(heard.sensors[which], heard.ranges_m[which], heard.cones_rad[which])


def inside(grid: Grid, heard: Heard, pose: Pose, margin_m: float) -> Bools:
    """Say of which echoes the cone ends inside the grid by a margin, seen from `pose`."""
    ends = _places(heard, np.array([[pose.x_m, pose.y_m, pose.heading_rad]]), np.zeros((1, 1)), heard.ranges_m[:, None])
    x, y = ends[0][0, :, 0, 0], ends[1][0, :, 0, 0]
    rows, columns = grid.cells.shape
    x_max, y_max = grid.x_min_m + columns * grid.cell_m, grid.y_min_m + rows * grid.cell_m
    clear: Bools = (
        (x - grid.x_min_m > margin_m) & (x_max - x > margin_m) & (y - grid.y_min_m > margin_m) & (y_max - y > margin_m)
    )
    return clear


def known(grid: Grid, heard: Heard, pose: Pose, params: SonarMatcherParams) -> Bools:
    """Say which echoes, seen from `pose`, come from places that have been seen: the way to them is known, and where they end.

    At the edge of what is mapped a cone hears a wall's part that the grid lacks; the part that it has lies further back, and
    would draw the robot back with it.
    """
    here = np.array([[pose.x_m, pose.y_m, pose.heading_rad]])
    across = np.linspace(-0.5, 0.5, 5)[None, :]
    steps = np.array([0.5, 0.75, 0.9, 1.0])  # of the way up to the band
    along = np.maximum(heard.ranges_m - BAND_M, 0.0)[:, None] * steps
    ends = heard.ranges_m[:, None] + np.array([-0.5, 0.5]) * grid.cell_m
    least = UNKNOWN - params.empty_below
    passed = np.abs(_values(grid, heard, here, across, along)[0].astype(np.int16) - UNKNOWN) > least  # (n, rays, steps)
    ended = np.abs(_values(grid, heard, here, across, ends)[0].astype(np.int16) - UNKNOWN) > least
    there: Bools = ended.any(axis=2).all(axis=1)
    way: Bools = passed.reshape(len(passed), -1).mean(axis=1) >= params.known_fraction
    return there & way


def expect(grid: Grid, heard: Heard, poses: Floats, params: SonarMatcherParams) -> Floats:
    """Return by how much each echo, (m, n), would be longer than it was if heard from `poses` (m, 3), grid frame.

    OUTSIDE where nothing near it answers. The grid must hold all of it.
    """
    half_m = BEYOND_SIGMAS * params.sigma_m
    step_m = grid.cell_m / 2.0
    count = int(np.ceil(2.0 * half_m / step_m)) + 1
    offsets = (np.arange(count) - (count - 1) / 2.0) * step_m
    behind = int(THICKEST_M / step_m)
    along = heard.ranges_m[:, None] + np.concatenate([offsets, offsets[-1] + step_m * np.arange(1, behind + 1)])
    across = np.linspace(-0.5, 0.5, params.rays)[None, :] if params.rays > 1 else np.zeros((1, 1))
    values = _values(grid, heard, poses, across, along)
    occupied: Bools = values >= params.occupied_from  # (m, n, rays, steps)
    near = occupied[..., :count]
    first = np.where(near.any(axis=3), near.argmax(axis=3), count)  # (m, n, rays)
    ray = first.argmin(axis=2)
    at = np.take_along_axis(first, ray[..., None], axis=2)[..., 0]  # (m, n)
    there = at < count
    seen = np.take_along_axis(occupied, ray[..., None, None], axis=2)[:, :, 0]  # (m, n, steps)
    thick = seen.cumsum(axis=2, dtype=np.int16)
    start = np.minimum(at, count - 1)
    run = np.take_along_axis(thick, (start + behind)[..., None], axis=2)[..., 0]
    middle_m = offsets[start] + params.band_middle * np.maximum(run - 1, 0) * step_m
    off_m = np.where(there, middle_m, OUTSIDE)
    centre = values[..., count // 2 - 2 : count // 2 + 3 : 2]
    unknown = ((centre >= params.empty_below) & (centre < params.occupied_from)).any(axis=(2, 3))
    near_m: Floats = np.where(unknown, np.clip(off_m, -params.neutral_m, params.neutral_m), off_m)
    return near_m


def _values(grid: Grid, heard: Heard, poses: Floats, across: Floats, along: Floats) -> Cells:
    """Return the cells, (m, n, rays, steps), at `along` (n, steps) m on rays at `across` (1, rays) of the cones."""
    flat, width, first_row, first_column = grid.flat()
    x, y = _places(heard, poses, across, along)
    cell_m = np.float32(grid.cell_m)
    x /= cell_m
    y /= cell_m
    x -= np.float32(first_column)
    y -= np.float32(first_row)
    places = y.astype(np.int32)  # all coordinates are positive inside the grid
    places *= width
    places += x.astype(np.int32)
    found: Cells = flat.take(places, mode="clip")
    return found


def _places(
    heard: Heard, poses: Floats, across: Floats, along: Floats
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    sensors = heard.sensors
    c, s = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
    x = (poses[:, :1] + c * sensors[:, 0] - s * sensors[:, 1]).astype(np.float32)  # (m, n)
    y = (poses[:, 1:2] + s * sensors[:, 0] + c * sensors[:, 1]).astype(np.float32)
    bearings = (poses[:, 2:] + sensors[:, 2])[:, :, None] + heard.cones_rad[:, None] * across  # (m, n, rays)
    reach = along.astype(np.float32)[None, :, None, :]
    return (
        x[:, :, None, None] + np.cos(bearings).astype(np.float32)[..., None] * reach,
        y[:, :, None, None] + np.sin(bearings).astype(np.float32)[..., None] * reach,
    )
