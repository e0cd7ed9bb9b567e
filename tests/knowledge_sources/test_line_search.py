"""From readings to lines: known walls, symmetries, and what must not become a line."""

from math import cos, hypot, pi, radians, sin

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.messages.geometry import pack_array
from blackboard.messages.world import Line, PointSet
from knowledge_sources.echoes import echoes_of, expected_ranges, in_order
from knowledge_sources.line_finder_params import LineFinderParams
from knowledge_sources.line_methods import find_lines
from knowledge_sources.line_search import lines_of_echoes

Floats = npt.NDArray[np.float64]
DIAMETER_M = 0.6
TANGENT, AXIS = LineFinderParams(), LineFinderParams(method="axis")

# (alpha in degrees, rho, from, to): the four walls of a room of 4 by 3 m about the origin
ROOM = ((0.0, 2.0, -1.5, 1.5), (90.0, 1.5, -2.0, 2.0), (180.0, 2.0, -1.5, 1.5), (270.0, 1.5, -2.0, 2.0))


def batch(points: npt.ArrayLike, sensed_from: npt.ArrayLike, half_cone_rad: npt.ArrayLike = 0.0) -> PointSet:
    there = np.array(points, dtype=np.float32).reshape(-1, 2)
    here = np.broadcast_to(np.array(sensed_from, dtype=np.float32), there.shape).copy()
    cones = np.broadcast_to(np.array(half_cone_rad, dtype=np.float32), (len(there),)).copy()
    return PointSet(points=pack_array(there), sensed_from=pack_array(here), half_cone_rad=pack_array(cones))


def along(alpha_deg: float, rho_m: float, start_m: float, end_m: float, count: int = 60) -> Floats:
    alpha, t = radians(alpha_deg), np.linspace(start_m, end_m, count)
    return np.stack([rho_m * cos(alpha) - t * sin(alpha), rho_m * sin(alpha) + t * cos(alpha)], axis=1)


def sonar_batch(
    walls: tuple[tuple[float, float, float, float], ...],
    noise_m: float = 0.01,
    turn_rad: float = 0.0,
    shift_m: tuple[float, float] = (0.0, 0.0),
) -> PointSet:
    """Return what a ring of twelve cones hears of walls about the origin on a way through their middle, turned and shifted."""
    rng = np.random.default_rng(7)
    here, bearing = [], []
    for step in range(45):
        x, y = -0.8 + 1.6 * step / 44, 0.4 * sin(step / 7.0)
        for sonar in range(12):
            here.append((x, y))
            bearing.append(0.05 * step + sonar * pi / 6)
    places, axis = np.array(here), np.array(bearing)
    ahead = np.stack([np.cos(axis), np.sin(axis)], axis=1)
    cones = np.full(len(axis), radians(6.0))
    echoes = in_order(places, places + ahead, cones, radians(30.0), radians(80.0))
    heard = [expected_ranges(echoes, radians(a), r, np.array([s]), np.array([e])) for a, r, s, e in walls]
    ranges = np.min(heard, axis=0) + noise_m * rng.standard_normal(len(axis))
    there = np.isfinite(ranges)
    x, y = echoes.x_m[there], echoes.y_m[there]
    far_x = x + ranges[there] * np.cos(echoes.bearing_rad[there])
    far_y = y + ranges[there] * np.sin(echoes.bearing_rad[there])

    def moved(x: Floats, y: Floats) -> Floats:
        c, s = cos(turn_rad), sin(turn_rad)
        return np.stack([c * x - s * y + shift_m[0], s * x + c * y + shift_m[1]], axis=1)

    return batch(moved(far_x, far_y), moved(x, y), radians(6.0))


def carriers(lines: list[Line]) -> list[tuple[float, float]]:
    return sorted((round(float(np.degrees(line.alpha_rad)) % 360.0, 6), line.rho_m) for line in lines)


def length(line: Line) -> float:
    return hypot(line.end.x_m - line.start.x_m, line.end.y_m - line.start.y_m)


@pytest.mark.parametrize("params", [TANGENT, AXIS])
def test_three_walls_of_points(params: LineFinderParams) -> None:
    walls = [along(0.0, 2.0, -1.0, 1.0), along(120.0, 1.52, -1.0, 1.0), along(230.0, 3.02, -1.2, 1.2)]
    lines = find_lines(batch(np.concatenate(walls), (0.0, 0.0)), DIAMETER_M, params)
    found = carriers(lines)
    near = [
        min(found, key=lambda f: abs((f[0] - a + 180.0) % 360.0 - 180.0) + abs(f[1] - r))
        for a, r in ((0, 2), (120, 1.52), (230, 3.02))
    ]
    for (alpha, rho), (a, r) in zip(near, ((0, 2.0), (120, 1.52), (230, 3.02)), strict=True):
        assert abs((alpha - a + 180.0) % 360.0 - 180.0) < 1.1
        assert rho == pytest.approx(r, abs=0.03)
    if params.method == "tangent":
        assert len(lines) == 3


