from math import atan2, cos, hypot, isfinite, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.boundary_following import (
    BoundaryFollowing,
    BoundaryFollowingParams,
    Course,
    boundary_following_response,
    boundary_side,
    clear_way,
)
from behaviours.corridor import clear_way_m
from behaviours.near_echoes import Near
from blackboard.errors import MissionError
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Response

PARAMS = BoundaryFollowingParams()
RADIUS_M = 0.3
echoes = st.lists(st.tuples(st.floats(0.05, 1.6), st.floats(-3.1, 3.1)), max_size=15)


def near(range_m: float, bearing_rad: float) -> Near:
    return (range_m + RADIUS_M, bearing_rad, 0.1, 0.0, True)


def wall_ahead(range_m: float) -> list[Near]:
    """Return echoes of a wide wall across the way, `range_m` before the rim."""
    ahead_m = range_m + RADIUS_M
    return [(hypot(ahead_m, 0.1 * i), atan2(0.1 * i, ahead_m), 0.1, 0.0, True) for i in range(-12, 13)]


def answer(nears: list[Near], course: Course | None = None, heading_rad: float = 0.0) -> tuple[Course, Response | None]:
    return boundary_following_response(course or Course(), nears, heading_rad, RADIUS_M, 0.0, PARAMS)


def test_it_goes_on_forward_while_the_way_is_clear() -> None:
    _, response = answer([near(PARAMS.front_m + PARAMS.side_m + 0.01, 0.0)])
    assert response == Response(forward=1.0, left=0.0)


def test_in_the_open_it_is_silent() -> None:
    assert answer([])[1] is None
    assert answer([near(PARAMS.notice_m + 0.01, 0.0)])[1] is None


def test_a_boundary_is_let_go_later_than_it_is_noticed() -> None:
    barely = [near(PARAMS.notice_m + 0.05, 0.5)]
    assert answer(barely)[1] is None
    assert answer(barely, Course(following=True))[1] is not None


def test_before_a_wall_it_turns_to_the_clear_way_nearest_to_forward() -> None:
    course, response = answer(wall_ahead(0.4))
    assert response is not None
    assert response.forward**2 + response.left**2 == pytest.approx(1.0)
    way_rad = course.way_rad
    assert way_rad is not None
    assert pi / 4 < abs(way_rad) <= pi / 2
    for step in range(1, round(abs(way_rad) / PARAMS.step_rad)):
        between_rad = step * PARAMS.step_rad
        assert clear_way_m(wall_ahead(0.4), between_rad, RADIUS_M + PARAMS.side_m, 2.0) < PARAMS.choose_m


def test_of_two_ways_it_takes_the_longer_one() -> None:
    nears = [*wall_ahead(0.4), near(0.92, 1.2)]
    way_rad = clear_way(nears, 0, RADIUS_M, PARAMS)
    assert way_rad is not None
    assert way_rad < 0
    assert clear_way(nears, 1, RADIUS_M, PARAMS) == pytest.approx(-way_rad)


def test_a_way_once_chosen_is_held_until_the_robot_looks_along_it() -> None:
    course, _ = answer(wall_ahead(0.4))
    way_rad = course.way_rad
    assert way_rad is not None
    halfway, response = answer(wall_ahead(0.6), course, heading_rad=0.5 * way_rad)
    assert halfway.way_rad == pytest.approx(way_rad)
    assert response is not None
    assert (response.forward, response.left) == (pytest.approx(cos(0.5 * way_rad)), pytest.approx(sin(0.5 * way_rad)))
    reached, response = answer([near(1.0, pi)], halfway, heading_rad=way_rad)
    assert reached.way_rad is None
    assert response == Response(forward=1.0, left=0.0)


def test_it_leans_towards_a_boundary_that_recedes() -> None:
    _, response = answer([near(1.2, pi / 2)])
    assert response is not None
    assert response.left == pytest.approx(sin(PARAMS.lean_rad))
    _, response = answer([near(PARAMS.keep_m - 0.1, pi / 3)])
    assert response == Response(forward=1.0, left=0.0)


