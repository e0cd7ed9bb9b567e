"""Settles a drive that has closed: every scan is aligned to all the scans around it at once.

Each pair of near scans contributes its point-to-line normal equations to one sparse system (Lu and Milios 1997, "Globally
consistent range scan alignment for environment mapping", with Censi's metric).
"""

import numpy as np
from scipy.spatial import cKDTree

from knowledge_sources.laser_graph.point_to_line import SIGMA_M
from knowledge_sources.laser_graph.pose_graph import Edges, Indices, difference, newton_step, relative
from knowledge_sources.laser_graph.poses import Floats, between, rotate, wrap
from knowledge_sources.laser_graph.scan_points import ScanPoints

NEAR_M = 3.0
FACING_RAD = 2.0


def near_pairs(poses: Floats, near_m: float = NEAR_M) -> tuple[Indices, Indices]:
    """Return the pairs (first, last) of scans that stand near each other and look the same way, both ways round, by first."""
    pairs = cKDTree(poses[:, :2]).query_pairs(near_m, output_type="ndarray")
    pairs = pairs[np.abs(wrap(poses[pairs[:, 0], 2] - poses[pairs[:, 1], 2])) < FACING_RAD]
    both = np.concatenate([pairs, pairs[:, ::-1]])
    both = both[np.lexsort((both[:, 1], both[:, 0]))]
    return both[:, 0], both[:, 1]


def settle(
    scans: list[ScanPoints], poses: Floats, odometry: Edges, reaches_m: tuple[float, ...], every: int = 3
) -> Floats:
    """Return the poses (n, 3) at which near scans lie on each other's lines; one iteration for each reach.

    `odometry` holds what no scan holds (along a corridor); every `every`th point of a scan is used.
    """
    trees = [cKDTree(scan.points[scan.flat]) if scan.flat.any() else None for scan in scans]
    flat = [(scan.points[scan.flat], scan.normals[scan.flat]) for scan in scans]
    thin = [(points[::every], normals[::every]) for points, normals in flat]
    for reach_m in reaches_m:
        first, last = near_pairs(poses)
        seen = between(poses[first], poses[last])
        information, gradient = np.zeros((len(first), 3, 3)), np.zeros((len(first), 3))
        bounds = np.searchsorted(first, np.arange(len(poses) + 1))
        for j in range(len(poses)):
            span = slice(bounds[j], bounds[j + 1])
            tree = trees[j]
            if tree is None or span.start == span.stop:
                continue
            others = last[span]
            sizes = np.array([len(thin[i][0]) for i in others])
            if not sizes.sum():
                continue
            pair = np.repeat(np.arange(len(others)), sizes)
            pose = seen[span][pair]
            arm = rotate(pose, np.concatenate([thin[i][0] for i in others]))
            turned = rotate(pose, np.concatenate([thin[i][1] for i in others]))
            on = arm + pose[:, :2]
            distance, nearest = tree.query(on, distance_upper_bound=reach_m)
            found = np.isfinite(distance)
            lines = flat[j][1][np.where(found, nearest, 0)]
            found &= np.sum(turned * lines, axis=1) > 0.7
            pair, arm, on, lines, nearest = pair[found], arm[found], on[found], lines[found], nearest[found]
            residual = np.sum((on - flat[j][0][nearest]) * lines, axis=1)
            jacobian = np.column_stack([lines, lines[:, 1] * arm[:, 0] - lines[:, 0] * arm[:, 1]])
            weight = 1.0 / (1.0 + (residual / (0.5 * reach_m)) ** 2) ** 2 / SIGMA_M**2
            for a in range(3):
                gradient[span, a] = np.bincount(pair, jacobian[:, a] * residual * weight, minlength=len(others))
                for b in range(a, 3):
                    sums = np.bincount(pair, jacobian[:, a] * jacobian[:, b] * weight, minlength=len(others))
                    information[span, a, b] = information[span, b, a] = sums
        error = difference(between(poses[odometry.first], poses[odometry.last]), odometry.measured)
        first, last = np.concatenate([first, odometry.first]), np.concatenate([last, odometry.last])
        information = np.concatenate([information, odometry.information])
        gradient = np.concatenate([gradient, np.einsum("nij,nj->ni", odometry.information, error)])
        _, change = relative(poses, first, last)
        poses = poses + newton_step(len(poses), first, last, change, information, gradient)
        poses[:, 2] = wrap(poses[:, 2])
    return poses
