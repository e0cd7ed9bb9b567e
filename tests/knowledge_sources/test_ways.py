"""Ways on hand-made grids: through what is wide enough, never through what is not known, and no longer than they must be."""

from math import hypot

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import MissionError
from blackboard.grid import Grid, KnownPart
from blackboard.parameters import parse_parameters
from knowledge_sources.room_to_move import room_to_move, squared_distances
from knowledge_sources.ways import Way, nearest_on, straight_cost, wavefront, way_to, with_room
from knowledge_sources.ways_params import WaysParams

CELL_M, RADIUS_M = 0.05, 0.3
PARAMS = WaysParams()


class Plan:
    """An empty room from (0, 0) behind walls two cells thick, and what is put into it; the unknown lies around."""

    def __init__(self, width_m: float, height_m: float) -> None:
        self.grid = Grid(CELL_M)
        self.grid.cover(-0.3, -0.3, width_m + 0.3, height_m + 0.3)
        self.fill(-0.1, -0.1, width_m + 0.1, height_m + 0.1, 255)
        self.fill(0.0, 0.0, width_m, height_m, 0)

    def fill(self, x0: float, y0: float, x1: float, y1: float, value: int) -> "Plan":
        columns = [round((x - self.grid.x_min_m) / CELL_M) for x in (x0, x1)]
        rows = [round((y - self.grid.y_min_m) / CELL_M) for y in (y0, y1)]
        self.grid.cells[rows[0] : rows[1], columns[0] : columns[1]] = value
        return self

    def known(self) -> KnownPart:
        known = self.grid.known_part()
        assert known is not None
        return known

    def way(self, start: tuple[float, float], goal: tuple[float, float], params: WaysParams = PARAMS) -> Way | None:
        return way_to(wavefront(self.known(), RADIUS_M, start, params), goal, params.goal_reach_m)


def test_distances_are_those_of_the_nearest_thing_up_to_the_reach() -> None:
    things = np.zeros((9, 12), np.bool_)
    things[4, 3] = things[0, 11] = True
    squares = squared_distances(things, 3)
    assert squares[4, 3] == 0
    assert (squares[4, 5], squares[6, 5], squares[1, 3]) == (4, 8, 9)
    assert squares[8, 11] == 16  # further than 3
    assert squares[7, 6] == 16
    assert squares[3, 11] == 9


@given(st.lists(st.lists(st.booleans(), min_size=8, max_size=8), min_size=1, max_size=8), st.integers(1, 9))
def test_distances_are_exact_within_the_reach(rows: list[list[bool]], reach: int) -> None:
    things = np.array(rows)
    squares = squared_distances(things, reach)
    at = np.argwhere(things)
    for r, c in np.ndindex(things.shape):
        nearest = min((int((r - y) ** 2 + (c - x) ** 2) for y, x in at), default=10**6)
        assert squares[r, c] == (nearest if nearest <= reach * reach else squares[r, c])
        assert min(nearest, reach * reach + 1) <= squares[r, c] <= (reach + 1) ** 2 or nearest == squares[r, c]


def test_the_way_across_an_empty_room_is_the_straight_line() -> None:
    way = Plan(6.0, 4.0).way((1.0, 1.0), (5.0, 3.0))
    assert way is not None
    assert way.corners.tolist() == [[1.0, 1.0], [5.0, 3.0]]
    assert way.length_m == pytest.approx(hypot(4.0, 2.0))


@pytest.mark.parametrize(("gap_m", "passable"), [(0.75, True), (0.65, True), (0.6, False), (0.5, False), (0.3, False)])
def test_a_gap_is_passed_where_the_robot_fits(gap_m: float, passable: bool) -> None:
    """Thirteen cells of 5 cm, so that one lies further than 0.3 m from both sides; twelve are too few."""
    plan = Plan(6.0, 4.0).fill(2.9, 0.0, 3.1, 4.0, 255).fill(2.9, 2.0, 3.1, 2.0 + gap_m, 0)
    way = plan.way((1.0, 1.0), (5.0, 1.0))
    assert (way is not None) == passable
    if way is not None:
        assert way.length_m < 2 * hypot(2.0, 1.0 + gap_m / 2) + 0.4


