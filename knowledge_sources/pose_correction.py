"""What matched lines say of the pose: a turn about the robot and a shift, each line weighing by its information.

Source: Bou-Ghannam 1992, section 5.2.4.2, whose plain means over lines and corner points it replaces: the mean of turns and
offsets by information, with what odometry allows as prior, is the Kalman equation (section 2.5.2). A corner needs no step of its
own: its two lines say both parts of the shift. Along what no line observes nothing moves: in a corridor, along it.

State: (x, y, heading) error of map_from_robot, about the robot's place.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

import numpy as np

from blackboard.messages.model import LineMatch
from blackboard.uncertainty.chi_square import chi_square_quantile
from blackboard.uncertainty.matrices import Array
from blackboard.uncertainty.normal_distance import normal_distance


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Correction:
    """Turn about the robot, then shift; `covariance` (3, 3) is the pose's afterwards. `used`: numbers of the matches."""

    shift_x_m: float
    shift_y_m: float
    turn_rad: float
    covariance: Array
    kept: Array  # (3, 3): what of the error before is left
    used: tuple[int, ...]
    distance: float  # squared normal distance of the jump under the pose's uncertainty before
    bound: float

    @property
    def allowed(self) -> bool:
        """Say whether the pose's uncertainty allows the jump."""
        return self.distance <= self.bound


def measurement(match: LineMatch, x_m: float, y_m: float) -> Array:
    """Return H (2, 3): how turn and offset of a match answer to the pose's error, the robot being at (x, y)."""
    nx, ny = sin(match.theta_rad), -cos(match.theta_rad)
    lever = nx * -(match.middle.y_m - y_m) + ny * (match.middle.x_m - x_m)
    return np.array([[0.0, 0.0, 1.0], [nx, ny, lever]])


def pose_error_seen(match_theta_rad: float, x_m: float, y_m: float, at: tuple[float, float], pose: Array) -> Array:
    """Return the covariance (2, 2) that the pose's (3, 3) gives a line with its middle at (x, y), the robot being at `at`."""
    nx, ny = sin(match_theta_rad), -cos(match_theta_rad)
    h = np.array([[0.0, 0.0, 1.0], [nx, ny, nx * -(y_m - at[1]) + ny * (x_m - at[0])]])
    seen: Array = h @ pose @ h.T
    return seen


def correct(
    matches: Sequence[LineMatch],
    x_m: float,
    y_m: float,
    prior: Array,
    *,
    outlier_sigmas: float,
    least_information: float,
    confidence: float,
) -> Correction:
    """Return the correction of the pose at (x, y) with the covariance `prior` (3, 3).

    A match that the others leave more than `outlier_sigmas` out is left out, the worst first. A direction counts as
    observed where the lines' information on it is at least `least_information` of the prior's. `confidence` sets the bound of
    the jump.
    """
    used = list(range(len(matches)))
    while True:
        state, covariance, kept = _solve([matches[i] for i in used], x_m, y_m, prior, least_information)
        left = [_left(matches[i], x_m, y_m, state) for i in used]
        if len(used) < 3 or max(left) <= outlier_sigmas**2:
            break
        used.pop(int(np.argmax(left)))
    return Correction(
        shift_x_m=float(state[0]),
        shift_y_m=float(state[1]),
        turn_rad=float(state[2]),
        covariance=covariance,
        kept=kept,
        used=tuple(used),
        distance=normal_distance(state, prior),
        bound=chi_square_quantile(confidence, 3),
    )


def _left(match: LineMatch, x_m: float, y_m: float, state: Array) -> float:
    """Return the squared normal distance, the larger of turn's and offset's, that the correction leaves of a difference."""
    rest = np.array([match.turn_rad, match.offset_m]) - measurement(match, x_m, y_m) @ state
    variances = np.array([match.covariance[0], match.covariance[2]])
    return float((rest**2 / variances).max())


def _solve(
    matches: Sequence[LineMatch], x_m: float, y_m: float, prior: Array, least_information: float
) -> tuple[Array, Array, Array]:
    if not matches:
        return np.zeros(3), prior, np.eye(3)
    h = np.vstack([measurement(match, x_m, y_m) for match in matches])
    r = np.zeros((len(h), len(h)))
    for i, match in enumerate(matches):
        tt, to, oo = match.covariance
        r[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[tt, to], [to, oo]]
    z = np.array([part for match in matches for part in (match.turn_rad, match.offset_m)])
    s = h @ prior @ h.T + r
    gain = np.linalg.solve(s, h @ prior).T
    gain[:2] = _observed(matches, prior, least_information) @ gain[:2]
    kept = np.eye(3) - gain @ h
    after = kept @ prior @ kept.T + gain @ r @ gain.T  # holds for any gain
    return gain @ z, (after + after.T) / 2, kept


def _observed(matches: Sequence[LineMatch], prior: Array, least_information: float) -> Array:
    """Return the projection (2, 2) onto those directions of the shift that the lines' offsets observe."""
    information = np.zeros((2, 2))
    for match in matches:
        normal = np.array([sin(match.theta_rad), -cos(match.theta_rad)])
        information += np.outer(normal, normal) / match.covariance[2]
    values, vectors = np.linalg.eigh(information)
    projection = np.zeros((2, 2))
    for value, vector in zip(values, vectors.T, strict=True):
        if value * float(vector @ prior[:2, :2] @ vector) >= least_information:
            projection += np.outer(vector, vector)
    return projection


def least_sigmas(matches: Sequence[LineMatch]) -> Array:
    """Return how sure lines can make a pose at best, (3,) x, y, heading: a line only across itself.

    In a corridor the walls' small uncertainty says nothing of the place along them.
    """
    across = np.abs([[sin(match.theta_rad), cos(match.theta_rad)] for match in matches])
    offsets = np.array([[match.model_sigma_rho_m] for match in matches]) / np.maximum(across, 1e-6)
    return np.array([*offsets.min(axis=0), min(match.model_sigma_theta_rad for match in matches)])


def stretch_to(after: Array, before: Array, sigmas: Array) -> Array:
    """Return by how much (3,) the deviations `after` a correction must grow where the pose had not been surer `before`.

    A line's error is the same each time that the line is met, and lines first seen from one pose share that pose's error: however
    often they are seen, they say where the robot is in the map no better than that. `sigmas` are of x, y, heading.
    """
    old, new = np.sqrt(np.diag(before)), np.sqrt(np.diag(after))
    return np.asarray(np.maximum(np.minimum(old, sigmas) / new, 1.0))
