"""Where an echo met a wall, by hand."""

from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.echoes import Echoes, expected_ranges, in_order, incidence, met, near_lines, on_wall, wrap


def echo(range_m: float, bearing_deg: float, half_cone_deg: float, x_m: float = 0.0, y_m: float = 0.0) -> Echoes:
    here = np.array([[x_m, y_m]])
    bearing = radians(bearing_deg)
    there = here + range_m * np.array([[cos(bearing), sin(bearing)]])
    return in_order(here, there, np.array([radians(half_cone_deg)]), radians(30.0), radians(80.0))


def test_the_foot_of_the_perpendicular_answers_if_it_lies_in_the_cone() -> None:
    # A wall that faces -x; the sensor at (1, 2) looks 5 degrees aside of its normal and hears 3 m: the wall is x = 4.
    along, out = on_wall(echo(3.0, 5.0, 6.0, 1.0, 2.0), 0.0)
    assert (along[0], out[0]) == pytest.approx((2.0, 4.0))


def test_else_the_cone_s_edge_answers() -> None:
    # 26 degrees aside, half a cone of 6: the sound came along 20 degrees.
    along, out = on_wall(echo(3.0, 26.0, 6.0, 1.0, 2.0), 0.0)
    assert (along[0], out[0]) == pytest.approx((2.0 + 3.0 * sin(radians(20.0)), 1.0 + 3.0 * cos(radians(20.0))))
    assert incidence(echo(3.0, -26.0, 6.0), 0.0)[0] == pytest.approx(radians(-20.0))


def test_a_beam_ends_where_its_point_is() -> None:
    along, out = on_wall(echo(sqrt(2.0), 45.0, 0.0), pi / 2)
    assert (along[0], out[0]) == pytest.approx((-1.0, 1.0))


def test_walls_too_aslant_or_too_far_cannot_have_answered() -> None:
    heard = echo(2.0, 0.0, 6.0)
    alpha = np.radians([0.0, 0.0, 35.0, 37.0, 180.0])
    # At 35 degrees the edge of the cone, 29 degrees off the normal, met the wall.
    rho = np.array([1.95, 1.89, 2.0 * cos(radians(29.0)), 2.0 * cos(radians(31.0)), 2.0])
    line, which = near_lines(heard, alpha, rho, 0.1)
    assert line.tolist() == [0, 2]
    assert which.tolist() == [0, 0]
    beyond, along = met(heard, alpha[:1], rho[:1])
    assert (beyond[0], along[0]) == pytest.approx((0.05, 0.0))


def expected(heard: Echoes, start_m: float, end_m: float) -> float:
    return float(expected_ranges(heard, 0.0, 2.0, np.array([start_m]), np.array([end_m]))[0])


def test_a_wall_answers_from_its_nearest_point_in_the_cone() -> None:
    straight = echo(1.0, 0.0, 6.0)
    assert expected(straight, -1.0, 1.0) == pytest.approx(2.0)
    # It ends at 0.1 m: within the cone, whose edge is at 2 tan(6 degrees) = 0.21 m.
    assert expected(straight, 0.1, 1.0) == pytest.approx(sqrt(4.01))
    assert expected(straight, 0.22, 1.0) == np.inf
    # 16 degrees aside: the edge, 10 degrees off the normal.
    assert expected(echo(1.0, 16.0, 6.0), -1.0, 1.0) == pytest.approx(2.0 / cos(radians(10.0)))
    assert expected(echo(1.0, 37.0, 6.0), -5.0, 5.0) == np.inf
    assert expected(echo(1.0, 180.0, 6.0), -5.0, 5.0) == np.inf


def test_a_wall_behind_the_sensor_does_not_answer() -> None:
    assert expected(echo(1.0, 0.0, 6.0, 2.5, 0.0), -1.0, 1.0) == np.inf


ANGLES = st.floats(-pi, pi)


@given(st.floats(0.1, 8.0), ANGLES, st.floats(0.0, 0.3), ANGLES)
def test_an_echo_s_wall_would_send_that_echo(
    range_m: float, bearing_rad: float, half_cone_rad: float, off: float
) -> None:
    heard = echo(range_m, np.degrees(bearing_rad), np.degrees(half_cone_rad))
    alpha = bearing_rad + off * (half_cone_rad + radians(29.0)) / pi
    along, out = on_wall(heard, alpha)
    back = expected_ranges(heard, alpha, float(out[0]), along[:1] - 9.0, along[:1] + 9.0)
    assert back[0] == pytest.approx(range_m)


@given(st.permutations(range(12)))
def test_the_order_of_the_readings_does_not_matter(order: list[int]) -> None:
    here = np.arange(24.0).reshape(12, 2) % 5
    there, cones = here + np.array([[1.0, 0.5]]), np.linspace(0.0, 0.2, 12)
    one, other = in_order(here, there, cones, 0.5, 1.4), in_order(here[order], there[order], cones[order], 0.5, 1.4)
    for name in ("x_m", "y_m", "range_m", "bearing_rad", "half_cone_rad", "max_incidence_rad"):
        assert (getattr(one, name) == getattr(other, name)).all()


@given(st.floats(-20.0, 20.0))
def test_wrapping_keeps_the_direction(angle: float) -> None:
    wrapped = float(wrap(np.array([angle]))[0])
    assert abs(wrapped) <= pi + 1e-12
    assert cos(wrapped) == pytest.approx(cos(angle), abs=1e-9)


@given(st.lists(st.tuples(ANGLES, st.floats(-3.0, 3.0)), min_size=1, max_size=20))
def test_near_is_near_however_it_is_found(lines: list[tuple[float, float]]) -> None:
    rng = np.random.default_rng(4)
    here, there = rng.uniform(40.0, 42.0, (30, 2)), rng.uniform(38.0, 44.0, (30, 2))
    heard = in_order(here, there, np.tile([0.0, 0.1], 15), radians(60.0), radians(80.0))
    alpha = np.array([a for a, _ in lines])
    rho = 41.0 * (np.cos(alpha) + np.sin(alpha)) + np.array([r for _, r in lines])
    found = list(zip(*(index.tolist() for index in near_lines(heard, alpha, rho, 0.2)), strict=True))
    for k in range(len(alpha)):
        beyond, _ = met(heard, np.full(30, alpha[k]), np.full(30, rho[k]))
        facing = np.abs(wrap(heard.bearing_rad - alpha[k])) <= heard.reach_rad
        near = np.flatnonzero((np.abs(beyond) <= 0.2) & facing).tolist()
        assert [n for line, n in found if line == k] == near
