"""Passages: doorways are found where they are, gaps that the robot does not fit through and open floor are none."""

from math import cos, sin

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import affine_transform

from sim.passages import passages

RADIUS_M = 0.3
ROOMS = shapely.box(0, 0, 8, 4).difference(shapely.box(3.9, 0, 4.1, 1.5)).difference(shapely.box(3.9, 2.4, 4.1, 4))


def test_a_doorway_between_two_rooms_is_the_only_passage() -> None:
    (door,) = passages(ROOMS, RADIUS_M)
    assert door.middle == pytest.approx((4.0, 1.95), abs=0.11)
    assert door.width_m == pytest.approx(0.9, abs=1e-3)
    closed = ROOMS.difference(door.shape(0.05))
    assert len(closed.geoms) == 2


def test_what_the_robot_does_not_fit_through_is_no_passage() -> None:
    assert passages(ROOMS, 0.46) == []


def test_open_floor_and_a_post_in_it_have_none() -> None:
    room = shapely.box(0, 0, 6, 6)
    assert passages(room, RADIUS_M) == []
    assert passages(room.difference(shapely.Point(3, 3).buffer(0.1)), RADIUS_M) == []


def test_of_a_narrow_corridor_it_takes_one_each_metre() -> None:
    corridor = shapely.box(0, 0, 3, 3).union(shapely.box(2.9, 1, 7, 2)).union(shapely.box(6.9, 0, 10, 3))
    found = passages(corridor, RADIUS_M)
    assert 2 <= len(found) <= 4
    assert all(p.width_m == pytest.approx(1.0, abs=1e-3) for p in found)


@settings(max_examples=15)
@given(st.floats(-3.1, 3.1), st.floats(-20, 20), st.floats(-20, 20))
def test_a_turned_world_has_the_same_door(angle: float, x: float, y: float) -> None:
    c, s = cos(angle), sin(angle)
    turned = affine_transform(ROOMS, (c, -s, s, c, x, y))
    (door,) = passages(turned, RADIUS_M)
    middle = (x + c * 4.0 - s * 1.95, y + s * 4.0 + c * 1.95)
    assert door.middle == pytest.approx(middle, abs=0.13)
    assert door.width_m == pytest.approx(0.9, abs=0.02)
