"""What echoes prove of a wall."""

from itertools import pairwise
from math import cos, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.echoes import in_order
from knowledge_sources.line_evidence import independent_places, stretches
from knowledge_sources.line_fit import Fit

WALL = Fit(alpha_rad=0.0, rho_m=2.0, spread_m=0.01, tilt_rad=0.0)  # x = 2


def stretch(range_m: float, bearing_deg: float, half_cone_deg: float) -> tuple[float, float]:
    bearing = radians(bearing_deg)
    there = range_m * np.array([[cos(bearing), sin(bearing)]])
    heard = in_order(np.zeros((1, 2)), there, np.array([radians(half_cone_deg)]), radians(30.0), radians(80.0))
    first, last = stretches(heard, WALL, 0.02)
    return float(first[0]), float(last[0])


def test_straight_ahead_the_arc_leaves_much_open() -> None:
    # Within 2 cm of 2 m is all within sqrt(2.02^2 - 2^2) = 0.284 m; the cone cuts it to 2 tan(6 degrees) = 0.210 m.
    assert stretch(2.0, 0.0, 6.0) == pytest.approx((-2 * tan(radians(6)), 2 * tan(radians(6))))
    # 4 degrees aside the cone goes from -2 to 10 degrees, and the ring's end is nearer than that.
    assert stretch(2.0, 4.0, 6.0) == pytest.approx((-2 * tan(radians(2)), sqrt(2.02**2 - 4)))


def test_an_edge_of_the_cone_is_sharp() -> None:
    # Heard along 20 degrees at 2 / cos(20) = 2.128 m: from the edge to where 2.148 m meets the wall.
    first, last = stretch(2.0 / cos(radians(20)), 26.0, 6.0)
    assert first == pytest.approx(2 * tan(radians(20)))
    assert last == pytest.approx(sqrt((2 / cos(radians(20)) + 0.02) ** 2 - 4))
    mirrored = stretch(2.0 / cos(radians(20)), -26.0, 6.0)
    assert mirrored == pytest.approx((-last, -first))


def test_a_beam_says_where() -> None:
    assert stretch(2.0 / cos(radians(10)), 10.0, 0.0) == pytest.approx((2 * tan(radians(10)), 2 * tan(radians(10))))


def test_an_echo_that_the_wall_does_not_explain_has_no_stretch() -> None:
    first, last = stretch(2.5, 26.0, 6.0)
    assert first > last or last < 2 * tan(radians(20)) or first > 2 * tan(radians(32))


def test_places_by_hand() -> None:
    # 0..2 and 1..3 meet; 2.5..4 meets 1..3, but the first things are at 2 and 4; 4..5 meets 2.5..4.
    first, last = np.array([1.0, 0.0, 4.0, 2.5, 4.5]), np.array([3.0, 2.0, 5.0, 4.0, 6.0])
    assert independent_places(first, last) == [(0.0, 2.0), (2.5, 4.0), (4.5, 6.0)]
    assert independent_places(np.array([]), np.array([])) == []


def test_a_corner_is_one_place_however_often_it_is_heard() -> None:
    rng = np.random.default_rng(1)
    here = np.stack([rng.uniform(-1.0, 0.5, 200), rng.uniform(-0.5, 0.5, 200)], axis=1)
    corner = np.array([2.0, 0.1])
    toward = corner - here
    range_m = np.hypot(toward[:, 0], toward[:, 1])
    bearing = np.arctan2(toward[:, 1], toward[:, 0]) + rng.uniform(-0.1, 0.1, 200)
    there = here + range_m[:, None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    heard = in_order(here, there, np.full(200, radians(6.0)), pi / 2, pi / 2)
    first, last = stretches(heard, WALL, 0.02)
    assert (first <= 0.1 + 1e-9).all()
    assert (last >= 0.1 - 1e-9).all()
    assert len(independent_places(first, last)) == 1


@given(st.lists(st.tuples(st.floats(-9, 9), st.floats(0, 3)), max_size=30))
def test_places_do_not_meet_and_miss_no_stretch(spans: list[tuple[float, float]]) -> None:
    first = np.array([start for start, _ in spans])
    last = np.array([start + length for start, length in spans])
    places = independent_places(first, last)
    for (_, end), (start, _) in pairwise(places):
        assert end < start
    for a, b in zip(first, last, strict=True):
        assert any(a <= end <= b for _, end in places)
