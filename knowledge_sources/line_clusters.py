"""Clusters of heavily supported Hough cells, and the line that each stands for.

Source: Bou-Ghannam 1992, section 5.2.3, steps 4 and 5.
"""

import numpy as np
import numpy.typing as npt

from knowledge_sources.echoes import Array, wrap
from knowledge_sources.max_min_clustering import max_min_centres


def line_distances(
    alpha_rad: Array, rho_m: Array, to_alpha_rad: float, to_rho_m: float, lever_m: float
) -> tuple[Array, Array, Array]:
    """Return how far lines are from one of them: the distance (n,) in metres, and its parts in alpha and rho.

    An angle counts as the way it makes at `lever_m`. A line near the origin is close to one that looks the other way,
    (alpha, rho) being (alpha + pi, -rho): the nearer of both forms counts.
    """
    turn, shift = wrap(alpha_rad - to_alpha_rad), rho_m - to_rho_m
    other_turn, other_shift = wrap(turn + np.pi), -rho_m - to_rho_m
    distance, other = np.hypot(turn * lever_m, shift), np.hypot(other_turn * lever_m, other_shift)
    nearer = distance <= other
    return np.minimum(distance, other), np.where(nearer, turn, other_turn), np.where(nearer, shift, other_shift)


def cluster_lines(
    alpha_rad: Array, rho_m: Array, lever_m: float, fraction: float, resolution_m: float = np.inf
) -> tuple[list[int], npt.NDArray[np.intp]]:
    """Return the max-min centres of the lines, and which centre each is nearest to (step 4)."""

    def distances_from(k: int) -> Array:
        return line_distances(alpha_rad, rho_m, float(alpha_rad[k]), float(rho_m[k]), lever_m)[0]

    return max_min_centres(len(alpha_rad), distances_from, fraction, resolution_m)


def mean_line(
    alpha_rad: Array, rho_m: Array, weights: Array, centre_alpha_rad: float, centre_rho_m: float
) -> tuple[float, float]:
    """Return the support-weighted mean (alpha in [0, 2 pi), rho >= 0) of a cluster's lines (step 5).

    Angles are averaged about the centre's, so that a cluster may lie across 0 degrees or across the origin.
    """
    _, turn, shift = line_distances(alpha_rad, rho_m, centre_alpha_rad, centre_rho_m, 1.0)
    total = float(weights.sum())
    alpha = centre_alpha_rad + float(weights @ turn) / total
    rho = centre_rho_m + float(weights @ shift) / total
    return (alpha + (np.pi if rho < 0.0 else 0.0)) % (2.0 * np.pi), abs(rho)
