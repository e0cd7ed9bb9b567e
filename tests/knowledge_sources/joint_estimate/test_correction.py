"""What echoes may not do: drag a line, or take the pose where the wheels cannot have gone."""

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import Pose
from knowledge_sources.joint_estimate.association import Paired, associate
from knowledge_sources.joint_estimate.correction import Corrector, Verdict
from knowledge_sources.joint_estimate.echo_model import Cones
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import HEADING, LINES, JointState, LineExtent, X, Y
from knowledge_sources.joint_estimate.wheel_check import WheelCheck

PARAMS = JointLinesParams()
STILL = (0.0, 0.0, 0.0)
AHEAD = Cones(x_m=np.zeros(1), y_m=np.zeros(1), bearing_rad=np.zeros(1), half_rad=np.full(1, 0.1))
STEP = Pose(x_m=0.2, y_m=0.0, heading_rad=0.0)


def facing_wall() -> JointState:
    """A robot at the origin, and a wall 2 m ahead."""
    state = JointState(Pose(x_m=0.0, y_m=0.0, heading_rad=0.0), PARAMS)
    extent = LineExtent(id="1", anchor_x_m=2.0, anchor_y_m=0.0, from_m=-2.0, to_m=2.0, faces_left=True)
    state.add(extent, pi / 2, np.diag([1e-4, 1e-4]), state.seen(2.0, 0.0, pi / 2))
    return state


def heard(state: JointState, corrector: Corrector, echo_m: float) -> Verdict:
    return corrector.correct(state, associate(state, AHEAD, np.array([echo_m]), STILL, PARAMS))


def test_echoes_to_both_sides_of_a_line_move_the_state_and_raise_no_doubt() -> None:
    state, corrector = facing_wall(), Corrector(PARAMS)
    for scan in range(200):
        assert heard(state, corrector, 2.0 + (0.06 if scan % 2 else -0.06)).refused == ""
    assert state.line(0)[1] == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_echoes_to_one_side_of_a_line_raise_a_doubt(side: float) -> None:
    state, corrector = facing_wall(), Corrector(PARAMS)
    scans, verdict = 0, None
    while scans < 20 and (verdict is None or not verdict.refused):
        scans += 1
        state.mean[LINES + 1] = state.mean[X] = 0.0  # something puts back what each scan moves: other lines
        before, sure = state.mean.copy(), state.covariance[LINES + 1, LINES + 1]
        verdict = heard(state, corrector, 2.0 + side * 0.06)
    assert verdict is not None
    assert 4 <= scans <= 8  # 1.4 deviations less the slack of 0.5 are 6 after seven
    assert verdict.refused == f"echoes have been to one side of lines for too long: of 1 by {side * 0.06:+.2f} m"
    assert state.mean.tolist() == before.tolist()
    assert state.covariance[LINES + 1, LINES + 1] > sure + 0.03**2  # the line has to account for most of it
    assert heard(state, corrector, 2.0 + side * 0.06).refused == ""  # and the count begins anew


def test_what_a_difference_makes_less_sure_is_what_would_explain_it() -> None:
    state = facing_wall()
    state.covariance[X, X], state.covariance[LINES + 1, LINES + 1] = 0.01, 0.03
    h = np.zeros(len(state.mean))
    h[X], h[LINES + 1] = -1.0, 1.0
    state.widen(h, 0.4)  # a quarter of it is the pose's: 0.1 m, and 0.3 m the line's
    assert state.covariance[X, X] == pytest.approx(0.01 + 0.1**2, rel=1e-3)
    assert state.covariance[LINES + 1, LINES + 1] == pytest.approx(0.03 + 0.3**2, rel=1e-3)
    assert float(h @ state.covariance @ h) == pytest.approx(0.04 + 0.4**2, rel=1e-3)


def driven(state: JointState, wheels: WheelCheck, steps: int, pull_rad: float = 0.0) -> None:
    for _ in range(steps):
        wheels.begin(state, state.remember())
        state.drive(STEP)
        wheels.drive(STEP)
        state.mean[HEADING] += pull_rad


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-pi, pi), st.integers(1, 60))
def test_what_the_wheels_tell_the_wheels_allow(x_m: float, y_m: float, heading_rad: float, steps: int) -> None:
    state, wheels = JointState(Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad), PARAMS), WheelCheck(PARAMS)
    driven(state, wheels, steps)
    distance, off = wheels.worst(state)
    assert distance == pytest.approx(0.0, abs=1e-9)
    assert off == pytest.approx(np.zeros(3), abs=1e-9)


def test_many_small_pulls_are_one_that_the_wheels_do_not_allow() -> None:
    state, wheels = JointState(Pose(x_m=0.0, y_m=0.0, heading_rad=pi / 2), PARAMS), WheelCheck(PARAMS)
    driven(state, wheels, 3, radians(0.3))
    assert wheels.worst(state)[0] < 16.0
    driven(state, wheels, 17, radians(0.3))
    distance, off = wheels.worst(state)
    assert distance > 20.0
    assert off[HEADING] == pytest.approx(radians(6.0))
    assert off[X] < -0.1  # to the left of a way along y


def test_a_scan_that_leaves_the_way_of_the_wheels_is_refused_and_the_pose_is_less_sure() -> None:
    state, corrector = facing_wall(), Corrector(PARAMS)
    driven(state, corrector.wheels, 10)
    h = np.zeros((1, len(state.mean)))
    h[0, Y] = 1.0
    state.covariance[Y, Y] += 1.0  # it believes that it could be anywhere, and the wheels know better
    echo = Paired(
        cone=np.zeros(1, dtype=np.intp),
        line=np.zeros(1, dtype=np.intp),
        difference_m=np.array([0.9]),
        h=h,
        noise=np.full(1, 1e-4),
    )
    before, sure = state.mean.copy(), state.covariance[Y, Y]
    verdict = corrector.correct(state, echo)
    assert verdict.refused.startswith("the wheels cannot have gone that way: normal distance ")
    assert verdict.distance > verdict.bound
    assert state.mean.tolist() == before.tolist()
    assert state.covariance[Y, Y] == pytest.approx(sure + 0.9**2, rel=0.01)
    assert (
        corrector.correct(state, replace(echo, difference_m=np.array([0.5]))).refused == ""
    )  # nothing speaks for the way before
