"""What readings say of places: a beam of what lies on it, a cone of what lies in it."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import LaserScan, LaserSensor, RobotDescription, SonarScan, SonarSensor
from knowledge_sources.looks import SEEN, THROUGH, UNKNOWN, beams_of, look

ROBOT = RobotDescription(
    name="r",
    radius_m=0.2,
    max_speed_mps=1.0,
    max_turn_radps=1.0,
    max_acceleration_mps2=1.0,
    sonars=(SonarSensor(mount=IDENTITY, cone_rad=radians(20), max_range_m=5.0),),
    lasers=(LaserSensor(mount=IDENTITY, max_range_m=8.0),),
)
AT = np.array([[1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [2.0, 0.3], [0.0, 2.0]])


def test_a_beam_and_a_cone() -> None:
    laser = LaserScan(angle_min_rad=-radians(1), angle_step_rad=radians(1), ranges_m=(2.0, 2.0, 2.0))
    found = look(beams_of(laser, ROBOT, IDENTITY), AT, 0.05, 8.0).tolist()
    assert found == [THROUGH, SEEN, UNKNOWN, UNKNOWN, UNKNOWN]  # before it, on it, behind it, beside it, elsewhere
    sonar = SonarScan(sensors=(0,), ranges_m=(1.02,))
    near = AT / 2
    assert look(beams_of(sonar, ROBOT, IDENTITY), near, 0.05, 8.0).tolist() == [THROUGH, SEEN, UNKNOWN, SEEN, UNKNOWN]
    far = SonarScan(sensors=(0,), ranges_m=(2.02,))  # what answers in so wide a cone may lie anywhere across it
    assert look(beams_of(far, ROBOT, IDENTITY), AT, 0.05, 8.0).tolist() == [THROUGH, UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN]
    assert look(beams_of(sonar, ROBOT, IDENTITY), near, 0.05, 0.2).tolist() == [UNKNOWN] * 5  # out of reach


def test_silence_says_nothing() -> None:
    silent = SonarScan(sensors=(0,), ranges_m=(None,))
    assert look(beams_of(silent, ROBOT, IDENTITY), AT, 0.05, 8.0).tolist() == [UNKNOWN] * 5
    assert look(beams_of(silent, ROBOT, IDENTITY), np.zeros((0, 2)), 0.05, 8.0).tolist() == []


@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(-pi, pi), st.floats(0.2, 6.0), st.floats(-0.5, 0.5))
def test_the_same_wherever_the_robot_stands(x: float, y: float, heading: float, range_m: float, aside: float) -> None:
    scan = LaserScan(angle_min_rad=-0.1, angle_step_rad=0.02, ranges_m=(range_m,) * 11)
    places = np.array([[range_m * 0.7, aside], [range_m * cos(aside), range_m * sin(aside)]])
    pose = Pose(x_m=x, y_m=y, heading_rad=heading)
    moved = np.array([pose.transform(px, py) for px, py in places.tolist()])
    here = look(beams_of(scan, ROBOT, IDENTITY), places, 0.05, 8.0)
    there = look(beams_of(scan, ROBOT, pose), moved, 0.05, 8.0)
    edge = abs(abs(aside) - 0.11) < 1e-3 or abs(abs(np.arctan2(aside, range_m * 0.7)) - 0.11) < 1e-3
    assert edge or here.tolist() == there.tolist()
    assert here[1] == pytest.approx(SEEN if abs(aside) < 0.109 else UNKNOWN if abs(aside) > 0.111 else here[1])