@pytest.mark.parametrize("params", [TANGENT, AXIS])
def test_a_wall_through_the_map_s_origin(params: LineFinderParams) -> None:
    # Seen from where the robot is, far from the map's origin; the transform's own origin is there.
    lines = find_lines(batch(along(30.0, 0.0, -1.0, 1.0), (-2.0, -1.0)), DIAMETER_M, params)
    best = max(lines, key=lambda line: line.support)
    assert best.rho_m < 0.03
    assert (np.degrees(best.alpha_rad) % 180.0) == pytest.approx(30.0, abs=1.1)
    assert length(best) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("params", [TANGENT, AXIS])
@pytest.mark.parametrize(("gap_m", "pieces"), [(0.45, 1), (0.75, 2)])
def test_a_door_wider_than_the_robot_breaks_a_wall(params: LineFinderParams, gap_m: float, pieces: int) -> None:
    wall = np.concatenate([along(90.0, 2.0, -1.5, -gap_m / 2), along(90.0, 2.0, gap_m / 2, 1.5)])
    lines = find_lines(batch(wall, (0.0, 0.0)), DIAMETER_M, params)
    level = [line for line in lines if abs(line.alpha_rad - pi / 2) < radians(1.0) and abs(line.rho_m - 2.0) < 0.03]
    assert len(level) == pieces
    assert sum(length(line) for line in level) == pytest.approx(3.0 - (pieces - 1) * gap_m, abs=0.05)


def test_a_ring_of_sonars_finds_the_walls_of_a_room() -> None:
    lines = find_lines(sonar_batch(ROOM), DIAMETER_M, TANGENT)
    for a, r, start, end in ROOM:
        mine = [line for line in lines if abs((np.degrees(line.alpha_rad) - a + 180.0) % 360.0 - 180.0) < 1.5]
        assert mine, f"no line for the wall at {a} degrees"
        assert all(abs(line.rho_m - r) < 0.015 for line in mine)
        assert sum(length(line) for line in mine) > 0.5 * (end - start)
        for line in mine:
            for point in (line.start, line.end):
                t = point.y_m * cos(radians(a)) - point.x_m * sin(radians(a))
                assert start - 0.03 <= t <= end + 0.03
    assert len(lines) == 4


def test_points_on_the_axes_are_biased_and_tangents_are_not() -> None:
    # Most echoes come in by an edge of the cone, so a point on the axis lies short of the wall or beside it.
    def worst_rho(params: LineFinderParams) -> float:
        lines = find_lines(sonar_batch(ROOM), DIAMETER_M, params)
        return max(min(abs(line.rho_m - r) for r in (1.5, 2.0)) for line in lines)

    assert worst_rho(TANGENT) < 0.015 < worst_rho(AXIS)


