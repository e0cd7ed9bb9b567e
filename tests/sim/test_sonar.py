"""Echoes of cones: hand-worked geometry of walls, corners, edges and legs; noise, missed echoes, cross-talk."""

from dataclasses import replace
from math import cos, pi, radians, sin

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import rotate

from sim.raycast import Fans
from sim.sensor_models import SonarModel
from sim.shapes import Shapes, shapes_around
from sim.sonar import fire, sonar_fans, true_echoes

CRITICAL = radians(30.0)
CONE = radians(12.0)
MODEL = SonarModel(cone_rad=CONE, max_range_m=10.0, bearings_deg=(0.0,))


def world(
    free: shapely.Geometry, circles: list[tuple[float, float, float]] | None = None, rough: bool = False
) -> Shapes:
    rows = np.array(circles or [], dtype=float).reshape(-1, 3)
    things = free.boundary.buffer(1e-6) if rough else shapely.Polygon()
    return shapes_around(free, things, rows, np.zeros(len(rows), dtype=bool))


def cone(x: float, y: float, heading: float) -> Fans:
    return sonar_fans(MODEL).moved(x, y, heading)


def echo(x: float, y: float, heading: float, shapes: Shapes, critical: float = CRITICAL) -> float:
    model = replace(MODEL, critical_incidence_rad=critical)
    return float(true_echoes(cone(x, y, heading), shapes, model)[0][0])


HALL = shapely.box(-50, -50, 4, 50)  # one wall that matters: x = 4


def test_a_perpendicular_wall_is_heard_at_its_distance() -> None:
    assert echo(0.0, 0.0, 0.0, world(HALL)) == pytest.approx(4.0, abs=1e-12)


def test_a_slanted_wall_is_heard_at_the_nearer_edge_of_the_cone() -> None:
    turned = radians(20.0)  # rays from 14 to 26 degrees off the perpendicular
    assert echo(0.0, 0.0, turned, world(HALL)) == pytest.approx(4.0 / cos(radians(14.0)))


def test_a_wall_within_half_the_cone_is_heard_at_its_perpendicular() -> None:
    assert echo(0.0, 0.0, radians(5.0), world(HALL)) == pytest.approx(4.0, abs=1e-3)


def test_a_wall_at_45_degrees_throws_the_sound_away_but_a_rough_one_does_not() -> None:
    heading = radians(45.0)
    assert echo(0.0, 0.0, heading, world(HALL)) == float("inf")
    nearest = float(true_echoes(cone(0.0, 0.0, heading), world(HALL), MODEL)[1][0])
    assert nearest == pytest.approx(4.0 / cos(radians(39.0)))  # it is there, though
    assert echo(0.0, 0.0, heading, world(HALL, rough=True)) == pytest.approx(4.0 / cos(radians(39.0)))


def test_a_rough_wall_has_its_own_critical_angle() -> None:
    for degrees, heard in ((65.9, True), (66.1, False)):
        assert np.isfinite(echo(0.0, 0.0, radians(degrees), world(HALL, rough=True))) == heard


def test_the_critical_angle_is_where_it_says() -> None:
    for degrees, heard in ((35.9, True), (36.1, False)):  # the inner edge of the cone lies 6 degrees further in
        assert np.isfinite(echo(0.0, 0.0, radians(degrees), world(HALL))) == heard


def test_a_corner_of_the_room_is_heard_though_both_its_walls_throw_the_sound_away() -> None:
    room = world(shapely.box(-50, -50, 3, 3))
    assert echo(0.0, 0.0, pi / 4, room) == pytest.approx(18**0.5)


def test_a_corner_is_heard_between_two_rays() -> None:
    room = world(shapely.box(-50, -50, 3, 3))
    assert echo(0.0, 0.0, pi / 4 + radians(0.37), room) == pytest.approx(18**0.5)
    assert echo(0.0, 0.0, pi / 4 + radians(7.0), room) == float("inf")


def test_a_cabinets_edge_is_heard() -> None:
    cabinet = rotate(shapely.box(3, -1, 5, 1), 45, origin=(3, -1))  # its corner (3, -1) points at the sonar
    free = shapely.box(-50, -50, 50, 50).difference(cabinet)
    assert echo(0.0, -1.0, 0.0, world(free)) == pytest.approx(3.0, abs=1e-6)


