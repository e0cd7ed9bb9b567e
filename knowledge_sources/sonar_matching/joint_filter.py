"""Where the robot and the patches of the map are, and what odometry is wrong by: one extended Kalman filter over all of it.

State: x_m, y_m, heading_rad of the robot at the newest scan; distance error (fraction of the way), turn error (fraction of the
turn), drift (rad per metre), latency of the sonars (s); then x_m, y_m, heading_rad of each patch, map frame. A match tells where
the robot stands in a patch, never where in the map: so nobody becomes surer by it than the patch is (Smith, Self and
Cheeseman 1990; patches as landmarks: Bosse et al. 2003). What odometry is wrong by follows from how it correlates with the pose.
"""

from dataclasses import dataclass
from math import cos, hypot, sin

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import Pose, wrap_angle
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.window import Told, corrected_step

Floats = npt.NDArray[np.float64]

START_SIGMA = 1e-3  # m and rad: the map begins where the robot does
ERRORS = slice(3, 7)
PATCHES = 7  # where they begin
DIFFERENCES = np.array([1e-4, 1e-4, 1e-4, 1e-3])  # for derivatives by the errors


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """`mean` is (7 + 3 patches,), `covariance` square of it, in the order of the state above."""

    mean: Floats
    covariance: Floats

    @property
    def map_from_robot(self) -> Pose:
        """The pose at the newest scan."""
        return _pose(self.mean[:3])

    @property
    def errors(self) -> Floats:
        """What odometry and stamps are wrong by, (4,): distance, turn, drift, latency."""
        return self.mean[ERRORS]

    @property
    def patches(self) -> int:
        """How many patches there are."""
        return (len(self.mean) - PATCHES) // 3

    def map_from_patch(self, patch: int) -> Pose:
        """The pose of a patch."""
        return _pose(self.mean[PATCHES + 3 * patch :][:3])


def start(map_from_robot: Pose, params: SonarMatcherParams) -> Estimate:
    """Return what is known before the robot has moved."""
    mean = np.array([map_from_robot.x_m, map_from_robot.y_m, map_from_robot.heading_rad, 0.0, 0.0, 0.0, 0.0])
    sigmas = [START_SIGMA] * 3 + [
        params.distance_scale,
        params.turn_scale,
        params.drift_rad_per_m,
        params.latency_sigma_s,
    ]
    return Estimate(mean, np.diag(np.square(sigmas)))


def predict(estimate: Estimate, before: Told, after: Told, params: SonarMatcherParams) -> Estimate:
    """Return the estimate after what odometry told between two scans."""
    mean, covariance = estimate.mean.copy(), estimate.covariance.copy()
    step = corrected_step(before, after, estimate.errors)
    c, s = cos(mean[2]), sin(mean[2])
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    moved = turn @ (step.x_m, step.y_m, step.heading_rad)
    change = np.zeros((3, PATCHES))  # the derivative of the new pose by the old one and by the errors
    change[:, :3] = np.eye(3)
    change[:2, 2] = -moved[1], moved[0]
    for error, difference in enumerate(DIFFERENCES):
        more, less = estimate.errors.copy(), estimate.errors.copy()
        more[error] += difference
        less[error] -= difference
        far, near = corrected_step(before, after, more), corrected_step(before, after, less)
        by = [far.x_m - near.x_m, far.y_m - near.y_m, wrap_angle(far.heading_rad - near.heading_rad)]
        change[:, 3 + error] = turn @ np.array(by) / (2.0 * difference)
    way_m = hypot(step.x_m, step.y_m)
    along = moved[:2] / way_m if way_m > 0 else np.zeros(2)
    across = np.array([-along[1], along[0]])
    noise = np.zeros((3, 3))
    noise[:2, :2] = way_m * (
        params.distance_noise_m**2 * np.outer(along, along) + params.sideways_noise_m**2 * np.outer(across, across)
    )
    noise[2, 2] = params.heading_noise_rad**2 * way_m + params.turn_noise_rad**2 * abs(step.heading_rad)
    mean[:3] += moved
    rows = change @ covariance[:PATCHES]
    corner = rows[:, :PATCHES] @ change.T + noise
    covariance[:3] = rows
    covariance[:, :3] = rows.T
    covariance[:3, :3] = corner
    return Estimate(mean, covariance)


def with_patch(estimate: Estimate) -> Estimate:
    """Return the estimate with another patch, which lies where the robot stands."""
    mean = np.concatenate([estimate.mean, estimate.mean[:3]])
    size = len(estimate.mean)
    covariance = np.empty((size + 3, size + 3))
    covariance[:size, :size] = estimate.covariance
    covariance[size:, :size] = estimate.covariance[:3]
    covariance[:size, size:] = estimate.covariance[:, :3]
    covariance[size:, size:] = estimate.covariance[:3, :3]
    covariance[range(size, size + 3), range(size, size + 3)] += START_SIGMA**2
    return Estimate(mean, covariance)


def in_patch(estimate: Estimate, patch: int) -> tuple[Pose, Floats, Floats]:
    """Return patch_from_robot, its covariance (3, 3), and that of the whole state with it, (state, 3)."""
    at = PATCHES + 3 * patch
    robot, origin = estimate.mean[:3], estimate.mean[at : at + 3]
    c, s = cos(origin[2]), sin(origin[2])
    back = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    seen = back @ (robot - origin)
    by_patch = -back
    by_patch[:2, 2] = seen[1], -seen[0]
    covariance = estimate.covariance
    cross = covariance[:, :3] @ back.T + covariance[:, at : at + 3] @ by_patch.T  # (state, 3)
    own = back @ cross[:3] + by_patch @ cross[at : at + 3]
    return _pose(seen), (own + own.T) / 2.0, cross


def update(estimate: Estimate, patch: int, shift: Floats, information: Floats) -> Estimate:
    """Return the estimate after the robot has been found to stand `shift` (3,) away in the frame of a patch.

    `shift` is the most probable one, the prior included; `information` (3, 3), positive semidefinite, is what the observation
    added. The rest of the state follows by its correlation with that.
    """
    _, prior, cross = in_patch(estimate, patch)
    sure = np.linalg.inv(prior)
    gain = cross @ sure  # (state, 3)
    posterior = np.linalg.inv(sure + information)
    after = estimate.covariance - gain @ (prior - posterior) @ gain.T
    return Estimate(estimate.mean + gain @ shift, (after + after.T) / 2.0)


def _pose(numbers: Floats) -> Pose:
    return Pose(x_m=float(numbers[0]), y_m=float(numbers[1]), heading_rad=wrap_angle(float(numbers[2])))
