"""Poses of a window's scans, steps without their errors, and the sensors of the echoes."""

from math import pi, radians

import numpy as np
import pytest

from blackboard.errors import BoardError
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import RobotDescription, SonarScan, SonarSensor
from knowledge_sources.sonar_matching.window import Kept, Told, corrected_step, heard, poses_back, when_heard

LEFT = SonarSensor(mount=Pose(x_m=0.1, y_m=0.2, heading_rad=pi / 2), cone_rad=0.4, max_range_m=5.0)
FRONT = SonarSensor(mount=Pose(x_m=0.3, y_m=0.0, heading_rad=0.0), cone_rad=0.2, max_range_m=5.0)
ROBOT = RobotDescription(
    name="two", radius_m=0.3, max_speed_mps=0.5, max_turn_radps=1.0, max_acceleration_mps2=0.5, sonars=(LEFT, FRONT)
)
SCAN = SonarScan(sensors=(0, 1), ranges_m=(2.0, 1.5))
AHEAD = Pose(x_m=0.5, y_m=0.0, heading_rad=0.0)
TURN = Pose(x_m=0.0, y_m=0.0, heading_rad=pi / 2)


def told(pose: Pose, speed: Pose = IDENTITY) -> Told:
    return Told(pose, speed)


def kept(*steps: Pose) -> list[Kept]:
    window = [Kept(SCAN, told(IDENTITY), told(IDENTITY))]
    for step in steps:
        before = window[-1].told
        window.append(Kept(SCAN, told(before.odom_from_robot @ step), before))
    return window


def step_without(step: Pose, *errors: float) -> Pose:
    return corrected_step(told(IDENTITY), told(step), np.array(errors))


def test_a_step_is_scaled_turned_and_bent_by_the_drift() -> None:
    straight = step_without(Pose(x_m=1.0, y_m=0.0, heading_rad=0.0), -0.04, 0.5, 0.02, 0.0)
    assert straight.heading_rad == pytest.approx(0.02)
    assert straight.distance_m(IDENTITY) == pytest.approx(0.96)
    assert straight.y_m / straight.x_m == pytest.approx(np.tan(0.01))
    on_the_spot = step_without(Pose(x_m=0.0, y_m=0.0, heading_rad=radians(90)), 0.1, -0.1, 0.02, 0.0)
    assert on_the_spot.heading_rad == pytest.approx(radians(81))
    assert on_the_spot.distance_m(IDENTITY) == 0.0


def test_late_stamps_put_a_scan_back_on_the_way() -> None:
    moving = told(AHEAD, Pose(x_m=0.4, y_m=0.0, heading_rad=0.5))
    taken = when_heard(moving, 0.1)
    assert (taken.x_m, taken.heading_rad) == pytest.approx((0.46, -0.05))
    at_one_speed = corrected_step(told(IDENTITY, AHEAD), told(AHEAD, AHEAD), np.array([0.0, 0.0, 0.0, 0.1]))
    assert at_one_speed.x_m == pytest.approx(0.5)  # both were late by as much


def test_scans_before_a_turn_lie_to_its_side() -> None:
    poses = poses_back(kept(AHEAD, TURN), np.zeros(4))
    assert [(round(p.x_m, 9), round(p.y_m, 9)) for p in poses] == [(0.0, 0.5), (0.0, 0.0), (0.0, 0.0)]
    assert poses[0].heading_rad == pytest.approx(-pi / 2)


def test_the_way_back_is_without_what_odometry_is_wrong_by() -> None:
    poses = poses_back(kept(AHEAD), np.array([-0.1, 0.0, 0.0, 0.0]))
    assert poses[0].x_m == pytest.approx(-0.45)


def test_echoes_come_nearest_first_from_where_their_sonar_was() -> None:
    behind = Pose(x_m=-1.0, y_m=0.0, heading_rad=0.0)
    echoes = heard([SCAN, SonarScan(sensors=(1,), ranges_m=(1.0,))], [behind, IDENTITY], ROBOT, 3.0)
    assert echoes.ranges_m.tolist() == [1.0, 1.5, 2.0]
    assert echoes.cones_rad.tolist() == [0.2, 0.2, 0.4]
    np.testing.assert_allclose(echoes.sensors, [(0.3, 0.0, 0.0), (-0.7, 0.0, 0.0), (-0.9, 0.2, pi / 2)])


def test_silence_and_what_is_beyond_reach_is_left_out() -> None:
    assert len(heard([SonarScan(sensors=(0, 1), ranges_m=(None, 1.5))], [IDENTITY], ROBOT, 1.2).ranges_m) == 0


def test_a_sonar_that_the_robot_lacks_is_named() -> None:
    with pytest.raises(BoardError, match="sonar number 7"):
        heard([SonarScan(sensors=(7,), ranges_m=(1.0,))], [IDENTITY], ROBOT, 3.0)
