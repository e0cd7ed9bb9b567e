"""Odometry steps without their errors, and how the pose tells of those errors."""

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import IDENTITY, Pose
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.pose_filter import corrected, predict, start, update

PARAMS = SonarMatcherParams()


def test_a_step_is_scaled_turned_and_bent_by_the_drift() -> None:
    straight = corrected(Pose(x_m=1.0, y_m=0.0, heading_rad=0.0), np.array([-0.04, 0.5, 0.02]))
    assert straight.heading_rad == pytest.approx(0.02)
    assert straight.distance_m(IDENTITY) == pytest.approx(0.96)
    assert straight.y_m / straight.x_m == pytest.approx(np.tan(0.01))
    on_the_spot = corrected(Pose(x_m=0.0, y_m=0.0, heading_rad=radians(90)), np.array([0.1, -0.1, 0.02]))
    assert on_the_spot.heading_rad == pytest.approx(radians(81))
    assert on_the_spot.distance_m(IDENTITY) == 0.0


def test_driving_straight_spreads_along_by_the_scale_and_across_by_the_heading() -> None:
    estimate = start(IDENTITY, PARAMS)
    for _ in range(20):
        estimate = predict(estimate, Pose(x_m=0.1, y_m=0.0, heading_rad=0.0), PARAMS)
    assert estimate.map_from_robot.x_m == pytest.approx(2.0)
    along = (2.0 * PARAMS.distance_scale) ** 2 + 2.0 * PARAMS.distance_noise_m**2
    assert estimate.covariance[0, 0] == pytest.approx(along, rel=0.01)
    heading = (2.0 * PARAMS.drift_rad_per_m) ** 2 + 2.0 * PARAMS.heading_noise_rad**2
    assert estimate.covariance[2, 2] == pytest.approx(heading, rel=0.01)


def test_a_pose_found_behind_tells_that_odometry_counts_too_much() -> None:
    estimate = start(IDENTITY, PARAMS)
    for _ in range(50):
        estimate = predict(estimate, Pose(x_m=0.1, y_m=0.0, heading_rad=0.0), PARAMS)
    sure = np.diag([1e6, 1e6, 1e6])
    estimate = update(estimate, np.array([-0.2, 0.0, 0.0]), sure)
    assert estimate.map_from_robot.x_m == pytest.approx(4.8)
    assert estimate.errors[0] == pytest.approx(-0.04, abs=0.005)
    assert estimate.covariance[3, 3] < 0.2 * PARAMS.distance_scale**2


def test_what_informs_of_nothing_changes_nothing() -> None:
    before = predict(start(IDENTITY, PARAMS), Pose(x_m=0.5, y_m=0.1, heading_rad=0.3), PARAMS)
    after = update(before, np.zeros(3), np.zeros((3, 3)))
    np.testing.assert_allclose(after.mean, before.mean)
    np.testing.assert_allclose(after.covariance, before.covariance, atol=1e-12)


small = st.floats(-0.3, 0.3)


@given(st.lists(st.tuples(small, small, st.floats(-0.5, 0.5)), min_size=1, max_size=10), st.floats(-pi, pi))
def test_turning_the_map_turns_the_estimate_with_it(steps: list[tuple[float, float, float]], turn_rad: float) -> None:
    turned = Pose(x_m=3.0, y_m=-2.0, heading_rad=turn_rad)
    here, there = start(IDENTITY, PARAMS), start(turned, PARAMS)
    for x_m, y_m, heading_rad in steps:
        step = Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad)
        here, there = predict(here, step, PARAMS), predict(there, step, PARAMS)
    expected = turned @ here.map_from_robot
    assert there.map_from_robot.x_m == pytest.approx(expected.x_m, abs=1e-9)
    assert there.map_from_robot.y_m == pytest.approx(expected.y_m, abs=1e-9)
    assert np.trace(there.covariance) == pytest.approx(np.trace(here.covariance))
    assert np.linalg.eigvalsh(there.covariance)[0] > 0.0
