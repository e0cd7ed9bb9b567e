"""What all readings of a straightened drive saw, as one set of points: what a line finder needs.

Ends of beams in one cell are one point, their mean. A cell with a single end is left out: someone who passed by, or a beam that
grazed an edge. Of an echo of a cone the middle of what is left of its arc counts, if that is short enough to say where the wall is.
"""

import numpy as np

from blackboard.messages.geometry import pack_array
from blackboard.messages.world import PointSet
from knowledge_sources.laser_graph.cones import Bools, Cones
from knowledge_sources.laser_graph.poses import Floats, transform
from knowledge_sources.laser_graph.scan_points import ScanPoints

CELL_M = 0.05  # the grid's
FARTHEST_M = 8.0  # a tenth of a degree in the heading is 1.4 cm there
LONGEST_ARC_M = 0.3


def beam_ends(scans: list[ScanPoints], poses: Floats) -> PointSet:
    """Return the ends of all beams of scans taken at poses (n, 3)."""
    points, seen_from = [np.zeros((0, 2))], [np.zeros((0, 2))]
    for scan, pose in zip(scans, poses, strict=True):
        near = scan.points[np.hypot(scan.points[:, 0], scan.points[:, 1]) < FARTHEST_M]
        points.append(transform(pose, near))
        seen_from.append(np.broadcast_to(pose[:2], near.shape))
    return _point_set(np.concatenate(points), np.concatenate(seen_from), least=2)


def echo_middles(cones: Cones, poses: Floats, keep: Bools) -> PointSet:
    """Return where the echoes of cones came from, with what carving left of their arcs (n, c, samples)."""
    points, seen_from = [np.zeros((0, 2))], [np.zeros((0, 2))]
    for arcs, kept, pose in zip(cones.arcs, keep, poses, strict=True):
        heard = np.flatnonzero(kept.any(axis=1))
        last = kept.shape[1] - 1 - np.argmax(kept[:, ::-1], axis=1)
        first = np.argmax(kept, axis=1)
        ends = arcs[heard, first[heard]], arcs[heard, last[heard]]
        short = np.hypot(*(ends[1] - ends[0]).T) <= LONGEST_ARC_M
        middles = 0.5 * (ends[0] + ends[1])
        points.append(transform(pose, middles[short]))
        seen_from.append(transform(pose, cones.mounts[heard[short], :2]))
    return _point_set(np.concatenate(points), np.concatenate(seen_from), least=1)


def _point_set(points: Floats, seen_from: Floats, least: int) -> PointSet:
    cells = np.floor(points / CELL_M).astype(np.int64)
    _, first, cell, count = np.unique(
        cells[:, 0] * 10_000_019 + cells[:, 1], return_index=True, return_inverse=True, return_counts=True
    )
    cell = cell.reshape(-1)
    means = np.stack([np.bincount(cell, points[:, axis], len(first)) / np.maximum(count, 1) for axis in (0, 1)], axis=1)
    counts = np.flatnonzero(count >= least)
    return PointSet(
        points=pack_array(means[counts].astype(np.float32)),
        sensed_from=pack_array(seen_from[first[counts]].astype(np.float32)),
        half_cone_rad=pack_array(np.zeros(len(counts), dtype=np.float32)),
        dropped=len(first) - len(counts),
    )
