"""Rays against segments and circles: hand-worked hits, and every ray against shapely's own intersection."""

from math import cos, pi, sin

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from sim.raycast import Fans, cast, incidence_cosines
from sim.shapes import Neighbourhood, Shapes, shapes_around

NO_CIRCLES = np.zeros((0, 3))


def shapes(free: shapely.Geometry, circles: np.ndarray = NO_CIRCLES) -> Shapes:
    return shapes_around(free, shapely.Polygon(), circles, np.zeros(len(circles), dtype=bool))


def fan(x: float, y: float, first: float, span: float, rays: int) -> Fans:
    return Fans(np.array([x]), np.array([y]), np.array([first]), span / (rays - 1), rays)


ROOM = shapely.box(0, 0, 8, 5).difference(shapely.box(5, 1, 6, 2))


def test_ranges_in_a_room_with_a_box() -> None:
    hits = cast(fan(1.0, 1.5, -pi / 2, pi, 3), shapes(ROOM))
    assert hits.ranges_m[0].tolist() == pytest.approx([1.5, 4.0, 3.5])


def test_a_ray_into_a_corner_meets_it() -> None:
    hits = cast(fan(1.0, 1.0, pi, pi / 2, 3), shapes(shapely.box(0, 0, 8, 5)))
    assert hits.ranges_m[0].tolist() == pytest.approx([1.0, 2**0.5, 1.0])


def test_a_ray_along_the_side_of_a_box_goes_by_or_meets_its_end() -> None:
    for y in (1.0, 2.0):  # the sides of the box in the room
        hits = cast(fan(1.0, y, -pi / 8, pi / 4, 3), shapes(ROOM))
        assert hits.ranges_m[0, 1] in (pytest.approx(4.0), pytest.approx(7.0))
        assert not np.isnan(hits.ranges_m).any()


def test_a_circle_hides_the_wall_behind_it() -> None:
    circles = np.array([[4.0, 2.5, 0.5]])
    hits = cast(fan(1.0, 2.5, -0.1, 0.2, 3), shapes(shapely.box(0, 0, 8, 5), circles))
    assert hits.ranges_m[0, 1] == pytest.approx(2.5)
    assert hits.thing[0, 1] == 4  # the room has four segments
    edge = 3 * cos(0.1) - (0.25 - (3 * sin(0.1)) ** 2) ** 0.5
    assert hits.ranges_m[0, [0, 2]].tolist() == pytest.approx([edge, edge])


@pytest.mark.parametrize(
    ("first", "span", "ray"), [(0.05, 0.2, 0), (-0.25, 0.2, -1), (0.05, pi, 0), (-0.05 - pi, pi, -1)]
)
def test_a_circle_centred_beyond_the_first_or_last_ray_reaches_into_the_fan(
    first: float, span: float, ray: int
) -> None:
    hits = cast(fan(1.0, 2.5, first, span, 5), shapes(shapely.box(0, 0, 8, 5), np.array([[4.0, 2.5, 0.5]])))
    assert hits.ranges_m[0, ray] == pytest.approx(3 * cos(0.05) - (0.25 - (3 * sin(0.05)) ** 2) ** 0.5)


def test_incidence_of_a_wall_at_30_degrees_and_of_a_circle() -> None:
    room = shapes(shapely.box(0, 0, 8, 5), np.array([[1.0, 3.5, 0.5]]))
    fans = fan(1.0, 1.0, -pi / 2, pi, 7)  # every 30 degrees
    cosines = incidence_cosines(cast(fans, room), fans, room)[0]
    assert cosines[0] == pytest.approx(1.0)
    assert cosines[1] == pytest.approx(cos(pi / 6))
    assert cosines[6] == pytest.approx(1.0)


@given(
    x=st.floats(0.3, 7.7),
    y=st.floats(2.2, 4.8),
    first=st.floats(-7.0, 7.0),
    span=st.floats(0.05, pi),
    rays=st.integers(2, 60),
)
def test_every_ray_is_what_shapely_says(x: float, y: float, first: float, span: float, rays: int) -> None:
    circles = np.array([[2.0, 1.0, 0.4], [7.0, 1.2, 0.02]])
    hits = cast(fan(x, y, first, span, rays), shapes(ROOM, circles))
    step = span / (rays - 1)
    for i in range(rays):
        direction = np.array([cos(first + i * step), sin(first + i * step)])
        ray = shapely.LineString([(x, y), (x + 20 * direction[0], y + 20 * direction[1])])
        nearest = shapely.Point(x, y).distance(ROOM.boundary.intersection(ray))
        for cx, cy, radius in circles:
            to = np.array([cx - x, cy - y])
            along, off = float(to @ direction), float(np.cross([*direction, 0], [*to, 0])[2])
            if along > 0 and abs(off) < radius - 1e-6:
                nearest = min(nearest, along - (radius**2 - off**2) ** 0.5)
            elif along > 0 and abs(off) < radius + 1e-6:
                nearest = float("nan")  # a graze: either is right
        if nearest == nearest:
            assert hits.ranges_m[0, i] == pytest.approx(nearest, abs=1e-5)


@given(angle=st.floats(-pi, pi), x=st.floats(-50, 50), y=st.floats(-50, 50))
def test_turning_and_shifting_the_world_changes_no_range(angle: float, x: float, y: float) -> None:
    fans = fan(1.3, 3.1, -1.0, 2.5, 30)
    before = cast(fans, shapes(ROOM)).ranges_m
    moved = translate(rotate(ROOM, angle, origin=(0, 0), use_radians=True), x, y)
    after = cast(fans.moved(x, y, angle), shapes(moved)).ranges_m
    assert after == pytest.approx(before, abs=1e-9)


def test_only_what_is_near_is_kept_and_looked_up_anew_on_the_way() -> None:
    posts = np.array([[float(x), 1.0, 0.1] for x in range(40)])
    near = Neighbourhood(shapes(shapely.box(-1, -1, 41, 3), posts), 2.0)
    assert near.at(0.0, 0.0).circles.shape[1] < 6
    assert len(near.at(0.0, 0.0).segments.start) == 3  # the right wall is far
    assert near.at(0.5, 0.0) is near.at(0.0, 0.0)
    assert 30.0 in near.at(30.0, 0.0).circles[0].tolist()
