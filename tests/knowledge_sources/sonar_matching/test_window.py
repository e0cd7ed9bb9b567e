"""Poses of a window's scans, and the sensors of their echoes."""

from math import pi

import numpy as np
import pytest

from blackboard.errors import BoardError
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import RobotDescription, SonarScan, SonarSensor
from knowledge_sources.sonar_matching.window import Kept, heard, poses_back

LEFT = SonarSensor(mount=Pose(x_m=0.1, y_m=0.2, heading_rad=pi / 2), cone_rad=0.4, max_range_m=5.0)
FRONT = SonarSensor(mount=Pose(x_m=0.3, y_m=0.0, heading_rad=0.0), cone_rad=0.2, max_range_m=5.0)
ROBOT = RobotDescription(
    name="two", radius_m=0.3, max_speed_mps=0.5, max_turn_radps=1.0, max_acceleration_mps2=0.5, sonars=(LEFT, FRONT)
)
SCAN = SonarScan(sensors=(0, 1), ranges_m=(2.0, 1.5))
AHEAD = Pose(x_m=0.5, y_m=0.0, heading_rad=0.0)
TURN = Pose(x_m=0.0, y_m=0.0, heading_rad=pi / 2)


def test_scans_before_a_turn_lie_to_its_side() -> None:
    poses = poses_back([Kept(SCAN, IDENTITY), Kept(SCAN, AHEAD), Kept(SCAN, TURN)], np.zeros(3))
    assert [(round(p.x_m, 9), round(p.y_m, 9)) for p in poses] == [(0.0, 0.5), (0.0, 0.0), (0.0, 0.0)]
    assert poses[0].heading_rad == pytest.approx(-pi / 2)


def test_the_way_back_is_without_what_odometry_is_wrong_by() -> None:
    poses = poses_back([Kept(SCAN, IDENTITY), Kept(SCAN, AHEAD)], np.array([-0.1, 0.0, 0.0]))
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
