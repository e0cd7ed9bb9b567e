"""What the wheels tell of the way: the true motion with systematic and random errors."""

from dataclasses import replace
from math import cos, sin, sqrt

import numpy as np

from blackboard.messages.geometry import Pose, wrap_angle
from sim.kept_state import as_record
from sim.sensor_models import OdometryModel


def told_step(
    before: Pose, after: Pose, distance_m: float, turn_rad: float, model: OdometryModel, rng: np.random.Generator
) -> Pose:
    """Return the wheels' account of one step, as a pose in the frame of the one before.

    `distance_m` is the length of the way (not negative) and `turn_rad` the sum of turns without their sign; noise grows with
    the root of both, so that it does not depend on how often one looks.
    """
    step = before.inverse() @ after
    noise_distance, noise_heading, noise_turn = rng.standard_normal(3).tolist()
    root = sqrt(distance_m)
    turn = step.heading_rad * model.turn_scale
    turn += (
        model.drift_rad_per_m * distance_m
        + model.heading_noise_rad * root * noise_heading
        + model.turn_noise_rad * sqrt(turn_rad) * noise_turn
    )
    slip_m = model.distance_noise_m * root * noise_distance
    half_excess = (turn - step.heading_rad) / 2.0  # the chord of an arc turns by half of what the heading turns
    c, s, scale = cos(half_excess), sin(half_excess), model.distance_scale
    return Pose(
        x_m=scale * (c * step.x_m - s * step.y_m) + slip_m * cos(turn / 2.0),
        y_m=scale * (s * step.x_m + c * step.y_m) + slip_m * sin(turn / 2.0),
        heading_rad=wrap_angle(turn),
    )


def drawn(model: OdometryModel, rng: np.random.Generator) -> OdometryModel:
    """Return another pair of wheels of the same make: the systematic errors drawn, those given being one sigma each.

    What would be beyond three sigmas is three.
    """
    distance, turn, drift = np.clip(rng.standard_normal(3), -3.0, 3.0).tolist()
    return replace(
        model,
        distance_scale=1.0 + distance * (model.distance_scale - 1.0),
        turn_scale=1.0 + turn * (model.turn_scale - 1.0),
        drift_rad_per_m=drift * model.drift_rad_per_m,
    )


class Odometer:
    """Adds up what the wheels tell. `model` None: the truth."""

    def __init__(self, start: Pose, model: OdometryModel | None, rng: np.random.Generator) -> None:
        self._model = model
        self._rng = rng
        self._true = start
        self.pose = start

    def state(self) -> object:
        """Return what it has added up, and its random numbers, to be pickled at once."""
        return {name: value for name, value in vars(self).items() if name != "_model"}

    def resume(self, state: object) -> None:
        """Go on from a state."""
        vars(self).update(as_record(state))

    def put(self, true: Pose, told: Pose) -> None:
        """Begin anew where the robot really is, with what the wheels have told so far."""
        self._true, self.pose = true, told

    def read(self, true: Pose, distance_m: float, turn_rad: float) -> Pose:
        """Return the odometry pose now that the robot has come to `true` over a way and a turn since the last call."""
        if self._model is None:
            self.pose = true
        else:
            self.pose = self.pose @ told_step(self._true, true, distance_m, turn_rad, self._model, self._rng)
        self._true = true
        return self.pose
