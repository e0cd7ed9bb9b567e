"""Sensors by number, and an error that says what is missing."""

import pytest

from blackboard.errors import BoardError
from blackboard.messages.geometry import IDENTITY
from blackboard.messages.sensing import LaserSensor, RobotDescription, SonarSensor
from knowledge_sources.sensors import laser_of, sonar_of

SONAR = SonarSensor(mount=IDENTITY, cone_rad=0.2, max_range_m=10.0)
LASER = LaserSensor(mount=IDENTITY, max_range_m=30.0)


def robot(sonars: int, lasers: int) -> RobotDescription:
    return RobotDescription(
        name="k2a", radius_m=0.3, max_speed_mps=0.5, max_turn_radps=1.0, max_acceleration_mps2=0.5,
        sonars=(SONAR,) * sonars, lasers=(LASER,) * lasers,
    )  # fmt: skip


def test_sensors_by_number() -> None:
    assert sonar_of(robot(2, 0), 1) is SONAR
    assert laser_of(robot(0, 1), 0) is LASER


def test_a_sensor_that_is_not_there_is_named() -> None:
    with pytest.raises(BoardError, match="sonar number 12, the description of robot 'k2a' has numbers 0 to 11"):
        sonar_of(robot(12, 0), 12)
    with pytest.raises(BoardError, match="laser number 0, the description of robot 'k2a' has none"):
        laser_of(robot(12, 0), 0)