def test_a_thin_leg_between_two_rays_is_heard_and_hides_nothing() -> None:
    shapes = world(HALL, [(2.0, 2.0 * np.tan(radians(0.5)), 0.015)])
    distance = 2.0 / cos(radians(0.5)) - 0.015
    assert echo(0.0, 0.0, 0.0, shapes) == pytest.approx(distance)
    assert echo(0.0, 0.0, radians(-10.0), shapes) == pytest.approx(4.0 / cos(radians(4.0)))


def test_a_leg_at_the_edge_of_the_cone() -> None:
    for degrees, inside in ((5.9, True), (6.5, False)):
        shapes = world(HALL, [(2.0 * cos(radians(degrees)), 2.0 * sin(radians(degrees)), 0.015)])
        assert (echo(0.0, 0.0, 0.0, shapes) < 3.0) == inside


def test_what_stands_behind_a_smooth_slanted_board_is_hidden() -> None:
    board = shapely.Polygon([(1, -2), (3, 2), (3.05, 2), (1.05, -2), (1, -2)])  # 26 degrees from the axis: lost
    shapes = world(HALL.difference(board), [(3.0, 0.0, 0.1)])
    assert echo(0.0, 0.0, 0.0, shapes, radians(20.0)) == float("inf")


def test_nothing_is_told_beyond_the_range() -> None:
    model = SonarModel(cone_rad=CONE, max_range_m=3.9, bearings_deg=(0.0,), missed_fraction=0.0, noise_m=0.0)
    given = fire(np.array([4.0]), np.array([4.0]), model, np.random.default_rng(0))
    assert given.ranges_m[0] == float("inf")
    assert not given.lost[0]


def test_noise_misses_and_cross_talk_have_their_shares() -> None:
    model = SonarModel(
        cone_rad=CONE,
        max_range_m=10.0,
        bearings_deg=tuple(float(i) for i in range(200)),
        missed_fraction=0.1,
        cross_talk_fraction=0.2,
        noise_m=0.02,
        noise_fraction=0.0,
    )
    rng = np.random.default_rng(1)
    echoes = np.full(200, 5.0)
    firings = [fire(echoes, echoes, model, rng) for _ in range(100)]
    ranges = np.array([f.ranges_m for f in firings])
    crossed = np.array([f.cross_talk for f in firings])
    lost = np.array([f.lost for f in firings])
    assert lost.mean() == pytest.approx(0.1, abs=0.01)
    assert crossed.mean() == pytest.approx(0.2, abs=0.02)
    assert (ranges[crossed] < 5.05).all()
    assert ranges[crossed].min() >= 1.5
    plain = ranges[~crossed & ~lost]
    assert plain.mean() == pytest.approx(5.0, abs=0.001)
    assert plain.std() == pytest.approx(0.02, rel=0.05)
    assert np.isinf(ranges[lost & ~crossed]).all()


@given(x=st.floats(0.2, 7.8), y=st.floats(0.2, 4.8), heading=st.floats(-pi, pi), turn=st.floats(-pi, pi))
def test_turning_the_world_turns_no_echo(x: float, y: float, heading: float, turn: float) -> None:
    free = shapely.box(0, 0, 8, 5)
    turned = rotate(free, turn, origin=(0, 0), use_radians=True)
    before = echo(x, y, heading, world(free))
    after = echo(cos(turn) * x - sin(turn) * y, sin(turn) * x + cos(turn) * y, heading + turn, world(turned))
    # At the very critical angle or cone's edge rounding decides: compare only where a hair's turn changes nothing.
    if echo(x, y, heading + 1e-6, world(free)) == pytest.approx(echo(x, y, heading - 1e-6, world(free)), abs=1e-3):
        assert after == pytest.approx(before, abs=1e-3)


@given(x=st.floats(0.2, 7.8), y=st.floats(0.2, 4.8), heading=st.floats(-pi, pi), critical=st.floats(0.1, 1.5))
def test_no_echo_is_nearer_than_the_nearest_thing(x: float, y: float, heading: float, critical: float) -> None:
    free = shapely.box(0, 0, 8, 5)
    heard = echo(x, y, heading, world(free), critical)
    assert heard >= free.boundary.distance(shapely.Point(x, y)) - 1e-9
    assert heard <= 9.5 or heard == float("inf")
