from math import asin, atan2, cos, hypot, pi, radians, sin

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from behaviours.near_echoes import Near
from behaviours.ways_along import along_wall, first_side, first_way, forbidden, mirrored, wall_beside

RADIUS_M, KEEP_M, SIDE_M, LOOK_M = 0.3, 0.6, 0.1, 0.6
echoes = st.lists(st.tuples(st.floats(0.35, 1.9), st.floats(-3.1, 3.1)), min_size=1, max_size=15)


def near(x_m: float, y_m: float, settled: bool = True) -> Near:
    return (hypot(x_m, y_m), atan2(y_m, x_m), 0.1, 0.0, settled)


def wall_to_the_left(away_m: float, from_m: float = -1.5, to_m: float = 1.5) -> list[Near]:
    """Return echoes of a wall parallel to the way, `away_m` from the robot's centre."""
    steps = round((to_m - from_m) / 0.1)
    return [near(from_m + 0.1 * i, away_m) for i in range(steps + 1)]


def way(nears: list[Near]) -> float | None:
    wall = wall_beside(nears, 1.4)
    assert wall is not None
    return along_wall(nears, wall, RADIUS_M, KEEP_M, SIDE_M, LOOK_M)


def test_at_its_distance_it_goes_along() -> None:
    assert way(wall_to_the_left(0.9)) == pytest.approx(0.0, abs=0.03)


def test_further_away_it_closes_in_until_a_step_on_it_has_its_distance() -> None:
    """After 0.6 m at this angle it is 0.9 m from the wall: sin(way) = (1.1 - 0.9) / 0.6."""
    assert way(wall_to_the_left(1.1)) == pytest.approx(asin(0.2 / 0.6), abs=0.06)


def test_too_near_it_turns_away_by_how_much_too_near_it_is() -> None:
    assert way(wall_to_the_left(0.8)) == pytest.approx(-2.0 * 0.1, abs=0.03)


def test_a_wall_ahead_turns_it_along_that_wall() -> None:
    inner = wall_to_the_left(0.9, to_m=0.9) + [near(0.9, 0.9 - 0.1 * i) for i in range(20)]
    assert way(inner) == pytest.approx(-pi / 2, abs=0.05)


def test_round_the_end_of_a_wall_it_goes_at_its_distance() -> None:
    """The end lies abeam, then a little behind: the way is square to it."""
    assert way(wall_to_the_left(0.9, to_m=0.0)) == pytest.approx(0.0, abs=0.03)
    behind = [near(0.9 * cos(radians(100)), 0.9 * sin(radians(100)))]
    assert way(behind) == pytest.approx(radians(10), abs=0.03)


def test_in_a_narrow_passage_it_goes_on_in_less_room() -> None:
    passage = wall_to_the_left(0.55) + [(d, -b, c, h, s) for d, b, c, h, s in wall_to_the_left(0.5)]
    found = way(passage)
    assert found is not None
    assert abs(found) < 0.1


def test_in_a_dead_end_it_turns_about_and_boxed_in_it_stays() -> None:
    end = wall_to_the_left(0.6, -1.5, 0.5) + [near(0.5, 0.1 * i) for i in range(-6, 7)]
    end += [near(-1.5 + 0.1 * i, -0.6) for i in range(21)]
    found = way(end)
    assert found is not None
    assert found < -0.75 * pi
    boxed = [near(0.38 * cos(radians(a)), 0.38 * sin(radians(a))) for a in range(-180, 180, 10)]
    assert way(boxed) is None


def test_what_was_heard_but_once_is_no_wall() -> None:
    once = near(0.5, 0.5, settled=False)
    assert wall_beside([once], 1.4) is None
    assert first_side([once], 1.4) == 0
    assert first_side([once, near(0.0, -1.0)], 1.4) == -1
    assert first_side([near(1.0, 0.0)], 1.4) == 1


def test_a_wall_beside_counts_before_one_ahead() -> None:
    ahead, beside = near(0.5, -0.1), near(0.0, 0.9)
    assert wall_beside([ahead, beside], 1.4) == beside
    assert wall_beside([ahead], 1.4) == ahead
    assert wall_beside([near(-0.9, 0.0)], 1.4) is None
    assert wall_beside([near(0.0, 1.5)], 1.4) is None


@given(echoes)
@example([(0.5, -3.0)])  # behind, and to the left of the first way tried
def test_the_way_keeps_its_distance_from_every_echo(points: list[tuple[float, float]]) -> None:
    """A disc that goes along the way touches nothing, or leaves what it is too near to already."""
    nears = [(r, b, 0.1, 0.0, True) for r, b in points]
    found = first_way(forbidden(nears, RADIUS_M + KEEP_M, RADIUS_M + SIDE_M, LOOK_M), 0.55 * pi, -pi)
    if found is None:
        return
    for distance, bearing in points:
        off = (bearing - found + pi) % (2 * pi) - pi
        width = RADIUS_M + (KEEP_M if off > 0 else SIDE_M)
        if abs(abs(off) - pi / 2) < 1e-6 or abs(off) < 1e-6:
            continue
        along = min(max(distance * cos(off), 0.0), LOOK_M)
        nearest = hypot(distance * cos(off) - along, distance * sin(off))
        assert nearest >= min(width, distance) - 1e-6


@given(echoes)
def test_mirroring_twice_changes_nothing(points: list[tuple[float, float]]) -> None:
    nears = [(r, b, 0.1, 0.0, True) for r, b in points]
    assert mirrored(mirrored(nears)) == nears
    if len([r for r, b in points if r == min(points)[0]]) == 1 and min(points)[1] != 0.0:
        assert first_side(mirrored(nears), 3.0) == -first_side(nears, 3.0)


def test_the_first_free_way_from_the_left() -> None:
    assert first_way([], 1.0, -1.0) == 1.0
    assert first_way([(0.5, 1.5)], 1.0, -1.0) == 0.5
    assert first_way([(0.5, 1.5), (-0.2, 0.6)], 1.0, -1.0) == -0.2
    assert first_way([(0.5, 1.5), (-0.2, 0.4)], 1.0, -1.0) == 0.5
    assert first_way([(-2.0, 1.5)], 1.0, -1.0) is None
