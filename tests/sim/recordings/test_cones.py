"""A laser thinned to cones: the nearest echo in each."""

from math import inf, nan, pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserSensor
from sim.recordings.cones import Fan, cone_of_beams, cone_sensors, thin

SICK = Fan(radians(-90), radians(1), 180)
LASER = LaserSensor(mount=Pose(x_m=0.2, y_m=0.0, heading_rad=0.0), max_range_m=80.0)


def test_twelve_cones_of_a_sick_laser() -> None:
    sonars = cone_sensors(SICK, 12, LASER)
    assert [s.cone_rad for s in sonars] == pytest.approx([radians(15)] * 12)
    headings = [s.mount.heading_rad for s in sonars]
    assert headings == pytest.approx([radians(-90.5 + 7.5 + 15 * i) for i in range(12)])
    assert all(s.mount.x_m == pytest.approx(0.2) for s in sonars)
    assert cone_of_beams(SICK, SICK, 12).tolist() == [i // 15 for i in range(180)]


def test_cone_hears_the_nearest_beam_and_keeps_what_is_no_return() -> None:
    ranges = np.array([3.0, 2.0, inf, inf, nan, inf, nan, nan, nan, 5.0])
    cones = cone_of_beams(Fan(0.0, 0.1, 10), Fan(0.0, 0.1, 10), 5)
    heard = thin(ranges, cones, 5)
    assert heard.tolist()[:3] == [2.0, inf, inf]
    assert np.isnan(heard[3])
    assert heard[4] == 5.0


def test_mount_turns_the_cones() -> None:
    turned = LaserSensor(mount=Pose(x_m=0.0, y_m=0.0, heading_rad=pi / 2), max_range_m=12.0)
    (sonar,) = cone_sensors(Fan(-0.5, 0.1, 11), 1, turned)
    assert sonar.mount.heading_rad == pytest.approx(pi / 2)
    assert sonar.cone_rad == pytest.approx(1.1)


def test_a_laser_that_runs_clockwise() -> None:
    fan = Fan(radians(89.5), radians(-1), 180)
    sonars = cone_sensors(fan, 2, LASER)
    assert [s.mount.heading_rad for s in sonars] == pytest.approx([radians(45), radians(-45)])
    assert all(s.cone_rad == pytest.approx(radians(90)) for s in sonars)
    assert cone_of_beams(fan, fan, 2).tolist() == [0] * 90 + [1] * 90


def test_a_scan_of_other_beams_falls_in_by_angle() -> None:
    narrow = Fan(radians(-45), radians(0.5), 180)
    cones = cone_of_beams(narrow, SICK, 12)
    assert cones[0] == 3
    assert cones[-1] == 9  # 44.5 degrees lies on an edge: it belongs to the later cone
    assert cone_of_beams(Fan(radians(-120), radians(1), 2), SICK, 12).tolist() == [-1, -1]


@given(
    st.lists(st.one_of(st.floats(0.01, 50), st.just(inf), st.just(nan)), min_size=1, max_size=50), st.integers(1, 50)
)
def test_no_echo_is_lost_and_none_invented(values: list[float], wanted: int) -> None:
    ranges = np.array(values)
    cones = min(wanted, len(values))
    fan = Fan(-1.0, 2.0 / len(values), len(values))
    of_beams = cone_of_beams(fan, fan, cones)
    assert set(of_beams.tolist()) == set(range(cones))
    assert np.all(np.diff(of_beams) >= 0)
    heard = thin(ranges, of_beams, cones)
    for cone in range(cones):
        fit = ranges[(of_beams == cone) & ~np.isnan(ranges)]
        assert (np.isnan(heard[cone]) and fit.size == 0) or heard[cone] == fit.min()
