"""How a pose becomes unsure on the way."""

from math import hypot, pi

import numpy as np
import pytest

from blackboard.messages.geometry import IDENTITY, Pose
from knowledge_sources.odometry_uncertainty import OdometryNoise, Unsureness, Way, carried_on, way_of

NOISE = OdometryNoise(distance_fraction=0.02, heading_rad_per_m=0.01, heading_fraction=0.1, heading_noise_rad=0.0)


SURE = Unsureness(pose=np.zeros((3, 3)), shared=np.zeros((3, 3)))


def pose(x: float, y: float, heading: float = 0.0) -> Pose:
    return Pose(x_m=x, y_m=y, heading_rad=heading)


def test_a_way_by_hand() -> None:
    way = way_of([pose(0, 0), pose(3, 4, 0.5), pose(3, 4, 0.2), pose(3, 5, 3.0), pose(3, 5, -3.0)])
    assert way.length_m == pytest.approx(6.0)
    assert way.turn_rad == pytest.approx(0.5 - 0.3 + 2.8 + (2 * pi - 6.0))
    assert way.turned_rad == pytest.approx(0.5 + 0.3 + 2.8 + (2 * pi - 6.0))
    assert way_of([]) == Way(length_m=0.0, turn_rad=0.0, turned_rad=0.0)


def test_ten_metres_straight_on() -> None:
    after = carried_on(SURE, IDENTITY, pose(10, 0), Way(length_m=10, turn_rad=0, turned_rad=0), NOISE)
    # forward 2 %, heading 0.1 rad, sideways half of what the heading makes of 10 m
    assert np.sqrt(np.diag(after.pose)) == pytest.approx([0.2, 0.5, 0.1])
    assert after.pose[1, 2] == pytest.approx(0.05)


def test_a_way_in_pieces_errs_as_the_whole() -> None:
    known = SURE
    for step in range(10):
        known = carried_on(known, pose(step, 0), pose(step + 1, 0), Way(length_m=1, turn_rad=0, turned_rad=0), NOISE)
    assert np.sqrt(np.diag(known.pose)) == pytest.approx([0.2, 0.5, 0.1])
    assert known.pose[1, 2] == pytest.approx(0.05)
    assert known.shared == pytest.approx(
        np.array([[10, 0, 0], [0, 50, 0], [0, 10, 0]]) * np.array([0.02, 0.01, 0.1]) ** 2
    )


def test_an_old_heading_error_swings_the_way() -> None:
    still = OdometryNoise(distance_fraction=0, heading_rad_per_m=0, heading_fraction=0, heading_noise_rad=0)
    before = np.diag([0.0, 0.0, 0.1**2])
    known = Unsureness(pose=before, shared=np.zeros((3, 3)))
    after = carried_on(known, IDENTITY, pose(0, 5), Way(length_m=5, turn_rad=0, turned_rad=0), still)
    assert np.sqrt(np.diag(after.pose)) == pytest.approx([0.5, 0.0, 0.1])


def test_there_and_back_leaves_less_than_the_whole_way() -> None:
    way = Way(length_m=10, turn_rad=pi, turned_rad=pi)
    after = carried_on(SURE, IDENTITY, pose(0, 0, pi), way, NOISE)
    assert np.sqrt(np.diag(after.pose)) == pytest.approx([0.1, 0.1, hypot(0.1, 0.1 * pi)])
