"""Which points of the walls a robot could see from where it has been: a line of sight within the range of its sensors."""

import numpy as np
import numpy.typing as npt

from blackboard.report.result import Trajectory
from blackboard.report.walls import Samples, Segments

POSE_STEP_M = 0.25  # one pose in each square of this side is enough: what is seen changes little in between
TOUCH_M = 1e-3  # the line of sight may end this far before the point, so that the point's own wall does not hide it


def viewpoints(trajectory: Trajectory) -> npt.NDArray[np.float64]:
    """Return positions (n, 2): the first pose in each square of POSE_STEP_M, in the order of the trajectory."""
    positions = trajectory[:, 1:3]
    squares = np.floor(positions / POSE_STEP_M).astype(np.int64)
    first = np.unique(squares, axis=0, return_index=True)[1]
    return positions[np.sort(first)]


def visible(
    samples: Samples, edges: Segments, positions: npt.NDArray[np.float64], range_m: float
) -> npt.NDArray[np.bool_]:
    """Return which samples of `edges` some position sees. The robot looks all around; an edge is seen from its left only."""
    seen = np.zeros(len(samples.points), dtype=np.bool_)
    for position in positions:
        rays = samples.points - position
        candidates = np.flatnonzero(
            ~seen & ((rays**2).sum(axis=1) <= range_m**2) & (_cross(samples.directions, -rays) > 0)
        )
        if not len(candidates):
            continue
        starts = edges[:, :2] - position
        along = edges[:, 2:] - edges[:, :2]
        facing = (_cross(along, -starts) > 0) & (_distance(starts, along) <= range_m)
        seen[candidates] = ~_hidden(rays[candidates], starts[facing], along[facing])
    return seen


def _hidden(
    rays: npt.NDArray[np.float64], starts: npt.NDArray[np.float64], along: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """Return which rays (n, 2) from the origin meet an edge (m, 2), (m, 2) before their end.

    With ray t r and edge s + u e: t = (s x e) / (r x e), u = (s x r) / (r x e).
    """
    across = _cross(rays[:, None], along[None])  # (n, m)
    parallel = np.abs(across) < 1e-12
    across = np.where(parallel, 1.0, across)
    t = _cross(starts, along)[None] / across
    u = _cross(starts[None], rays[:, None]) / across
    end = 1.0 - TOUCH_M / np.hypot(rays[:, 0], rays[:, 1])
    meets = ~parallel & (t > 0) & (t < end[:, None]) & (u >= -1e-9) & (u <= 1.0 + 1e-9)
    return np.asarray(meets.any(axis=1))


def _distance(starts: npt.NDArray[np.float64], along: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return how far the edges lie from the origin."""
    u = np.clip(-(starts * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    nearest = starts + u[:, None] * along
    return np.asarray(np.hypot(nearest[:, 0], nearest[:, 1]))


def _cross(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
