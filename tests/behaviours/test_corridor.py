from math import inf, pi, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.corridor import clear_way_m, free_travel_m, off_course
from behaviours.near_echoes import Near

angles = st.floats(-pi, pi)


def near(distance_m: float, bearing_rad: float) -> Near:
    return (distance_m, bearing_rad, 0.0, 0.0, True)


def test_straight_ahead_the_rim_arrives_first() -> None:
    assert free_travel_m(1.0, 0.0, 0.3) == pytest.approx(0.7)


def test_beside_the_way_the_disc_meets_the_point_with_its_shoulder() -> None:
    # the point lies 0.8 ahead and 0.24 aside: the disc of 0.3 touches when its centre is sqrt(0.3^2 - 0.24^2) = 0.18 short of it
    assert free_travel_m(sqrt(0.8**2 + 0.24**2), 0.2914567944778671, 0.3) == pytest.approx(0.62)


def test_what_is_wider_aside_than_the_disc_is_passed() -> None:
    assert free_travel_m(1.0, 0.31, 0.3) == inf  # sin(0.31) = 0.305


def test_a_point_within_the_disc_blocks_the_way_to_it_only() -> None:
    assert free_travel_m(0.25, 0.0, 0.3) == 0.0
    assert free_travel_m(0.25, 1.2, 0.3) == 0.0
    assert free_travel_m(0.25, 1.5, 0.3) == inf
    assert free_travel_m(0.25, 2.5, 0.3) == inf


@given(angles, angles)
def test_angles_between_directions_are_symmetric_and_within_a_half_turn(a: float, b: float) -> None:
    assert 0.0 <= off_course(a, b) <= pi
    assert off_course(a, b) == pytest.approx(off_course(b, a))


@given(st.lists(st.tuples(st.floats(0.31, 3.0), angles), max_size=8), angles, angles)
def test_a_clear_way_turns_with_the_world(points: list[tuple[float, float]], way: float, turn: float) -> None:
    clear = clear_way_m([near(d, b) for d, b in points], way, 0.4, 2.0)
    turned = clear_way_m([near(d, b + turn) for d, b in points], way + turn, 0.4, 2.0)
    assert clear <= 2.0
    assert turned == pytest.approx(clear, abs=1e-3)


@given(st.floats(0.31, 5.0), st.floats(0.0, pi), st.floats(0.05, 0.3))
def test_a_wider_disc_never_gets_further(distance: float, off: float, narrower: float) -> None:
    assert free_travel_m(distance, off, 0.3) <= free_travel_m(distance, off, narrower) + 1e-9