def test_a_way_leads_round_a_u_and_out_of_it() -> None:
    plan = Plan(6.0, 6.0)
    for box in ((2.0, 1.5, 4.1, 1.6), (2.0, 4.4, 4.1, 4.5), (4.0, 1.5, 4.1, 4.5)):
        plan.fill(*box, 255)
    way = plan.way((3.0, 3.0), (5.0, 3.0))
    assert way is not None
    assert way.length_m > 4.0
    assert (way.corners[:, 0] < 2.0).any()
    assert ((way.corners[:, 1] < 1.3) | (way.corners[:, 1] > 4.7)).any()


def test_what_is_not_known_is_no_way() -> None:
    plan = Plan(6.0, 2.0).fill(2.8, 0.0, 3.2, 2.0, 128)
    assert plan.way((1.0, 1.0), (5.0, 1.0)) is None
    plan = Plan(6.0, 2.0).fill(2.8, 0.0, 3.2, 0.6, 128)
    way = plan.way((1.0, 0.5), (5.0, 0.5))
    assert way is not None
    assert way.corners[:, 1].max() > 0.8


def test_a_strip_beside_the_way_that_nobody_knows_does_not_close_a_door() -> None:
    plan = Plan(6.0, 4.0).fill(2.9, 0.0, 3.1, 4.0, 255).fill(2.9, 2.0, 3.1, 2.75, 0)
    plan.fill(2.9, 2.0, 3.1, 2.05, 128).fill(2.9, 2.7, 3.1, 2.75, 128)
    assert plan.way((1.0, 1.0), (5.0, 1.0)) is not None


def test_ways_keep_clear_where_there_is_room() -> None:
    plan = Plan(6.0, 4.0).fill(2.9, 0.0, 3.1, 2.0, 255)
    way = plan.way((1.0, 1.0), (5.0, 1.0))
    assert way is not None
    shortest_m = 2 * hypot(1.9, 1.3) + 0.2
    assert shortest_m < way.length_m < shortest_m + 0.8
    near = with_room(wavefront(plan.known(), RADIUS_M, (1.0, 1.0), PARAMS).room, way.corners, RADIUS_M, 0.25)
    assert near[:, 2].min() > 0.15  # the straightest way would touch the end of the wall


def test_a_robot_beside_a_wall_finds_its_way_out() -> None:
    plan = Plan(6.0, 4.0)
    way = plan.way((0.2, 2.0), (5.0, 2.0))
    assert way is not None
    assert way.corners[0].tolist() == [0.2, 2.0]
    assert plan.way((0.2, 2.0), (-1.0, 2.0)) is None
    thin = Plan(6.0, 4.0).fill(2.95, 0.0, 3.05, 4.0, 255)
    assert thin.way((2.8, 2.0), (5.0, 2.0)) is None  # not through the wall
    assert thin.way((2.8, 2.0), (1.0, 2.0)) is not None


def test_a_robot_stands_on_floor_that_it_could_not_see() -> None:
    plan = Plan(6.0, 4.0).fill(0.7, 1.7, 1.3, 2.3, 128)
    assert plan.way((1.0, 2.0), (5.0, 2.0)) is not None
    assert plan.way((3.0, 2.0), (1.0, 2.0)) is None  # seen from elsewhere it is not known


def test_a_goal_too_near_to_something_is_gone_near_to() -> None:
    plan = Plan(6.0, 4.0)
    way = plan.way((1.0, 1.0), (5.9, 2.0))
    assert way is not None
    assert 5.5 < way.corners[-1, 0] < 5.7
    assert plan.way((1.0, 1.0), (6.3, 2.0)) is None


def test_nowhere_is_reached_from_outside_or_from_within_a_wall() -> None:
    plan = Plan(6.0, 4.0)
    assert plan.way((-5.0, -5.0), (3.0, 2.0)) is None
    assert plan.way((40.0, 2.0), (3.0, 2.0)) is None


BOXES = st.lists(st.tuples(st.integers(0, 40), st.integers(0, 30), st.integers(1, 14), st.integers(1, 14)), max_size=6)