def test_the_side_is_kept_while_there_is_a_boundary_on_it() -> None:
    both = [near(0.6, pi / 2), near(0.5, -pi / 2)]
    assert boundary_side(both, 2.0, 0) == -1
    assert boundary_side(both, 2.0, 1) == 1
    assert boundary_side([near(0.5, -pi / 2)], 2.0, 1) == -1
    assert boundary_side([near(0.5, 0.0)], 2.0, 0) == 0


def test_boxed_in_it_is_silent() -> None:
    assert answer([near(0.1, i * pi / 12) for i in range(24)])[1] is None


def test_after_long_following_it_rests_and_begins_anew() -> None:
    nears, course = [near(1.0, pi)], Course()
    silent = []
    for second in range(300):
        course, response = boundary_following_response(course, nears, 0.0, RADIUS_M, float(second), PARAMS)
        if response is None:
            silent.append(second)
    first, rest = int(PARAMS.follow_s), int(PARAMS.rest_s)
    assert silent[:rest] == list(range(first, first + rest))
    assert silent[rest] == first + rest + first


@given(echoes, st.floats(-3.0, 3.0))
def test_the_answer_is_a_direction_that_is_clear(points: list[tuple[float, float]], heading: float) -> None:
    _, response = answer([near(r, b) for r, b in points], heading_rad=heading)
    if response is not None:
        assert isfinite(response.forward)
        assert hypot(response.forward, response.left) == pytest.approx(1.0)


@given(st.lists(st.tuples(st.floats(0.05, 1.6), st.floats(0.3, 2.0)), min_size=1, max_size=8))
def test_a_mirrored_world_mirrors_the_answer(points: list[tuple[float, float]]) -> None:
    _, response = answer([near(r, b) for r, b in points])
    _, mirrored = answer([near(r, -b) for r, b in points])
    assert (response is None) == (mirrored is None)
    if response is not None and mirrored is not None:
        assert mirrored.forward == pytest.approx(response.forward, abs=1e-9)
        assert mirrored.left == pytest.approx(-response.left, abs=1e-9)


def test_through_the_board_it_turns_away_from_a_wall(bench) -> None:
    following = BoundaryFollowing(PARAMS, name="boundary_following")
    assert following.respond(bench.access) is None
    wall = {0: 0.4, 1: 0.46, 11: 0.46, 3: 3.0, 9: 3.0, 6: 4.0}
    bench.at(0.0).hear(wall)
    response = following.respond(bench.access)
    assert response is not None
    assert response.forward < 0.8
    bench.at(1.0, Pose(x_m=0.0, y_m=0.0, heading_rad=pi)).hear(dict.fromkeys(range(12)))
    following.respond(bench.access)
    bench.at(1.1, Pose(x_m=-3.0, y_m=0.0, heading_rad=pi)).hear(dict.fromkeys(range(12)))
    assert following.respond(bench.access) is None


def test_wrong_parameters_are_refused() -> None:
    with pytest.raises(MissionError, match="choose_m"):
        BoundaryFollowingParams(choose_m=2.0)
    with pytest.raises(MissionError, match=r"notice_m = 3\.0"):
        BoundaryFollowingParams(notice_m=3.0)


def test_selected_anew_it_begins_a_fresh_course_without_what_was_heard_long_ago(bench) -> None:
    following = BoundaryFollowing(PARAMS, name="boundary_following")
    for i in range(5):
        bench.at(0.2 * i).hear({0: 0.4, 1: 0.46, 11: 0.46, 3: 3.0, 9: 3.0, 6: 4.0})
        response = following.respond(bench.access)
    assert response is not None
    assert response.forward < 0.8
    following.select(())  # after it rested for ten seconds, in which the wall ahead went
    for i in range(5):
        bench.at(10.0 + 0.2 * i).hear({0: 5.0, 6: 0.8, 3: 3.0, 9: 3.0})
    assert following.respond(bench.access) == Response(forward=1.0, left=0.0)
