"""Lines among places: known walls, thick ones, short ones, clutter, symmetries."""

from math import cos, hypot, pi, radians, sin

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.messages.geometry import pack_array
from blackboard.messages.world import Line, PointSet
from knowledge_sources.line_finder_params import LineFinderParams
from knowledge_sources.line_methods import find_lines
from knowledge_sources.place_directions import facing, local_normals
from knowledge_sources.place_search import as_places, windows

Floats = npt.NDArray[np.float64]
DIAMETER_M = 0.5
PLACES = LineFinderParams(
    method="places", max_spread_m=0.03, min_bent_spread_m=0.02, max_tilt_rad=radians(2.0)
)  # the mission's


def wall(x0: float, y0: float, x1: float, y1: float, thick_m: float = 0.04, seed: int = 0) -> Floats:
    """Return places a centimetre apart along a wall, strewn evenly over its thickness."""
    rng = np.random.default_rng(seed)
    length = hypot(x1 - x0, y1 - y0)
    along = np.arange(0.0, length, 0.01)
    across = rng.uniform(-thick_m / 2, thick_m / 2, len(along))
    c, s = (x1 - x0) / length, (y1 - y0) / length
    return np.stack([x0 + along * c - across * s, y0 + along * s + across * c], axis=1)


def found(points: Floats, gap_m: float = DIAMETER_M, params: LineFinderParams = PLACES) -> list[Line]:
    packed = pack_array(np.ascontiguousarray(points, dtype=np.float32).reshape(-1, 2))
    cones = pack_array(np.zeros(len(points), dtype=np.float32))
    return find_lines(PointSet(points=packed, sensed_from=packed, half_cone_rad=cones), gap_m, params)


def length_m(line: Line) -> float:
    return hypot(line.end.x_m - line.start.x_m, line.end.y_m - line.start.y_m)


def clutter(count: int, seed: int = 3) -> Floats:
    return np.random.default_rng(seed).uniform(-2.0, 2.0, (count, 2))


def test_a_long_wall_is_one_line_across_many_windows() -> None:
    (line,) = found(wall(-11.0, 3.0, 16.0, 3.0))
    assert line.start.x_m == pytest.approx(-11.0, abs=0.03)
    assert line.end.x_m == pytest.approx(16.0, abs=0.03)
    assert line.alpha_rad == pytest.approx(pi / 2, abs=radians(0.1))
    assert line.rho_m == pytest.approx(3.0, abs=0.01)
    assert line.support > 2600


def test_a_room_with_a_box_of_short_sides() -> None:
    room = [wall(0, 0, 6, 0), wall(6, 0, 6, 4), wall(6, 4, 0, 4), wall(0, 4, 0, 0)]
    box = [wall(2, 2, 2.6, 2), wall(2.6, 2, 2.6, 2.4), wall(2.6, 2.4, 2, 2.4), wall(2, 2.4, 2, 2)]
    lines = found(np.concatenate(room + box))
    assert len(lines) == 8
    assert sorted(length_m(line) for line in lines) == pytest.approx(
        [0.4, 0.4, 0.6, 0.6, 4.0, 4.0, 6.0, 6.0], abs=0.11
    )  # a corner's places are one wall's


def test_both_sides_of_a_wall_are_two_lines() -> None:
    lines = found(np.concatenate([wall(0, 0, 4, 0), wall(0, 0.15, 4, 0.15)]))
    assert sorted(round(line.rho_m, 2) for line in lines) == [0.0, 0.15]


def test_a_gap_that_the_robot_could_pass_ends_a_line() -> None:
    door = np.concatenate([wall(0, 1, 3, 1), wall(3.8, 1, 6, 1)])
    assert len(found(door)) == 2
    assert len(found(door, gap_m=1.0)) == 1


def test_a_scrap_beyond_a_gap_wider_than_itself_is_not_joined() -> None:
    (line,) = found(np.concatenate([wall(0, 1, 3, 1), wall(3.45, 1, 3.6, 1)]))
    assert max(line.start.x_m, line.end.x_m) == pytest.approx(3.0, abs=0.03)


def test_a_wall_in_clutter_is_found_and_clutter_is_hardly_ever_a_wall() -> None:
    """A hundred places a square metre; along the edge of such a field there is a line indeed."""
    inside = [line for line in found(clutter(1500)) if abs((line.start.x_m + line.end.x_m) / 2) < 1.8]
    assert sum(length_m(line) for line in inside) < 1.5
    best = found(np.concatenate([clutter(1500), wall(-1.5, 0.2, 1.5, 0.5)]))[0]
    assert length_m(best) == pytest.approx(3.0, abs=0.5)
    assert best.alpha_rad == pytest.approx(pi / 2 + np.arctan2(0.3, 3.0), abs=radians(1.0))