def test_a_corner_heard_from_all_over_is_no_line() -> None:
    rng = np.random.default_rng(2)
    here = rng.uniform(-1.0, 1.0, (300, 2))
    away = np.array([2.0, 1.0]) - here
    range_m = np.hypot(away[:, 0], away[:, 1]) + 0.01 * rng.standard_normal(300)
    bearing = np.arctan2(away[:, 1], away[:, 0]) + rng.uniform(-0.1, 0.1, 300)
    there = here + range_m[:, None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    assert find_lines(batch(there, here, radians(6.0)), DIAMETER_M, TANGENT) == []


def test_scattered_points_are_no_lines() -> None:
    rng = np.random.default_rng(5)
    there = rng.uniform(-3.0, 3.0, (500, 2))
    assert find_lines(batch(there, rng.uniform(-0.5, 0.5, (500, 2)), radians(6.0)), DIAMETER_M, TANGENT) == []


def test_a_line_that_beams_pass_through_is_refused() -> None:
    wall = along(90.0, 2.0, -1.0, 1.0)
    behind = along(90.0, 3.0, -1.2, 1.2)
    lines = find_lines(batch(np.concatenate([wall, behind]), (0.0, 0.0)), DIAMETER_M, TANGENT)
    assert [round(line.rho_m, 3) for line in lines] == [3.0]


def test_both_sides_of_a_thin_wall_are_two_lines() -> None:
    near, far = along(90.0, 1.0, -1.0, 1.0), along(90.0, 1.04, -1.0, 1.0)
    here = np.concatenate([np.tile([[0.0, 0.0]], (60, 1)), np.tile([[0.0, 2.0]], (60, 1))])
    lines = find_lines(batch(np.concatenate([near, far]), here), DIAMETER_M, TANGENT)
    assert sorted(round(line.rho_m, 3) for line in lines) == [1.0, 1.04]


def test_a_step_of_the_wall_breaks_the_line() -> None:
    wall = np.concatenate([along(90.0, 2.0, -1.2, 0.0), along(90.0, 2.06, 0.02, 1.2)])
    lines = find_lines(batch(wall, (0.0, 0.0)), DIAMETER_M, TANGENT)
    assert sorted(round(line.rho_m, 2) for line in lines) == [2.0, 2.06]


def test_an_echo_supports_one_line_only() -> None:
    echoes = echoes_of(sonar_batch(ROOM), TANGENT.max_incidence_rad, TANGENT.max_beam_incidence_rad)
    members = [piece.members for piece in lines_of_echoes(echoes, DIAMETER_M, TANGENT)]
    assert len(np.unique(np.concatenate(members))) == sum(map(len, members))


@pytest.mark.parametrize("params", [TANGENT, AXIS])
def test_nothing_gives_nothing(params: LineFinderParams) -> None:
    assert find_lines(batch([], (0.0, 0.0)), DIAMETER_M, params) == []
    assert find_lines(batch([(1.0, 1.0)], (0.0, 0.0)), DIAMETER_M, params) == []


@pytest.mark.parametrize("params", [TANGENT, AXIS])
def test_readings_of_no_range_and_equal_ones_do_no_harm(params: LineFinderParams) -> None:
    assert find_lines(batch([(1.0, 1.0)] * 40, (1.0, 1.0), 0.1), DIAMETER_M, params) == []
    for line in find_lines(batch([(2.0, 1.0)] * 40, (1.0, 1.0), 0.1), DIAMETER_M, params):
        assert length(line) >= params.min_length_m


@settings(max_examples=12, deadline=None)
@given(st.floats(-pi, pi), st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
def test_lines_turn_and_shift_with_the_world(turn: float, x_m: float, y_m: float) -> None:
    for line in find_lines(sonar_batch(ROOM, 0.003, turn, (x_m, y_m)), DIAMETER_M, TANGENT):
        # Back in the room's own frame each end lies on one of its walls.
        c, s = cos(turn), sin(turn)
        ends = [
            (c * (p.x_m - x_m) + s * (p.y_m - y_m), -s * (p.x_m - x_m) + c * (p.y_m - y_m))
            for p in (line.start, line.end)
        ]
        off = [max(abs(x * cos(radians(a)) + y * sin(radians(a)) - r) for x, y in ends) for a, r, _, _ in ROOM]
        assert min(off) < 0.03
        assert line.start.x_m * cos(line.alpha_rad) + line.start.y_m * sin(line.alpha_rad) == pytest.approx(line.rho_m)
        assert line.end.x_m * cos(line.alpha_rad) + line.end.y_m * sin(line.alpha_rad) == pytest.approx(line.rho_m)
    assert len(find_lines(sonar_batch(ROOM, 0.003, turn, (x_m, y_m)), DIAMETER_M, TANGENT)) == 4


@settings(max_examples=10, deadline=None)
@given(st.randoms(use_true_random=False), st.sampled_from([TANGENT, AXIS]))
def test_the_order_of_the_points_does_not_matter(random: object, params: LineFinderParams) -> None:
    points = sonar_batch(ROOM)
    order = np.arange(points.points.shape[0])
    random.shuffle(order)  # type: ignore[attr-defined]
    shuffled = batch(
        points.points.unpack()[order], points.sensed_from.unpack()[order], points.half_cone_rad.unpack()[order]
    )
    assert find_lines(shuffled, DIAMETER_M, params) == find_lines(points, DIAMETER_M, params)


def test_readings_twice_give_the_same_lines_with_twice_the_support() -> None:
    points = sonar_batch(ROOM, 0.003)
    twice = [np.concatenate([a.unpack()] * 2) for a in (points.points, points.sensed_from, points.half_cone_rad)]
    once, doubled = find_lines(points, DIAMETER_M, TANGENT), find_lines(batch(*twice), DIAMETER_M, TANGENT)
    assert len(once) == len(doubled) == 4
    for one, other in zip(
        sorted(once, key=lambda n: n.alpha_rad), sorted(doubled, key=lambda n: n.alpha_rad), strict=True
    ):
        assert (other.alpha_rad, other.rho_m) == pytest.approx((one.alpha_rad, one.rho_m), abs=0.01)
        assert other.support == pytest.approx(2 * one.support, rel=0.1)


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.tuples(*[st.floats(-4, 4, width=32)] * 4), max_size=60),
    st.floats(0.0, 0.5),
    st.sampled_from(
        [TANGENT, AXIS, LineFinderParams(min_support=3, min_votes=2, min_places=1, max_tilt_rad=1.0, max_spread_m=1.0)]
    ),
)
def test_whatever_comes_lines_are_lines(
    rows: list[tuple[float, ...]], half_cone: float, params: LineFinderParams
) -> None:
    numbers = np.array(rows).reshape(-1, 4)
    for line in find_lines(batch(numbers[:, :2], numbers[:, 2:], half_cone), DIAMETER_M, params):
        assert np.isfinite([line.alpha_rad, line.rho_m, line.sigma_rho_m, *line.extent()]).all()
        assert -pi < line.alpha_rad <= pi
        assert line.rho_m >= 0.0
        assert length(line) >= params.min_length_m - 1e-9
        assert line.support >= params.min_support
