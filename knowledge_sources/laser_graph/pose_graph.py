"""Poses out of relative poses: sparse least squares (Grisetti et al. 2010, "A tutorial on graph-based SLAM").

scipy.sparse factorises the normal equations; what does not fit is weighed down by a Cauchy kernel whose width shrinks from
iteration to iteration, so that a drive that is far from closed still closes (graduated non-convexity, Yang et al. 2020).
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from knowledge_sources.laser_graph.poses import Floats, between, wrap

Indices = npt.NDArray[np.intp]
ITERATIONS = 12
WIDEST = 100.0  # sigmas of the kernel at first, and at last
NARROWEST = 3.0
SMALLEST_STEP = 1e-5  # m and rad


@dataclass(frozen=True, eq=False)
class Edges:
    """Relative poses: pose `last[k]` is seen from pose `first[k]` at `measured` (n, 3) with `information` (n, 3, 3)."""

    first: Indices
    last: Indices
    measured: Floats
    information: Floats
    robust: npt.NDArray[np.bool_]  # may be wrong, such as a closure


def solve_graph(poses: Floats, edges: Edges) -> Floats:
    """Return the poses (n, 3) that fit the edges best, the first one held."""
    width = WIDEST
    for _ in range(ITERATIONS):
        seen, jacobian = relative(poses, edges.first, edges.last)
        error = difference(seen, edges.measured)
        chi = np.sqrt(np.einsum("ni,nij,nj->n", error, edges.information, error))
        weight = np.where(edges.robust, 1.0 / (1.0 + (chi / width) ** 2), 1.0)
        information = edges.information * weight[:, None, None]
        gradient = np.einsum("nij,nj->ni", information, error)
        step = newton_step(len(poses), edges.first, edges.last, jacobian, information, gradient)
        poses = poses + step
        poses[:, 2] = wrap(poses[:, 2])
        if width <= NARROWEST and float(np.abs(step).max()) < SMALLEST_STEP:
            break
        width = max(width / 2.0, NARROWEST)
    return poses


def difference(a: Floats, b: Floats) -> Floats:
    """Return a - b of poses (n, 3) in one frame."""
    error = a - b
    error[:, 2] = wrap(error[:, 2])
    return error


def relative(poses: Floats, first: Indices, last: Indices) -> tuple[Floats, Floats]:
    """Return first_from_last (n, 3), and how it changes with the two poses (n, 3, 6)."""
    a, b = poses[first], poses[last]
    seen = between(a, b)
    c, s, zero, one = np.cos(a[:, 2]), np.sin(a[:, 2]), np.zeros(len(a)), np.ones(len(a))
    rows = [[-c, -s, seen[:, 1], c, s, zero], [s, -c, -seen[:, 0], -s, c, zero], [zero, zero, -one, zero, zero, one]]
    return seen, np.stack([np.stack(row, axis=1) for row in rows], axis=1)


def newton_step(
    n: int, first: Indices, last: Indices, jacobian: Floats, information: Floats, gradient: Floats
) -> Floats:
    """Return the step (n, 3) of the poses that lessens the errors most; `information` and `gradient` are of the relative poses."""
    blocks = np.einsum("nki,nkl,nlj->nij", jacobian, information, jacobian)  # (edges, 6, 6)
    sides = np.einsum("nki,nk->ni", jacobian, gradient)
    unknowns = np.concatenate([3 * first[:, None] + np.arange(3), 3 * last[:, None] + np.arange(3)], axis=1)
    rows, columns = np.broadcast_arrays(unknowns[:, :, None], unknowns[:, None, :])
    held = np.arange(3)
    hessian = coo_matrix(
        (
            np.concatenate([blocks.ravel(), np.full(3, 1e9)]),
            (np.concatenate([rows.ravel(), held]), np.concatenate([columns.ravel(), held])),
        ),
        shape=(3 * n, 3 * n),
    ).tocsc()
    right = np.bincount(unknowns.ravel(), weights=sides.ravel(), minlength=3 * n)
    step: Floats = splu(hessian, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(-right)
    return step.reshape(n, 3)
