"""Odometry steps move the robot and tell of their errors; matches to patches inform as far as the patch itself is known."""

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import IDENTITY, Pose
from knowledge_sources.sonar_matching.joint_filter import Estimate, in_patch, predict, start, update, with_patch
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.window import Told

PARAMS = SonarMatcherParams()
SURE = np.diag([1e6, 1e6, 1e6])


def driven(estimate: Estimate, steps: list[Pose], told: Pose = IDENTITY, speed: Pose = IDENTITY) -> Estimate:
    before = Told(told, speed)
    for step in steps:
        after = Told(before.odom_from_robot @ step, speed)
        estimate = predict(estimate, before, after, PARAMS)
        before = after
    return estimate


def ahead(x_m: float) -> Pose:
    return Pose(x_m=x_m, y_m=0.0, heading_rad=0.0)


def test_driving_straight_spreads_along_by_the_scale_and_across_by_the_heading() -> None:
    estimate = driven(start(IDENTITY, PARAMS), [ahead(0.1)] * 20)
    assert estimate.map_from_robot.x_m == pytest.approx(2.0)
    along = (2.0 * PARAMS.distance_scale) ** 2 + 2.0 * PARAMS.distance_noise_m**2
    assert estimate.covariance[0, 0] == pytest.approx(along, rel=0.01)
    heading = (2.0 * PARAMS.drift_rad_per_m) ** 2 + 2.0 * PARAMS.heading_noise_rad**2
    assert estimate.covariance[2, 2] == pytest.approx(heading, rel=0.01)


def test_a_pose_found_behind_tells_that_odometry_counts_too_much() -> None:
    estimate = driven(with_patch(start(IDENTITY, PARAMS)), [ahead(0.1)] * 50)
    estimate = update(estimate, 0, np.array([-0.2, 0.0, 0.0]), SURE)
    assert estimate.map_from_robot.x_m == pytest.approx(4.8, abs=0.001)
    assert estimate.errors[0] == pytest.approx(-0.04, abs=0.005)
    assert estimate.covariance[3, 3] < 0.2 * PARAMS.distance_scale**2


def test_setting_off_with_late_stamps_is_found_out() -> None:
    """From standing to 0.5 m/s: the scan was taken where the robot was 0.1 s before, 0.05 m behind."""
    before = Told(IDENTITY, IDENTITY)
    after = Told(ahead(0.3), ahead(0.5))
    estimate = predict(with_patch(start(IDENTITY, PARAMS)), before, after, PARAMS)
    estimate = update(estimate, 0, np.array([-0.05, 0.0, 0.0]), SURE)
    assert estimate.errors[3] == pytest.approx(0.09, abs=0.02)


def test_nobody_becomes_surer_by_a_match_than_the_patch_is() -> None:
    """A patch begun after 5 m is as unsure as the robot was; a sure match to it leaves that."""
    away = driven(with_patch(start(IDENTITY, PARAMS)), [ahead(0.1)] * 50)
    before = away.covariance[:3, :3]
    after = update(with_patch(away), 1, np.zeros(3), SURE)
    np.testing.assert_allclose(after.covariance[:3, :3], before, rtol=0.01, atol=1e-5)


def test_meeting_an_old_patch_again_moves_the_newer_ones_too() -> None:
    out = driven(with_patch(start(IDENTITY, PARAMS)), [ahead(0.1)] * 30)
    two = with_patch(out)
    back = driven(two, [ahead(-0.1)] * 30, told=ahead(3.0))
    found = update(back, 0, np.array([0.0, 0.0, 0.05]), np.diag([0.0, 0.0, 1e6]))
    assert found.map_from_patch(0).distance_m(IDENTITY) < 1e-4
    assert found.map_from_patch(1).heading_rad > 0.005
    assert np.trace(found.covariance[-3:, -3:]) < np.trace(two.covariance[-3:, -3:])


def test_what_informs_of_nothing_changes_nothing() -> None:
    before = driven(with_patch(start(IDENTITY, PARAMS)), [Pose(x_m=0.5, y_m=0.1, heading_rad=0.3)])
    after = update(before, 0, np.zeros(3), np.zeros((3, 3)))
    np.testing.assert_allclose(after.mean, before.mean)
    np.testing.assert_allclose(after.covariance, before.covariance, atol=1e-12)


def test_a_robot_is_seen_from_a_patch_as_poses_compose() -> None:
    origin = Pose(x_m=2.0, y_m=1.0, heading_rad=radians(90))
    estimate = driven(with_patch(start(origin, PARAMS)), [ahead(0.5)], told=origin)
    seen, covariance, _ = in_patch(estimate, 0)
    assert (seen.x_m, seen.y_m, seen.heading_rad) == pytest.approx((0.5, 0.0, 0.0))
    assert covariance[0, 0] > covariance[1, 1]  # along the way: the scale


small = st.floats(-0.3, 0.3)


@given(st.lists(st.tuples(small, small, st.floats(-0.5, 0.5)), min_size=1, max_size=10), st.floats(-pi, pi))
def test_turning_the_map_turns_the_estimate_with_it(steps: list[tuple[float, float, float]], turn_rad: float) -> None:
    turned = Pose(x_m=3.0, y_m=-2.0, heading_rad=turn_rad)
    way = [Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad) for x_m, y_m, heading_rad in steps]
    here = driven(start(IDENTITY, PARAMS), way)
    there = driven(start(turned, PARAMS), way, told=turned)
    expected = turned @ here.map_from_robot
    assert there.map_from_robot.x_m == pytest.approx(expected.x_m, abs=1e-9)
    assert there.map_from_robot.y_m == pytest.approx(expected.y_m, abs=1e-9)
    assert np.trace(there.covariance) == pytest.approx(np.trace(here.covariance))
    assert np.linalg.eigvalsh(there.covariance)[0] > 0.0
