"""Which echoes walls give, by hand and against differences."""

from math import cos, inf, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import Pose
from knowledge_sources.joint_estimate.association import associate, consistent
from knowledge_sources.joint_estimate.echo_model import Cones, LineTable, derivatives, predict
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import LATENCY, LINES, JointState, LineExtent, X, Y

PARAMS = JointLinesParams()
NOWHERE = Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)


def wall(
    state: JointState, id_: str, x_m: float, y_m: float, theta_rad: float, faces_left: bool, half_m: float = 2.0
) -> None:
    extent = LineExtent(id=id_, anchor_x_m=x_m, anchor_y_m=y_m, from_m=-half_m, to_m=half_m, faces_left=faces_left)
    state.add(extent, theta_rad, np.diag([1e-4, 1e-4]), state.seen(x_m, y_m, theta_rad))


def cones(*bearings_rad: float, half_rad: float = radians(10)) -> Cones:
    count = len(bearings_rad)
    return Cones(
        x_m=np.zeros(count), y_m=np.zeros(count), bearing_rad=np.array(bearings_rad), half_rad=np.full(count, half_rad)
    )


def facing_wall() -> JointState:
    """A robot at the origin, and a wall 2 m ahead that runs along y and is sensed from its left."""
    state = JointState(NOWHERE, PARAMS)
    wall(state, "1", 2.0, 0.0, pi / 2, faces_left=True)
    return state


def test_a_wall_is_heard_along_its_normal_or_along_the_edge_of_the_cone() -> None:
    state = facing_wall()
    found = predict(state, LineTable.of(state), cones(0.0, radians(8), radians(30), radians(-30), radians(50)), PARAMS)
    expected = [2.0, 2.0, 2.0 / cos(radians(20)), 2.0 / cos(radians(20)), inf]  # 40 degrees off throws sound away
    assert found.ranges_m[:, 0].tolist() == pytest.approx(expected)


def test_a_wall_is_heard_from_one_side_and_where_it_is() -> None:
    state = JointState(NOWHERE, PARAMS)
    wall(state, "1", 2.0, 0.0, pi / 2, faces_left=False)
    wall(state, "2", 2.0, 5.0, pi / 2, faces_left=True)
    found = predict(state, LineTable.of(state), cones(0.0), PARAMS)
    assert found.ranges_m.tolist() == [[inf, inf]]  # from behind, and beside it


@given(
    st.floats(-0.3, 0.3),
    st.floats(-0.3, 0.3),
    st.floats(-0.4, 0.4),
    st.floats(-0.3, 0.3),
    st.floats(-0.2, 0.2),
    st.booleans(),
)
def test_derivatives_are_those_of_the_prediction(
    x_m: float, y_m: float, heading_rad: float, tilt_rad: float, offset_m: float, left: bool
) -> None:
    state = JointState(Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad), PARAMS)
    wall(state, "1", 2.0, 0.0, pi / 2 + tilt_rad if left else -pi / 2 + tilt_rad, faces_left=left)
    state.mean[LINES + 1] = offset_m
    rays = Cones(
        x_m=np.array([0.2, 0.1]), y_m=np.array([0.1, -0.2]), bearing_rad=np.array([0.0, 0.35]), half_rad=np.full(2, 0.1)
    )
    table = LineTable.of(state)
    found = predict(state, table, rays, PARAMS)
    heard = np.flatnonzero(np.isfinite(found.ranges_m[:, 0]) & (np.abs(found.edge_rad[:, 0]) > 1e-3))
    h = derivatives(state, table, found, heard, np.zeros_like(heard), (0.4, -0.2, 0.1))
    assert h[:, LATENCY] == pytest.approx(-(h[:, :3] @ [0.4, -0.2, 0.1]))
    for at in (X, Y, 2, LINES, LINES + 1):
        step = np.zeros(len(state.mean))
        step[at] = 1e-6
        ranges = []
        for sign in (-1.0, 1.0):
            state.mean += sign * step
            ranges.append(predict(state, LineTable.of(state), rays, PARAMS).ranges_m[heard, 0])
            state.mean -= sign * step
        if np.isfinite(ranges).all():
            assert h[:, at] == pytest.approx((ranges[1] - ranges[0]) / 2e-6, abs=1e-4)


