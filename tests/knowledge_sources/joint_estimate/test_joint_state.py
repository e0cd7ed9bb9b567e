"""Mean and covariance of pose and lines, by hand."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import Pose
from knowledge_sources.joint_estimate.line_association import badly_seen, estimate_of, pair_lines, same_lines
from knowledge_sources.joint_estimate.line_uniting import unite
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import (
    DISTANCE_SCALE,
    DRIFT,
    HEADING,
    LATENCY,
    LINES,
    TURN_SCALE,
    JointState,
    LineExtent,
    X,
    Y,
)
from knowledge_sources.line_estimates import from_ends

PARAMS = JointLinesParams()
START = Pose(x_m=1.0, y_m=2.0, heading_rad=0.5)
OWN = np.diag([0.01**2, 0.02**2])


def add(state: JointState, id_: str, x_m: float, y_m: float, theta_rad: float, half_m: float = 1.0) -> None:
    extent = LineExtent(id=id_, anchor_x_m=x_m, anchor_y_m=y_m, from_m=-half_m, to_m=half_m, faces_left=True)
    state.add(extent, theta_rad, OWN, state.seen(x_m, y_m, theta_rad))


def test_driving_straight_adds_what_wheels_are_wrong_by() -> None:
    state = JointState(Pose(x_m=0.0, y_m=0.0, heading_rad=0.0), PARAMS)
    state.drive(Pose(x_m=2.0, y_m=0.0, heading_rad=0.0))
    assert state.pose == Pose(x_m=2.0, y_m=0.0, heading_rad=0.0)
    p = state.pose_covariance
    assert p[X, X] == pytest.approx(1e-6 + (2 * 0.03) ** 2 + 0.01**2 * 2)  # scale, and noise with the root of the way
    assert p[HEADING, HEADING] == pytest.approx(1e-6 + (2 * 0.005) ** 2 + 0.005**2 * 2)  # drift, and noise
    assert p[Y, Y] == pytest.approx(
        1e-6 + 4e-6 + (2 * 0.005) ** 2 + 0.005**2 * 2
    )  # heading before, half of heading since


@given(
    st.floats(-1, 1),
    st.floats(-1, 1),
    st.floats(-1, 1),
    st.floats(-0.1, 0.1),
    st.floats(-0.1, 0.1),
    st.floats(-0.1, 0.1),
)
def test_driving_carries_errors_as_it_carries_the_pose(
    dx: float, dy: float, turn: float, scale: float, turn_scale: float, drift: float
) -> None:
    step = Pose(x_m=dx, y_m=dy, heading_rad=turn)

    def driven(change: np.ndarray) -> np.ndarray:
        state = JointState(START, PARAMS)
        state.mean[DISTANCE_SCALE], state.mean[TURN_SCALE], state.mean[DRIFT] = scale, turn_scale, drift
        state.mean[:6] += change
        state.drive(step)
        return state.mean[:3].copy()

    quiet = JointLinesParams(distance_noise_m=0.0, heading_noise_rad=0.0, turn_noise_rad=0.0)
    state = JointState(START, quiet)
    state.mean[DISTANCE_SCALE], state.mean[TURN_SCALE], state.mean[DRIFT] = scale, turn_scale, drift
    before = state.covariance[:6, :6].copy()
    state.drive(step)
    f = np.column_stack([(driven(1e-6 * e) - driven(-1e-6 * e)) / 2e-6 for e in np.eye(6)])
    assert state.pose_covariance == pytest.approx((f @ before @ f.T), rel=1e-4, abs=1e-12)


def test_sonars_are_taken_to_be_a_little_late_until_echoes_say_better() -> None:
    state = JointState(START, PARAMS)
    assert state.mean[LATENCY] == pytest.approx(0.05)
    assert state.covariance[LATENCY, LATENCY] == pytest.approx(0.05**2)


def test_an_update_is_the_kalman_equation() -> None:
    state = JointState(START, PARAMS)
    state.covariance[X, X] = 0.04
    h = np.zeros((1, LINES))
    h[0, X] = 1.0
    change = state.update(np.array([0.3]), h, np.array([[0.08]]))
    assert change[X] == pytest.approx(0.3 * 0.04 / 0.12)
    assert state.covariance[X, X] == pytest.approx(0.04 * 0.08 / 0.12)
    assert state.mean[Y] == pytest.approx(2.0)


def test_a_line_shares_the_error_of_the_pose_it_was_seen_from() -> None:
    state = JointState(START, PARAMS)
    state.covariance[Y, Y] = 0.09
    state.begin_batch()  # seen between now and now
    add(state, "1", 1.0, 0.0, 0.0)
    theta, offset, covariance = state.line(0)
    assert (theta, offset) == (0.0, 0.0)
    assert covariance[1, 1] == pytest.approx(0.09 + OWN[1, 1], abs=1e-5)
    assert state.covariance[Y, LINES + 1] == pytest.approx(-0.09, rel=1e-3)  # the normal points down
    h = np.zeros((1, len(state.mean)))
    h[0, Y], h[0, LINES + 1] = 1.0, 1.0  # how far above the line the robot is
    assert float((h @ state.covariance @ h.T)[0, 0]) == pytest.approx(OWN[1, 1], rel=0.01)


def test_the_past_stays_as_the_present_moves() -> None:
    state = JointState(START, PARAMS)
    at = state.remember()
    state.drive(Pose(x_m=1.0, y_m=0.0, heading_rad=0.0))
    assert state.mean[at : at + 3].tolist() == [1.0, 2.0, 0.5]
    assert state.covariance[at, at] == pytest.approx(1e-6)
    h = np.zeros((1, LINES))
    h[0, X], h[0, at] = 1.0, -1.0
    state.update(np.array([0.02]), h, np.array([[1e-9]]))  # the step was longer: the present moves, the start hardly
    assert state.mean[X] == pytest.approx(1.0 + cos(0.5) + 0.02, abs=1e-4)
    assert state.mean[at] == pytest.approx(1.0, abs=1e-3)


def test_dropping_a_line_leaves_the_others() -> None:
    state = JointState(START, PARAMS)
    for number in range(3):
        add(state, str(number), float(number), 0.0, 0.1 * number)
    kept = state.line(2)[2].copy()
    state.drop(state.number("1"))
    assert [extent.id for extent in state.lines] == ["0", "2"]
    assert state.line(1)[0] == pytest.approx(0.2)
    assert state.line(1)[2] == pytest.approx(kept)
    with pytest.raises(ValueError, match="not in list"):
        state.number("1")


@given(st.floats(-0.2, 0.2), st.floats(-0.3, 0.3), st.floats(-1.0, 1.0), st.booleans())
def test_an_observed_line_is_held_against_a_known_one(turn: float, out_m: float, along_m: float, reverse: bool) -> None:
    state = JointState(START, PARAMS)
    add(state, "1", 3.0, 1.0, 0.3)
    x, y = 3.0 + along_m * cos(0.3) + out_m * sin(0.3), 1.0 + along_m * sin(0.3) - out_m * cos(0.3)
    ends = [(x - cos(0.3 + turn), y - sin(0.3 + turn)), (x + cos(0.3 + turn), y + sin(0.3 + turn))]
    if reverse:
        ends.reverse()
    seen = from_ends(ends[0], ends[1], OWN, faces_left=not reverse)
    (pair,) = pair_lines(state, seen, 1.0)
    assert pair.difference == pytest.approx([turn, out_m], abs=1e-9)
    assert (pair.from_m, pair.to_m) == pytest.approx((along_m - 1.0, along_m + 1.0))
    for at in (X, Y, HEADING, LINES, LINES + 1):
        moved = []
        for sign in (-1.0, 1.0):
            if at < LINES:  # what was seen moves with the robot
                d = sign * 1e-6
                line = seen.turned(1.0, 2.0, d * (at == X), d * (at == Y), d * (at == HEADING))
                moved.append(pair_lines(state, line, 1.0)[0].difference)
            else:
                state.mean[at] += sign * 1e-6
                moved.append(pair_lines(state, seen, 1.0)[0].difference)
                state.mean[at] -= sign * 1e-6
        both = pair.h[:, at] + (pair.h[:, at + 7] if at < LINES else 0.0)  # the batch began where the robot is
        assert both == pytest.approx((moved[1] - moved[0]) / 2e-6, abs=1e-5)


def test_walls_seen_from_both_sides_stay_two() -> None:
    state = JointState(START, PARAMS)
    add(state, "1", 3.0, 1.0, 0.0)
    behind = from_ends((2.0, 1.05), (4.0, 1.05), OWN, faces_left=False)
    assert pair_lines(state, behind, 1.0) == []
    assert badly_seen(state, behind, PARAMS) is None


def test_a_line_beside_a_known_one_is_the_same_badly_seen() -> None:
    state = JointState(START, PARAMS)
    add(state, "7", 3.0, 1.0, 0.0)
    assert badly_seen(state, from_ends((2.2, 1.2), (3.4, 1.1), OWN, faces_left=True), PARAMS) == "7"
    assert badly_seen(state, from_ends((2.2, 1.4), (3.4, 1.4), OWN, faces_left=True), PARAMS) is None  # a cupboard
    assert (
        badly_seen(state, from_ends((3.8, 1.1), (6.0, 1.1), OWN, faces_left=True), PARAMS) is None
    )  # mostly beyond it


def test_two_halves_of_a_wall_become_one() -> None:
    state = JointState(START, PARAMS)
    add(state, "1", 2.0, 0.0, 0.0)
    add(state, "2", 3.5, 0.01, pi)  # the same wall, run the other way
    state.lines[1] = LineExtent(id="2", anchor_x_m=3.5, anchor_y_m=0.01, from_m=-1.0, to_m=1.0, faces_left=False)
    add(state, "3", 2.0, 0.6, 0.0)  # another
    touched = ["2"]
    assert unite(state, touched, PARAMS) == ["2"]
    assert [extent.id for extent in state.lines] == ["1", "3"]
    line = estimate_of(state, 0)
    assert line.half_length_m == pytest.approx(1.75, abs=0.01)
    assert 0.0 < line.y_m < 0.01
    assert "1" in touched
    assert state.lines[0].observations == 2


def test_equally_sure_lines_differ_by_what_they_do_not_share() -> None:
    state = JointState(START, PARAMS)
    state.covariance[Y, Y] = 1.0  # both were seen from one place: its error is not between them
    state.begin_batch()
    add(state, "1", 2.0, 0.0, 0.0)
    add(state, "2", 2.0, 0.1, 0.0)
    pair = same_lines(state, 0, 1, np.diag([1e-6, 1e-6]))
    assert pair is not None
    assert sqrt(pair.distance) == pytest.approx(0.1 / sqrt(2 * OWN[1, 1]), rel=0.02)