def furnished(boxes: list[tuple[int, int, int, int]], mirrored: bool = False) -> Plan:
    plan = Plan(6.0, 4.0)
    for column, row, width, height in boxes:
        x0, x1 = 1.0 + column * 0.1, min(1.0 + (column + width) * 0.1, 5.0)
        box = (6.0 - x1, 6.0 - x0) if mirrored else (x0, x1)
        plan.fill(box[0], row * 0.1, box[1], min((row + height) * 0.1, 4.0), 255)
    return plan


@given(BOXES, st.integers(5, 35), st.integers(5, 35))
def test_every_way_is_open_and_at_least_as_long_as_the_straight_line(
    boxes: list[tuple[int, int, int, int]], start: int, goal: int
) -> None:
    plan = furnished(boxes)
    here, there = (0.5, start * 0.1), (5.5, goal * 0.1)
    front = wavefront(plan.known(), RADIUS_M, here, PARAMS)
    away = np.hypot(*(front.places() - here).T)
    reached = np.isfinite(front.cost)
    assert (front.length_m[reached] >= away[reached] - 1e-9).all()
    assert (front.cost[reached] >= front.length_m[reached] - 0.11).all()  # a metre costs one at least
    way = way_to(front, there, 0.0)
    if way is None:
        return
    assert way.corners[0].tolist() == pytest.approx(here)
    assert way.length_m >= hypot(way.corners[-1, 0] - here[0], way.corners[-1, 1] - here[1]) - 1e-9
    room = room_to_move(plan.known(), RADIUS_M, here, PARAMS)
    points = np.concatenate(
        [a + np.linspace(0, 1, 200)[:, None] * (b - a) for a, b in zip(way.corners[:-1], way.corners[1:], strict=True)]
    )
    assert not (plan.grid.values_at(points) != 0).any()
    for point in points:
        row, column = room.cell(*point)
        assert room.open[row - 1 : row + 2, column - 1 : column + 2].any()


@given(BOXES, st.integers(5, 35), st.integers(5, 35))
def test_mirrored_worlds_have_mirrored_lengths(boxes: list[tuple[int, int, int, int]], start: int, goal: int) -> None:
    one = furnished(boxes).way((0.525, start * 0.1 + 0.025), (5.525, goal * 0.1 + 0.025))
    other = furnished(boxes, mirrored=True).way((5.475, start * 0.1 + 0.025), (0.475, goal * 0.1 + 0.025))
    assert (one is None) == (other is None)
    if one is not None and other is not None:
        assert one.length_m == pytest.approx(other.length_m, rel=0.05, abs=0.1)


def test_what_is_left_of_a_way_begins_where_the_robot_is() -> None:
    corners = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
    away_m, left = nearest_on(corners, (1.0, 0.3))
    assert away_m == pytest.approx(0.3)
    assert left.tolist() == [[1.0, 0.0], [2.0, 0.0], [2.0, 2.0]]
    away_m, left = nearest_on(corners, (3.0, 3.0))
    assert away_m == pytest.approx(2**0.5)
    assert left.tolist() == [[2.0, 2.0], [2.0, 2.0]] or left.tolist() == [[2.0, 2.0]]


def test_a_straight_way_costs_its_length_in_the_open_and_more_beside_a_wall() -> None:
    room = room_to_move(Plan(6.0, 4.0).known(), RADIUS_M, (1.0, 1.0), PARAMS)
    assert straight_cost(room, np.array([1.0, 2.0]), np.array([5.0, 2.0])) == pytest.approx(4.0)
    assert straight_cost(room, np.array([1.0, 0.35]), np.array([5.0, 0.35])) > 12.0
    assert straight_cost(room, np.array([1.0, 2.0]), np.array([5.9, 2.0])) == np.inf


def test_parameters() -> None:
    for key, value in (("unknown_fraction", 1.5), ("block_m", 0.0), ("goal_reach_m", -1.0), ("near_cost", -1.0)):
        with pytest.raises(MissionError, match=key):
            parse_parameters(WaysParams, {key: value}, "m.toml")
