"""Whether the robot can have gone as the estimate has it: wheels err, but by no more than they are said to.

A pull so small that each scan may make it is one that many of them cannot. Held against each other are the way since a past pose
as the state has it now, and as the wheels alone tell it, with all that they may be wrong by.
"""

import numpy as np

from blackboard.messages.geometry import IDENTITY, Pose, wrap_angle
from blackboard.uncertainty.matrices import Array
from blackboard.uncertainty.normal_distance import normal_distance
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import DISTANCE_SCALE, LATENCY, WINDOW, JointState

STRETCHES = 2  # that overlap by half: one has always seen the latest half of a stretch


class WheelCheck:
    """The way since two of the remembered poses, by the wheels alone."""

    def __init__(self, params: JointLinesParams) -> None:
        self._params = params
        self._stretches: list[tuple[int, JointState]] = []  # where the past pose stands in the mean, and the way since
        self._remembered = 0

    def begin(self, state: JointState, at: int) -> None:
        """The robot is at the pose that was just remembered at `at`: begin a stretch there if one is due."""
        if self._remembered % (WINDOW // 2 // STRETCHES) == 0:
            way = JointState(IDENTITY, self._params)
            errors = slice(DISTANCE_SCALE, LATENCY)
            way.mean[errors] = state.mean[errors]
            way.covariance[errors, errors] = state.covariance[errors, errors]
            self._stretches = [*self._stretches[-(STRETCHES - 1) :], (at, way)]
        self._remembered += 1

    def drive(self, step: Pose) -> None:
        """Go on by what the wheels tell of a step."""
        for _, way in self._stretches:
            way.drive(step)

    def worst(self, state: JointState) -> tuple[float, Array]:
        """Return the largest squared normal distance of the stretches, and by how much the pose is off then, (3,) map frame."""
        distance, off = 0.0, np.zeros(3)
        for at, way in self._stretches:
            x, y, heading = state.mean[at : at + 3].tolist()
            then = Pose(x_m=x, y_m=y, heading_rad=wrap_angle(heading))
            gone, told = then.inverse() @ state.pose, way.pose
            turn = wrap_angle(gone.heading_rad - told.heading_rad)
            difference = np.array([gone.x_m - told.x_m, gone.y_m - told.y_m, turn])
            found = normal_distance(difference, way.pose_covariance)
            if found > distance:
                c, s = np.cos(heading), np.sin(heading)
                distance = found
                off = np.array([c * difference[0] - s * difference[1], s * difference[0] + c * difference[1], turn])
        return distance, off

    def begin_anew(self) -> None:
        """Forget the stretches."""
        self._stretches, self._remembered = [], 0
