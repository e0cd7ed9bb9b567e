"""Aligns points to the lines on which their nearest neighbours lie, with a prior (Censi 2008; Gauss-Newton, robust weights)."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from knowledge_sources.laser_graph.poses import Floats, rotate, transform, wrap

SIGMA_M = 0.03  # of a point about the line of its neighbours: laser noise (0.01-0.02 m) and rough walls


@dataclass(frozen=True, eq=False)
class Surface:
    """Points with normals (n, 2) each, and a search tree of the points."""

    tree: cKDTree
    points: Floats
    normals: Floats


@dataclass(frozen=True, eq=False)
class Alignment:
    """Where the scan lies: pose (3,), information (3, 3) of (x, y, heading) there, share of points that found a line."""

    pose: Floats
    information: Floats
    matched_fraction: float
    rms_m: float


def surface(points: Floats, normals: Floats) -> Surface:
    """Return a surface to align to."""
    return Surface(cKDTree(points), points, normals)


def align(
    target: Surface,
    points: Floats,
    normals: Floats,
    guess: Floats,
    prior: Floats,
    prior_information: Floats,
    reaches_m: tuple[float, ...] = (0.4, 0.3, 0.2, 0.15, 0.1, 0.1),
    sigma_m: float = SIGMA_M,
) -> Alignment:
    """Return the pose in the target's frame at which the points lie on its lines, and what a prior pose says beside it.

    Each of `reaches_m` is an iteration: neighbours further off are left out. Lines whose normals differ by more than 45
    degrees do not match: a wall seen from its other side is another wall.
    """
    pose = guess.copy()
    information = prior_information.copy()
    if not len(target.points):
        return Alignment(pose, information, 0.0, np.inf)
    matched, rms = 0.0, np.inf
    for reach_m in reaches_m:
        placed = transform(pose, points)
        distance, nearest = target.tree.query(placed, distance_upper_bound=reach_m)
        found = np.isfinite(distance)
        nearest = np.where(found, nearest, 0)
        turned = rotate(pose, normals)
        lines = target.normals[nearest]
        found &= np.sum(turned * lines, axis=1) > 0.7
        matched = float(found.mean()) if len(found) else 0.0
        difference = wrap(pose - prior) * np.array([0, 0, 1]) + (pose - prior) * np.array([1, 1, 0])
        hessian, gradient = prior_information.copy(), prior_information @ difference
        if found.any():
            placed, lines, on = placed[found], lines[found], target.points[nearest[found]]
            residual = np.sum((placed - on) * lines, axis=1)
            arm = placed - pose[:2]
            jacobian = np.column_stack([lines, lines[:, 1] * arm[:, 0] - lines[:, 0] * arm[:, 1]])
            weight = 1.0 / (1.0 + (residual / (0.5 * reach_m)) ** 2) ** 2 / sigma_m**2
            hessian += jacobian.T @ (jacobian * weight[:, None])
            gradient += jacobian.T @ (residual * weight)
            rms = float(np.sqrt(np.mean(residual**2)))
        step = np.linalg.solve(hessian, -gradient)
        pose = pose + step
        pose[2] = wrap(pose[2])
        information = hessian
    return Alignment(pose, information, matched, rms)
