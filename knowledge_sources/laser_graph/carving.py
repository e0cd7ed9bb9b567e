"""Where on its arc an echo may have come from: not where another cone found nothing.

What is left of the arcs after carving are walls. An echo of which nothing is left was broken by others: with the right poses
few are, with wrong ones many, so that the share of the unbroken tells how right the shape of a drive is.
"""

import numpy as np

from knowledge_sources.laser_graph.closures import candidates
from knowledge_sources.laser_graph.cones import Bools, Cones, depth
from knowledge_sources.laser_graph.poses import Floats, between, rotate

NEIGHBOURS = 8  # keyframes to either side that carve: those whose relative poses odometry knows well
NEAR_M = 3.0  # keyframes of other passes as far off have much in view together


def carve(cones: Cones, poses: Floats) -> Bools:
    """Return which places on the arcs (n, c, samples) no neighbour in time says were free."""
    count, _, samples, _ = cones.arcs.shape
    keep = np.repeat(cones.heard[:, :, None], samples, axis=2)
    for offset in (o for o in range(-NEIGHBOURS, NEIGHBOURS + 1) if o):
        seen = np.arange(max(0, -offset), min(count, count - offset))
        if len(seen):
            keep[seen] &= _depth_from(cones, poses, seen, seen + offset) <= 1.0
    return keep


def unbroken_fraction(cones: Cones, poses: Floats) -> float:
    """Return of how many of the echoes something is left; 1 where there are none."""
    left = np.asarray(carve(cones, poses).any(axis=2))[cones.heard]
    return float(left.mean()) if len(left) else 1.0


def contradicted_fraction(cones: Cones, poses: Floats) -> tuple[float, int]:
    """Return how many of the echoes seen again from another pass that pass contradicts, and how many were seen again.

    Contradicted: the whole arc lies where the other found nothing. Borne out: some of it lies where the other's cone ended.
    What was out of the other's sight does not count. A fraction of 0 where nothing was seen again.
    """
    pairs = candidates(poses, NEAR_M, 1)
    if not pairs:
        return 0.0, 0
    first, last = (np.array(side, dtype=np.intp) for side in zip(*pairs, strict=True))
    seen, viewers = np.concatenate([last, first]), np.concatenate([first, last])
    depths = _depth_from(cones, poses, seen, viewers)
    against = (depths > 1.0).all(axis=2) & cones.heard[seen]
    borne_out = (np.abs(depths) <= 1.0).any(axis=2) & cones.heard[seen]
    count = int(against.sum() + borne_out.sum())
    return (float(against.sum()) / count if count else 0.0), count


def _depth_from(cones: Cones, poses: Floats, seen: np.ndarray, viewers: np.ndarray) -> Floats:
    """Return how deep the arcs of keyframes lie in what others heard: (m, c, samples)."""
    pose = between(poses[viewers], poses[seen])
    shape = cones.arcs.shape[1:3]
    arcs = cones.arcs[seen].reshape(len(seen), -1, 2)
    placed = rotate(pose[:, None, :], arcs) + pose[:, None, :2]
    return depth(cones, viewers, placed).reshape(len(seen), *shape)
