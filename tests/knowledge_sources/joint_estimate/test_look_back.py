"""What the recent past says of a line that has just been believed."""

from math import pi

import numpy as np
import pytest

from blackboard.messages.geometry import Pose
from knowledge_sources.joint_estimate.echo_model import Cones
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import HEADING, LINES, JointState, LineExtent
from knowledge_sources.joint_estimate.window import Look, Window

PARAMS = JointLinesParams()
WALL_Y_M = -1.5
RIGHT = Cones(x_m=np.zeros(1), y_m=np.zeros(1), bearing_rad=np.array([-pi / 2]), half_rad=np.array([0.1]))


def driven(true_turn_rad: float, heard: bool = True) -> tuple[JointState, Window]:
    """A robot drives 4 m along a wall on its right; its wheels say straight on, and it turned evenly in truth."""
    state, window = JointState(Pose(x_m=0.0, y_m=0.0, heading_rad=0.0), PARAMS), Window()
    for number in range(17):
        if number:
            state.drive(Pose(x_m=0.25, y_m=0.0, heading_rad=0.0))
        way = 0.25 * number
        y_m = true_turn_rad * way**2 / 8.0  # after 4 m the heading is the true turn
        ranges = np.array([y_m - WALL_Y_M if heard else 0.7])
        window.add(state, Look(cones=RIGHT, ranges_m=ranges, motion=(0.0, 0.0, 0.0), open=np.ones(1, dtype=np.bool_)))
    return state, window


def believe(state: JointState, theta_rad: float = 0.0) -> None:
    extent = LineExtent(id="1", anchor_x_m=2.0, anchor_y_m=WALL_Y_M, from_m=-2.5, to_m=2.5, faces_left=True)
    seen = state.seen(2.0, WALL_Y_M, theta_rad)
    state.add(extent, theta_rad, np.diag([0.03**2, 0.05**2]), seen)


def test_echoes_of_the_past_correct_the_way_since() -> None:
    state, window = driven(0.02)
    believe(state)
    before = state.covariance[HEADING, HEADING]
    assert window.look_back(state, PARAMS) == 17
    assert state.covariance[LINES, LINES] < 0.03**2  # surer of the wall than the fit was
    assert state.covariance[HEADING, HEADING] <= before
    away = state.mean[1] - (state.mean[LINES + 1] * -1.0 + WALL_Y_M) - np.sin(state.mean[LINES]) * (state.mean[0] - 2.0)
    assert away == pytest.approx(0.02 * 4.0 / 2.0 - WALL_Y_M, abs=0.02)  # as far from the wall as it heard


def test_an_echo_is_looked_back_at_once() -> None:
    state, window = driven(0.0)
    believe(state)
    assert window.look_back(state, PARAMS) == 17
    believe(state)
    assert window.look_back(state, PARAMS) == 0


def test_echoes_of_something_else_leave_the_fit_alone() -> None:
    state, window = driven(0.0, heard=False)
    believe(state)
    before = state.covariance.copy()
    assert window.look_back(state, PARAMS) == 0
    assert state.covariance.tolist() == before.tolist()
