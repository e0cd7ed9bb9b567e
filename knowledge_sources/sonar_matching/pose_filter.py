"""Where the robot is, and what its odometry is wrong by: an extended Kalman filter over both.

State: x_m, y_m, heading_rad (map frame), distance error (fraction of the way), turn error (fraction of the turn), drift (rad per
metre). Only the pose is ever observed; what odometry is wrong by follows from how it correlates with the pose (Thrun,
Burgard and Fox 2005, sections 3.3 and 5.4).
"""

from dataclasses import dataclass
from math import cos, hypot, sin

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import Pose, wrap_angle
from knowledge_sources.sonar_matching.params import SonarMatcherParams

Floats = npt.NDArray[np.float64]

START_SIGMA = 1e-3  # m and rad: the map begins where the robot does


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """`mean` is (6,), `covariance` (6, 6), in the order of the state above."""

    mean: Floats
    covariance: Floats

    @property
    def map_from_robot(self) -> Pose:
        """The pose."""
        return Pose(x_m=float(self.mean[0]), y_m=float(self.mean[1]), heading_rad=wrap_angle(float(self.mean[2])))

    @property
    def errors(self) -> Floats:
        """What odometry is wrong by, (3,): distance, turn, drift."""
        return self.mean[3:]


def start(map_from_robot: Pose, params: SonarMatcherParams) -> Estimate:
    """Return what is known before the robot has moved."""
    mean = np.array([map_from_robot.x_m, map_from_robot.y_m, map_from_robot.heading_rad, 0.0, 0.0, 0.0])
    sigmas = [START_SIGMA] * 3 + [params.distance_scale, params.turn_scale, params.drift_rad_per_m]
    return Estimate(mean, np.diag(np.square(sigmas)))


def corrected(step: Pose, errors: Floats) -> Pose:
    """Return an odometry step (the new pose seen from the old one) without what odometry is wrong by."""
    way_m = hypot(step.x_m, step.y_m)
    turn_rad = step.heading_rad * (1.0 + float(errors[1])) + float(errors[2]) * way_m
    half_rad = (turn_rad - step.heading_rad) / 2.0  # the chord of an arc turns by half of what the heading turns
    c, s, scale = cos(half_rad), sin(half_rad), 1.0 + float(errors[0])
    return Pose(
        x_m=scale * (c * step.x_m - s * step.y_m),
        y_m=scale * (s * step.x_m + c * step.y_m),
        heading_rad=wrap_angle(turn_rad),
    )


def predict(estimate: Estimate, step: Pose, params: SonarMatcherParams) -> Estimate:
    """Return the estimate after an odometry step."""
    mean = estimate.mean
    right = corrected(step, estimate.errors)
    c, s = cos(mean[2]), sin(mean[2])
    x_m, y_m = c * right.x_m - s * right.y_m, s * right.x_m + c * right.y_m
    way_m, scale = hypot(step.x_m, step.y_m), 1.0 + mean[3]
    change = np.eye(6)  # the derivative of the new state by the old one
    change[:2, 2] = -y_m, x_m
    change[:2, 3] = x_m / scale, y_m / scale
    change[:2, 4] = -y_m * step.heading_rad / 2.0, x_m * step.heading_rad / 2.0
    change[:2, 5] = -y_m * way_m / 2.0, x_m * way_m / 2.0
    change[2, 4:] = step.heading_rad, way_m
    noise = np.zeros((6, 6))
    along = np.array([x_m, y_m]) / way_m if way_m > 0 else np.zeros(2)
    across = np.array([-along[1], along[0]])
    noise[:2, :2] = way_m * (
        params.distance_noise_m**2 * np.outer(along, along) + params.sideways_noise_m**2 * np.outer(across, across)
    )
    noise[2, 2] = params.heading_noise_rad**2 * way_m + params.turn_noise_rad**2 * abs(step.heading_rad)
    moved = mean + np.array([x_m, y_m, right.heading_rad, 0.0, 0.0, 0.0])
    return Estimate(moved, change @ estimate.covariance @ change.T + noise)


def update(estimate: Estimate, shift: Floats, information: Floats) -> Estimate:
    """Return the estimate after its pose has been found to lie `shift` (3,) away.

    `shift` is the most probable one, the prior included; `information` (3, 3), positive semidefinite, is what the observation
    added. The rest of the state follows by its correlation with the pose.
    """
    covariance = estimate.covariance
    prior = covariance[:3, :3]
    gain = covariance[:, :3] @ np.linalg.inv(prior)  # (6, 3)
    posterior = np.linalg.inv(np.linalg.inv(prior) + information)
    after = covariance - gain @ (prior - posterior) @ gain.T
    return Estimate(estimate.mean + gain @ shift, (after + after.T) / 2.0)
