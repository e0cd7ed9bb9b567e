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
    unseen = np.arange(len(samples.points))
    blocker = np.zeros(len(unseen), dtype=np.int64)  # the edge that hid each sample last is likely to hide it again
    along = edges[:, 2:] - edges[:, :2]
    for position in positions:
        if not len(unseen):
            break
        rays = samples.points[unseen] - position
        tried = (np.hypot(rays[:, 0], rays[:, 1]) <= range_m) & (_cross(samples.directions[unseen], rays) < 0)
        starts = edges[:, :2] - position
        faces = _cross(along, starts) < 0
        last = blocker[unseen[tried]]
        tried[tried] = ~(_meet(rays[tried], starts[last], along[last]) & faces[last])
        if not tried.any():
            continue
        facing = np.flatnonzero(faces & (_distance(starts, along) <= range_m))
        meets = _meet(rays[tried][:, None], starts[facing], along[facing])  # (n, m)
        hidden = meets.any(axis=1)
        chosen = np.flatnonzero(tried)
        if hidden.any():
            blocker[unseen[chosen[hidden]]] = facing[meets[hidden].argmax(axis=1)]
        unseen = np.delete(unseen, chosen[~hidden])
    seen = np.ones(len(samples.points), dtype=np.bool_)
    seen[unseen] = False
    return seen


def _meet(
    rays: npt.NDArray[np.float64], starts: npt.NDArray[np.float64], along: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """Return which rays from the origin meet which edges before their own end, by broadcasting.

    With ray t r and edge s + u e: t = (s x e) / (r x e), u = (s x r) / (r x e).
    """
    across = _cross(rays, along)
    parallel = np.abs(across) < 1e-12
    across = np.where(parallel, 1.0, across)
    t = _cross(starts, along) / across
    u = _cross(starts, rays) / across
    end = 1.0 - TOUCH_M / np.maximum(np.hypot(rays[..., 0], rays[..., 1]), TOUCH_M)
    return np.asarray(~parallel & (t > 0) & (t < end) & (u >= -1e-9) & (u <= 1.0 + 1e-9))


def _distance(starts: npt.NDArray[np.float64], along: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return how far the edges lie from the origin."""
    u = np.clip(-np.einsum("ij,ij->i", starts, along) / np.einsum("ij,ij->i", along, along), 0.0, 1.0)
    nearest = starts + u[:, None] * along
    return np.asarray(np.hypot(nearest[:, 0], nearest[:, 1]))


def _cross(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
