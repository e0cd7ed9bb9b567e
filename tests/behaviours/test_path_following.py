"""Following a way: towards a point of it a little ahead, through narrow places, waiting where there is no getting on."""

from math import hypot, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.path_following import (
    NO_ROUTE,
    NO_WAY,
    PathFollowing,
    PathFollowingParams,
    along,
    least_room_m,
    left_of_way,
    length_m,
    point_ahead,
)
from blackboard.access import Access
from blackboard.board import Board
from blackboard.errors import MissionError
from blackboard.kinds import ODOM_FROM_ROBOT, ROUTE
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.motion import Response, Switch
from blackboard.messages.routes import Route, WayPoint
from blackboard.vocabulary import Vocabulary

PARAMS = PathFollowingParams()


def way(*points: tuple[float, float], room_m: float = 1.0) -> tuple[WayPoint, ...]:
    return tuple(WayPoint(x_m=x, y_m=y, room_m=room_m) for x, y in points)


CORNER = way((0.0, 0.0), (2.0, 0.0), (2.0, 2.0))


class Walk:
    """A board with a route, a robot on it, and path-following."""

    def __init__(self, route: tuple[WayPoint, ...] | None = CORNER) -> None:
        self.board = Board(Vocabulary())
        self.behaviour = PathFollowing(PARAMS, name="path_following")
        self.access = Access(self.board, "path_following", self.behaviour.reads, ())
        if route is not None:
            self.route(route)
        self.behaviour.select((2.0, 2.0))

    def route(self, points: tuple[WayPoint, ...], goal: tuple[float, float] = (2.0, 2.0)) -> None:
        place = Point(x_m=goal[0], y_m=goal[1])
        value = Route(goal=place, state="found" if points else "none", way=points, length_m=1.0)
        self.board.post(ROUTE, value, source="routes")

    def at(self, now_s: float, x_m: float, y_m: float, heading_rad: float = 0.0) -> Response | None:
        self.board.now_s = now_s
        self.board.post(ODOM_FROM_ROBOT, Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad), source="odometry")
        return self.behaviour.respond(self.access)


def test_what_is_left_of_a_way() -> None:
    left = left_of_way(CORNER, (1.5, 0.2))
    assert left.places == ((1.5, 0.0), (2.0, 0.0), (2.0, 2.0))
    assert length_m(left.places) == pytest.approx(2.5)
    assert point_ahead(left.places, 0.4) == pytest.approx((1.9, 0.0))
    assert point_ahead(left.places, 0.9) == pytest.approx((2.0, 0.4))
    assert point_ahead(left.places, 9.0) == (2.0, 2.0)
    assert left_of_way(CORNER, (2.5, 1.0)).places == ((2.0, 1.0), (2.0, 2.0))
    assert left_of_way(way((1.0, 1.0)), (0.0, 0.0)).places == ((1.0, 1.0),)


def test_the_room_on_the_next_piece_counts() -> None:
    points = (*way((0.0, 0.0), (1.0, 0.0)), *way((2.0, 0.0), room_m=0.1), *way((3.0, 0.0), (4.0, 0.0)))
    assert least_room_m(left_of_way(points, (0.5, 0.0)), 0.6) == 1.0
    assert least_room_m(left_of_way(points, (1.5, 0.0)), 0.6) == 0.1
    assert least_room_m(left_of_way(points, (2.5, 0.0)), 0.6) == 0.1
    assert least_room_m(left_of_way(points, (3.1, 0.0)), 0.6) == 1.0


def test_it_goes_towards_a_point_ahead_and_slower_near_the_end() -> None:
    walk = Walk()
    response = walk.at(0.0, 1.0, 0.0)
    assert response == Response(forward=pytest.approx(PARAMS.amplitude), left=pytest.approx(0.0))
    assert walk.behaviour.progress().remaining_m == pytest.approx(3.0)
    response = walk.at(1.0, 2.0, 0.5, pi / 2)
    assert response is not None
    assert (response.forward, response.left) == (pytest.approx(PARAMS.amplitude), pytest.approx(0.0, abs=1e-9))
    response = walk.at(2.0, 2.0, 1.65, pi / 2)
    assert response is not None
    assert response.forward == pytest.approx(PARAMS.amplitude * 0.35 / PARAMS.slow_m)
    assert walk.at(3.0, 2.0, 1.75) is None
    assert walk.behaviour.done()
    assert walk.behaviour.progress().outcome == "reached"
    walk.behaviour.select((2.0, 2.0))
    assert not walk.behaviour.done()


