"""The pose from which the grid explains the echoes best, and how sharply it does so.

The score of a pose is the sum over echoes of the logarithm of a normal distribution about the expected range with a floor for
those that have nothing to do with the grid. An echo from where nothing is known yet scores alike for every pose: else the pose
would be drawn back to what is mapped. The score's slope and curvature are measured over steps as wide as the grid is rough; where
it does not curve down (along a corridor) it tells nothing, and the pose stays where odometry put it.
"""

from dataclasses import dataclass, replace
from math import inf

import numpy as np
import numpy.typing as npt

from blackboard.grid import Grid
from blackboard.messages.geometry import Pose
from knowledge_sources.sonar_matching.forward_model import expect, inside, known, take
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.window import Heard

Floats = npt.NDArray[np.float64]

WIDE = np.array([0.10, 0.10, 0.06])  # m, m, rad: two cells; the same at 1.7 m, where most walls are
NARROW = WIDE / 2.0
LONGEST_STEP = np.array([0.15, 0.15, 0.08])  # of one iteration: as far as the wide steps were measured
ITERATIONS = 8
SETTLING = 3  # iterations over which the common offset follows the pose
FITS_SIGMAS = 2.0
SETTLED = np.array([0.005, 0.005, 0.003])
MARGIN_M = 1.5  # no iteration leads an echo further
LIKELY_M = 0.25  # an echo off by more has nothing to do with the wall
SHRINK = 5  # echoes' worth of belief that walls stand in the middle of their bands
PAIRS = ((0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """`shift` (3,) of the pose in the map frame (x_m, y_m, heading_rad), the prior included; `information` (3, 3) of the echoes."""

    shift: Floats
    information: Floats
    echoes: int  # that came from known places
    fitting: float = 1.0  # fraction of them that the grid explains


def match(
    grid: Grid,
    heard: Heard,
    patch_from_robot: Pose,
    prior_covariance: Floats,
    weight: float,
    params: SonarMatcherParams,
) -> Match | None:
    """Return the most probable shift of `patch_from_robot`; None where too few echoes come from known places.

    `prior_covariance` (3, 3) is that of the pose; `weight` says how many of the echoes are news, as a fraction.
    """
    heard = take(heard, inside(grid, heard, patch_from_robot, MARGIN_M))
    if len(heard.ranges_m) >= params.least_echoes:
        heard = take(heard, known(grid, heard, patch_from_robot, params))
    if len(heard.ranges_m) < params.least_echoes:
        return None
    pose = np.array([patch_from_robot.x_m, patch_from_robot.y_m, patch_from_robot.heading_rad])
    prior = np.linalg.inv(prior_covariance)
    shift: Floats = np.zeros(3)
    step: Floats = np.zeros(3)
    behind_m = 0.0
    best, found = -inf, None
    for iteration in range(ITERATIONS):
        widths = WIDE if iteration == 0 else NARROW
        if iteration < SETTLING:
            behind_m = common_offset(grid, heard, pose + shift, params)
        scores = score(grid, heard, pose + shift + stencil(widths), behind_m, params)
        if iteration > 0:
            # rough: the mean over the stencil is smoother than the score itself
            probability = weight * float(scores.mean()) - 0.5 * float(shift @ prior @ shift)
            if probability < best:  # it went too far
                step = step / 2.0
                shift = shift - step
                continue
            best = probability
        slope, curvature = slope_and_curvature(weight * scores, widths)
        information, slope = informative(curvature, slope)
        settled = found is not None and bool((np.abs(step) < SETTLED).all())
        found = Match(shift, information, len(heard.ranges_m))
        if settled:
            break
        newton = np.linalg.solve(prior + information, slope - prior @ shift)
        step = np.asarray(newton / max(1.0, float(np.max(np.abs(newton) / LONGEST_STEP))), np.float64)
        shift = shift + step
    if found is None:
        return None
    off = expect(grid, heard, (pose + found.shift)[None, :], params)[0] - behind_m
    return replace(found, fitting=float((np.abs(off) < FITS_SIGMAS * params.sigma_m).mean()))


def surprise(found: Match, prior_covariance: Floats) -> float:
    """Return the squared normal distance between where the prior and where the echoes alone put the pose.

    `found.shift` lies between the two, where their pulls are equal: the prior's tells how far off the echoes' own pose is.
    """
    pull = np.linalg.solve(prior_covariance, found.shift)
    return float(pull @ found.shift + pull @ np.linalg.pinv(found.information, rcond=1e-6, hermitian=True) @ pull)


def common_offset(grid: Grid, heard: Heard, pose: Floats, params: SonarMatcherParams) -> float:
    """Return by how much the grid's walls lie behind those that are heard, whatever the direction: their bands are not centred."""
    off = expect(grid, heard, pose[None, :], params)[0]
    near = off[np.abs(off) < LIKELY_M]
    return float(np.median(near)) * len(near) / (len(near) + SHRINK) if len(near) else 0.0


def score(grid: Grid, heard: Heard, poses: Floats, behind_m: float, params: SonarMatcherParams) -> Floats:
    """Return the score of each of `poses` (m, 3), walls taken to lie `behind_m` nearer than in the grid."""
    off = (expect(grid, heard, poses, params) - behind_m) / params.sigma_m
    floor = params.outlier_fraction
    total: Floats = np.log(floor + (1.0 - floor) * np.exp(-0.5 * off * off)).sum(axis=1)
    return total


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
