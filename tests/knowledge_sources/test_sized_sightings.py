"""From directions and widths to place and size: exact sightings, any place in any direction, something that hides a part."""

from math import asin, atan2, cos, hypot, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.sized_sightings import Sighting, SightingErrors, estimate, placed

ERRORS = SightingErrors(edge_rad=0.006, heading_rad=0.026, pose_m=0.05)
RADIUS_M = 0.29


def seen(x: float, y: float, thing: tuple[float, float], radius_m: float = RADIUS_M, share: float = 1.0) -> Sighting:
    dx, dy = thing[0] - x, thing[1] - y
    return Sighting(x, y, atan2(dy, dx), share * 2 * asin(radius_m / hypot(dx, dy)))


def test_one_sighting_of_the_size_looked_for() -> None:
    sighting = Sighting(1.0, 2.0, pi / 2, pi / 3)  # half of it is 30 degrees: two radii away
    assert placed(sighting, 0.5) == pytest.approx((1.0, 3.0))
    one = estimate([sighting], 0.5, ERRORS)
    assert (one.x_m, one.y_m, one.radius_m) == pytest.approx((1.0, 3.0, 0.5), abs=1e-6)
    assert one.sigma_radius_m == pytest.approx(0.15, rel=0.05)  # as before: 30 % of it
    assert one.sigma_m > 0.25


@given(st.floats(-8, 8), st.floats(-8, 8), st.floats(-pi, pi), st.floats(0.6, 1.6))
def test_a_quarter_of_the_way_around_it_place_and_size_follow(x: float, y: float, around: float, factor: float) -> None:
    from_places = [
        seen(x + 1.9 * cos(around + a), y + 1.9 * sin(around + a), (x, y), factor * RADIUS_M)
        for a in (0.0, 0.3, 0.6, 0.9, 1.2, 1.5)
    ]
    found = estimate(from_places, RADIUS_M, ERRORS)
    assert hypot(found.x_m - x, found.y_m - y) < 0.05
    assert found.radius_m == pytest.approx(factor * RADIUS_M, rel=0.05)
    assert found.sigma_radius_m < 0.03
    assert found.sigma_m < 0.1


def test_the_drive_straight_up_to_it_tells_its_size_too() -> None:
    drum = [seen(x, 0.2, (5.0, 0.0)) for x in (1.5, 2.0, 2.5, 3.0, 3.5, 4.0)]
    bucket = [seen(x, 0.2, (5.0, 0.0), 0.14) for x in (3.0, 3.3, 3.6, 3.9, 4.2)]
    assert estimate(drum, RADIUS_M, ERRORS).radius_m == pytest.approx(RADIUS_M, rel=0.03)
    assert estimate(bucket, RADIUS_M, ERRORS).radius_m < 0.2


def test_one_sighting_hidden_in_part_does_not_spoil_the_others() -> None:
    good = [seen(2.0 * cos(a), 2.0 * sin(a), (0.0, 0.0)) for a in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)]
    hidden = seen(2.0 * cos(0.5), 2.0 * sin(0.5), (0.0, 0.0), share=0.5)
    found = estimate([*good, hidden], RADIUS_M, ERRORS)
    assert hypot(found.x_m, found.y_m) < 0.08
    assert found.radius_m == pytest.approx(RADIUS_M, rel=0.1)


def test_what_is_expected_from_a_place_is_what_is_seen_there() -> None:
    found = estimate([seen(0.0, 0.0, (2.0, 1.0)), seen(1.0, -1.0, (2.0, 1.0))], RADIUS_M, ERRORS)
    again = seen(0.5, 2.0, (2.0, 1.0))
    expected = found.expected(again, ERRORS)
    assert expected.away_m == pytest.approx(hypot(1.5, 1.0), abs=1e-3)
    assert expected.width_rad == pytest.approx(again.width_rad, abs=1e-3)
    assert expected.distance < 1e-3
    assert found.expected(seen(0.5, 2.0, (2.6, 0.0)), ERRORS).distance > 9.2