def test_it_waits_for_a_way_to_its_own_goal_and_says_so() -> None:
    walk = Walk(route=None)
    assert walk.at(0.0, 0.0, 0.0) is None
    walk.route(way((0.0, 0.0), (9.0, 9.0)), goal=(9.0, 9.0))  # an old one
    for second in range(200):
        assert walk.at(0.1 * second, 0.0, 0.0) is None
    assert walk.behaviour.progress().outcome == "underway"
    walk.at(20.1, 0.0, 0.0)
    progress = walk.behaviour.progress()
    assert (progress.outcome, progress.detail) == ("blocked", NO_ROUTE)
    walk.route(())
    assert walk.at(20.2, 0.0, 0.0) is None
    assert walk.behaviour.progress().detail == NO_WAY
    walk.route(CORNER)
    assert walk.at(20.3, 0.0, 0.0) is not None
    assert walk.behaviour.progress().outcome == "underway"


def test_it_is_blocked_when_it_does_not_get_on_and_another_way_is_not_progress() -> None:
    walk = Walk()
    for tenth in range(100):
        assert walk.at(0.1 * tenth, 0.5, 0.0) is not None
    walk.route(way((0.5, 0.0), (0.5, 4.0), (2.0, 2.0)))  # longer, since somebody stands in the way
    for tenth in range(100, 200):
        walk.at(0.1 * tenth, 0.5, 0.0)
    assert walk.behaviour.progress().outcome == "underway"
    walk.at(20.1, 0.5, 0.1)
    assert walk.behaviour.progress().outcome == "blocked"
    walk.at(20.2, 0.5, 0.6)
    assert walk.behaviour.progress().outcome == "underway"


def test_in_narrow_places_it_turns_avoid_obstacles_down() -> None:
    walk = Walk((*way((0.0, 0.0)), *way((1.0, 0.0), room_m=0.1), *way((2.0, 0.0), (2.0, 2.0))))
    walk.at(0.0, 0.1, 0.0)
    assert walk.behaviour.adjusts() == {}
    walk.at(1.0, 0.6, 0.0)
    assert walk.behaviour.adjusts() == {"avoid_obstacles": Switch(gain=PARAMS.narrow_gain)}
    walk.at(2.0, 2.0, 0.5)
    assert walk.behaviour.adjusts() == {}


@given(st.floats(-9, 9), st.floats(-9, 9), st.floats(-pi, pi), st.floats(0, 9))
def test_vectors_point_there_and_mirror(x: float, y: float, heading: float, remaining_m: float) -> None:
    response = along(Pose(x_m=0.0, y_m=0.0, heading_rad=heading), (x, y), remaining_m, PARAMS)
    assert hypot(response.forward, response.left) <= PARAMS.amplitude + 1e-9
    mirrored = along(Pose(x_m=0.0, y_m=0.0, heading_rad=-heading), (x, -y), remaining_m, PARAMS)
    if (x, y) != (0.0, 0.0):
        assert mirrored.forward == pytest.approx(response.forward, abs=1e-9)
        assert mirrored.left == pytest.approx(-response.left, abs=1e-9)


@given(
    st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=1, max_size=6), st.floats(-9, 9), st.floats(-9, 9)
)
def test_what_is_left_is_no_longer_than_the_way_and_ends_where_it_ends(
    points: list[tuple[float, float]], x: float, y: float
) -> None:
    left = left_of_way(way(*points), (x, y))
    assert left.places[-1] == points[-1]
    assert length_m(left.places) <= length_m(tuple(points)) + 1e-6
    nearest = hypot(left.places[0][0] - x, left.places[0][1] - y)
    assert all(nearest <= hypot(px - x, py - y) + 1e-6 for px, py in points)


def test_parameters() -> None:
    with pytest.raises(MissionError, match="path_following takes"):
        PathFollowing(PARAMS, name="path_following").select((1.0,))
    with pytest.raises(MissionError, match="narrow_gain"):
        PathFollowingParams(narrow_gain=2.0)