def test_an_echo_is_paired_with_the_wall_that_explains_it() -> None:
    state = facing_wall()
    wall(state, "2", 0.0, 3.0, pi, faces_left=True)
    rays = cones(0.0, pi / 2, pi)
    paired = associate(state, rays, np.array([2.03, 1.2, 2.0]), (0.0, 0.0, 0.0), PARAMS)
    assert (paired.cone.tolist(), paired.line.tolist()) == ([0], [0])  # a thing before wall 2, and no wall behind
    assert paired.difference_m.tolist() == pytest.approx([0.03])


def test_of_two_walls_that_explain_an_echo_equally_neither_is_taken() -> None:
    state = facing_wall()
    wall(state, "2", 2.12, 0.0, pi / 2, faces_left=True)
    assert len(associate(state, cones(0.0), np.array([2.06]), (0.0, 0.0, 0.0), PARAMS).cone) == 0
    assert associate(state, cones(0.0), np.array([2.0]), (0.0, 0.0, 0.0), PARAMS).line.tolist() == [0]


def test_a_short_line_moves_nothing_and_speaks_against_a_wall_behind_it() -> None:
    state = JointState(NOWHERE, PARAMS)
    wall(state, "1", 1.88, 0.0, pi / 2, faces_left=True, half_m=0.3)
    echo = np.array([1.92])
    assert len(associate(state, cones(0.0), echo, (0.0, 0.0, 0.0), PARAMS).cone) == 0
    wall(state, "2", 2.0, 0.0, pi / 2, faces_left=True)
    assert len(associate(state, cones(0.0), echo, (0.0, 0.0, 0.0), PARAMS).cone) == 0
    state.drop(0)
    assert associate(state, cones(0.0), echo, (0.0, 0.0, 0.0), PARAMS).line.tolist() == [0]


def test_an_echo_that_fits_badly_is_of_something_else() -> None:
    state = facing_wall()
    sigma_m = 0.043  # of an echo at 2 m, 0.03 + 0.005 * 2, and of the wall, 0.01
    for echo_m, count in ((2.0 - 1.8 * sigma_m, 1), (2.0 - 2.3 * sigma_m, 0)):
        assert len(associate(state, cones(0.0), np.array([echo_m]), (0.0, 0.0, 0.0), PARAMS).cone) == count


def test_an_echo_that_the_others_speak_against_is_left_out() -> None:
    state = facing_wall()
    wall(state, "2", 0.0, 3.0, pi, faces_left=True)
    rays = cones(0.0, 0.05, -0.05, pi / 2)
    paired = associate(state, rays, np.array([2.0, 2.01, 2.08, 3.0]), (0.0, 0.0, 0.0), PARAMS)
    assert len(paired.cone) == 4
    kept, distance, bound = consistent(state, paired, 0.5)
    assert kept.cone.tolist() == [0, 1, 3]
    assert distance <= bound


def test_what_no_pose_explains_is_not_explained_by_leaving_out_more_than_half() -> None:
    state = facing_wall()
    rays = cones(0.0, 0.05, -0.05, 0.1)
    paired = associate(state, rays, np.array([1.93, 2.07, 1.93, 2.07]), (0.0, 0.0, 0.0), PARAMS)
    assert len(paired.cone) == 4
    kept, distance, bound = consistent(state, paired, 0.5)
    assert len(kept.cone) == 2
    assert distance > 0.0
    assert bound > 0.0


def test_a_turned_wall_by_hand() -> None:
    state = JointState(NOWHERE, PARAMS)
    normal = radians(20)
    wall(state, "1", 2.0 * cos(normal), 2.0 * sin(normal), normal + pi / 2, faces_left=True)
    found = predict(state, LineTable.of(state), cones(0.0), PARAMS)
    assert found.ranges_m[0, 0] == pytest.approx(
        2.0 / cos(radians(10))
    )  # the cone's left edge, 10 degrees off the normal