def test_a_wall_with_clutter_before_it_is_found() -> None:
    before = clutter(1200)
    lines = found(np.concatenate([before[before[:, 1] < 0.0], wall(-2, 0.05, 2, 0.05)]))
    assert max(length_m(line) for line in lines) > 3.8


def test_scattered_posts_in_a_row_are_no_wall() -> None:
    posts = [
        np.array([x, 0.0]) + np.random.default_rng(k).normal(0, 0.01, (12, 2)) for k, x in enumerate((0, 0.4, 0.8, 1.2))
    ]
    assert found(np.concatenate(posts)) == []


def test_a_drum_is_no_wall() -> None:
    turn = np.linspace(0, 2 * pi, 400)
    lines = found(np.stack([np.cos(turn), np.sin(turn)], axis=1) * 0.3)
    assert max((length_m(line) for line in lines), default=0.0) < 0.45  # a chord, its bow within the wall's breadth


@pytest.mark.parametrize("points", [[], [(1.0, 1.0)], [(1.0, 1.0), (2.0, 1.0)], [(1.0, 1.0)] * 50])
def test_too_little_for_a_line(points: list[tuple[float, float]]) -> None:
    assert found(np.array(points).reshape(-1, 2)) == []


@settings(max_examples=8)
@given(turn=st.floats(0.0, 6.3), x=st.floats(-50.0, 50.0), y=st.floats(-50.0, 50.0))
def test_it_does_not_matter_how_the_map_lies(turn: float, x: float, y: float) -> None:
    room = np.concatenate([wall(0, 0, 4, 0), wall(4, 0, 4, 3), wall(4, 3, 0, 3), wall(0, 3, 0, 0)])
    c, s = cos(turn), sin(turn)
    lines = found(room @ np.array([[c, s], [-s, c]]) + (x, y))
    lengths = sorted(length_m(line) for line in lines if length_m(line) > 0.5)
    assert lengths == pytest.approx([3.0, 3.0, 4.0, 4.0], abs=0.15)  # corners are one wall's


def test_the_order_of_the_points_does_not_matter() -> None:
    points = np.concatenate([wall(0, 0, 4, 1), wall(4, 1, 5, 4), clutter(300)])
    shuffled = np.random.default_rng(1).permutation(points)
    assert found(shuffled) == found(points)


def test_every_place_lies_in_one_window() -> None:
    places = as_places(clutter(500) * 7.0, PLACES)
    seen = np.concatenate(list(windows(places, 3.0)))
    assert np.array_equal(np.sort(seen), np.arange(500))
    for window in windows(places, 3.0):
        assert np.ptp(places.x_m[window]) <= 3.0
        assert np.ptp(places.y_m[window]) <= 3.0


@pytest.mark.parametrize("degrees", [0.0, 30.0, 89.0, 120.0])
def test_places_show_how_their_wall_faces(degrees: float) -> None:
    turn = radians(degrees)
    normal, slenderness = local_normals(wall(0, 0, 5 * cos(turn), 5 * sin(turn)), 0.15)
    off = np.abs((normal - turn - pi / 2 + pi / 2) % pi - pi / 2)
    inner = slice(30, -30)
    assert off[inner].max() < radians(12.0)
    assert slenderness[inner].max() < 0.4


def test_a_corner_and_a_lone_point_show_no_direction() -> None:
    corner = np.concatenate([wall(0, 0, 1, 0), wall(0, 0, 0, 1)])
    assert local_normals(corner, 0.15)[1][0] > 0.5
    assert local_normals(np.array([[3.0, 4.0]]), 0.15)[1].tolist() == [1.0]


def test_rows_of_cells_do_not_touch_each_other() -> None:
    """A place at the right edge has no neighbour at the left edge of the next row."""
    apart = np.array([[0.0, 0.06], [0.0, 0.01], [9.99, 0.01]])
    assert local_normals(apart, 0.15)[1][2] == 1.0


def test_walls_are_not_torn_where_the_circle_is_cut() -> None:
    walls = np.concatenate([np.full(100, 0.01), np.full(100, pi - 0.01), np.full(50, pi / 2)])
    directed = facing(walls)
    assert np.ptp(directed[:200]) < 0.03
    assert np.ptp(directed) < pi
