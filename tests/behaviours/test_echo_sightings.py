from math import pi

import pytest

from behaviours.echo_sightings import contacts, laser_looks, sightings, sonar_looks
from blackboard.messages.sensing import Bumper, LaserScan, RobotDescription, SonarScan


def test_a_range_is_measured_from_the_sensors_mount(ring: RobotDescription) -> None:
    looks = sonar_looks(SonarScan(sensors=(0, 3), ranges_m=(0.7, 0.2)), ring)
    ahead, left = sightings(looks, within_m=2.0)
    assert (ahead.x_m, ahead.y_m) == pytest.approx((1.0, 0.0))
    assert (left.x_m, left.y_m) == pytest.approx((0.0, 0.5))


def test_silence_full_range_and_unknown_sensors_are_no_sightings(ring: RobotDescription) -> None:
    looks = sonar_looks(SonarScan(sensors=(0, 1, 40), ranges_m=(None, 10.0, 0.5)), ring)
    assert [look.echo for look in looks] == [False, False]
    assert sightings(looks, within_m=50.0) == []


def test_what_is_too_far_is_left_out(ring: RobotDescription) -> None:
    looks = sonar_looks(SonarScan(sensors=(0, 6), ranges_m=(1.69, 1.71)), ring)
    assert len(sightings(looks, within_m=2.0)) == 1


def test_a_laser_gives_its_nearest_beam_of_each_five_degrees(make_bench) -> None:
    ranges: list[float | None] = [None] * 181
    ranges[90], ranges[92], ranges[0] = 1.0, 0.9, 8.0
    scan = LaserScan(angle_min_rad=-pi / 2, angle_step_rad=pi / 180, ranges_m=tuple(ranges))
    looks = laser_looks(scan, make_bench(laser=True).robot)
    assert len(looks) == 1
    assert looks[0].range_m == 0.9
    assert looks[0].heading_rad == pytest.approx(2 * pi / 180)
    assert looks[0].x_m == 0.1


def test_a_scan_of_a_laser_that_nobody_described_says_nothing(ring: RobotDescription) -> None:
    assert laser_looks(LaserScan(angle_min_rad=0.0, angle_step_rad=0.1, ranges_m=(1.0,)), ring) == []


def test_contacts_lie_on_the_rim(ring: RobotDescription) -> None:
    (contact,) = contacts(Bumper(bearings_rad=(pi / 2,)), ring)
    assert (contact.x_m, contact.y_m) == pytest.approx((0.0, 0.3))
