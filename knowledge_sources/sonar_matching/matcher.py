"""The pose from which the grid explains the echoes best, and how sharply it does so.

The score of a pose is the sum over echoes of the logarithm of a normal distribution about the expected range with a floor for
those that have nothing to do with the grid. An echo from where nothing is known yet scores alike for every pose: else the pose
would be drawn back to what is mapped. The score's slope and curvature are measured over steps as wide as the grid is rough; where
it does not curve down (along a corridor) it tells nothing, and the pose stays where odometry put it.
"""

from dataclasses import dataclass
from math import inf

import numpy as np
import numpy.typing as npt

from blackboard.grid import Grid
from blackboard.messages.geometry import Pose
from knowledge_sources.sonar_matching.forward_model import cover, expect
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.window import Heard

Floats = npt.NDArray[np.float64]

WIDE = np.array([0.10, 0.10, 0.06])  # m, m, rad: two cells; the same at 1.7 m, where most walls are
NARROW = WIDE / 2.0
LONGEST_STEP = np.array([0.15, 0.15, 0.08])  # of one iteration: as far as the wide steps were measured
ITERATIONS = 8
SETTLED = np.array([0.005, 0.005, 0.003])
SLACK_M = 2.0  # no iteration leads further: all longest steps and a stencil
PAIRS = ((0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """`shift` (3,) of the pose in the map frame (x_m, y_m, heading_rad), the prior included; `information` (3, 3) of the echoes."""

    shift: Floats
    information: Floats
    echoes: int  # that came from known places


def match(
    grid: Grid, heard: Heard, map_from_robot: Pose, prior_covariance: Floats, weight: float, params: SonarMatcherParams
) -> Match | None:
    """Return the most probable shift of `map_from_robot`; None where too few echoes come from known places.

    `prior_covariance` (3, 3) is that of the pose; `weight` says how many of the echoes are news, as a fraction.
    """
    if len(heard.ranges_m) < params.least_echoes:
        return None
    cover(grid, heard, map_from_robot, params, SLACK_M)
    pose = np.array([map_from_robot.x_m, map_from_robot.y_m, map_from_robot.heading_rad])
    prior = np.linalg.inv(prior_covariance)
    shift: Floats = np.zeros(3)
    step: Floats = np.zeros(3)
    best, found = -inf, None
    for iteration in range(ITERATIONS):
        widths = WIDE if iteration == 0 else NARROW
        scores, known = score(grid, heard, pose + shift + stencil(widths), params)
        if known < params.least_echoes:
            return found
        if iteration > 0:
            probability = weight * float(scores.mean()) - 0.5 * float(
                shift @ prior @ shift
            )  # rough: the mean is smoother
            if probability < best:  # it went too far
                step = step / 2.0
                shift = shift - step
                continue
            best = probability
        slope, curvature = slope_and_curvature(weight * scores, widths)
        information, slope = informative(curvature, slope)
        if found is not None and bool((np.abs(step) < SETTLED).all()):
            return Match(shift, information, known)
        found = Match(shift, information, known)
        newton = np.linalg.solve(prior + information, slope - prior @ shift)
        step = np.asarray(newton / max(1.0, float(np.max(np.abs(newton) / LONGEST_STEP))), np.float64)
        shift = shift + step
    return found


def surprise(found: Match, prior_covariance: Floats) -> float:
    """Return the squared normal distance between where the prior and where the echoes alone put the pose.

    `found.shift` lies between the two, where their pulls are equal: the prior's tells how far off the echoes' own pose is.
    """
    pull = np.linalg.solve(prior_covariance, found.shift)
    return float(pull @ found.shift + pull @ np.linalg.pinv(found.information, rcond=1e-6, hermitian=True) @ pull)


def score(grid: Grid, heard: Heard, poses: Floats, params: SonarMatcherParams) -> tuple[Floats, int]:
    """Return the score of each of `poses` (m, 3), and how many echoes it counts.

    They are those that come from known places as seen from the first pose; the same for all, so that poses compare.
    """
    expected = expect(grid, heard, poses, params)
    off = np.minimum(np.abs(expected.ranges_m - heard.ranges_m), 1e3) / params.sigma_m
    floor = params.outlier_fraction
    each = np.log(floor + (1.0 - floor) * np.exp(-0.5 * off * off))  # (m, n)
    known = expected.known[0]
    return each[:, known].sum(axis=1), int(known.sum())


def stencil(widths: Floats) -> Floats:
    """Return the thirteen shifts (13, 3) that `slope_and_curvature` wants the score at: none, one at a time, two at a time."""
    shifts = [np.zeros(3)]
    axes = np.diag(widths)
    for axis in axes:
        shifts += [axis, -axis]
    for a, b in PAIRS:
        shifts += [axes[a] + axes[b], -axes[a] - axes[b]]
    return np.array(shifts)


def slope_and_curvature(scores: Floats, widths: Floats) -> tuple[Floats, Floats]:
    """Return gradient (3,) and Hessian (3, 3) by central differences."""
    up, down = scores[1:7:2], scores[2:7:2]
    slope = (up - down) / (2.0 * widths)
    curvature = np.diag((up + down - 2.0 * scores[0]) / widths**2)
    for pair, (a, b) in enumerate(PAIRS):
        both = scores[7 + 2 * pair] + scores[8 + 2 * pair] - 2.0 * scores[0]
        alone = curvature[a, a] * widths[a] ** 2 + curvature[b, b] * widths[b] ** 2
        curvature[a, b] = curvature[b, a] = (both - alone) / (2.0 * widths[a] * widths[b])
    return slope, curvature


def informative(curvature: Floats, slope: Floats) -> tuple[Floats, Floats]:
    """Return the information (3, 3), its negative eigenvalues clipped to none, and the slope along what it informs of."""
    values, axes = np.linalg.eigh(-curvature)  # a radian counts as a metre: walls are a few metres off
    information = (axes * np.maximum(values, 0.0)) @ axes.T
    return information, axes @ (np.where(values > 0.0, 1.0, 0.0) * (axes.T @ slope))
