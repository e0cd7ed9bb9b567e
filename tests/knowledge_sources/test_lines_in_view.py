"""What should be in view: range, incidence, side, and what stands before it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.line_estimates import LineEstimate, from_ends
from knowledge_sources.lines_in_view import ViewLimits, lines_in_view

LIMITS = ViewLimits()


def wall(x0: float, y0: float, x1: float, y1: float, left: bool = False) -> LineEstimate:
    return from_ends((x0, y0), (x1, y1), np.eye(2) * 1e-4, left)


AHEAD = wall(-2.0, 2.0, 2.0, 2.0)  # sensed from below, which is its right


def test_a_wall_ahead_is_in_view_until_it_is_too_far() -> None:
    assert lines_in_view([AHEAD], 0.0, 0.0, LIMITS) == [0]
    assert lines_in_view([AHEAD], 0.0, -0.9, LIMITS) == [0]
    assert lines_in_view([AHEAD], 0.0, -1.1, LIMITS) == []


def test_not_from_its_other_side() -> None:
    assert lines_in_view([AHEAD], 0.0, 4.0, LIMITS) == []
    assert lines_in_view([AHEAD.flipped()], 0.0, 0.0, LIMITS) == [0]


def test_a_smooth_wall_answers_only_near_its_normal() -> None:
    # 2 m off, 30 degrees reach 1.15 m to either side of the foot: of a wall from 1 m on, 15 cm
    assert lines_in_view([wall(1.0, 2.0, 4.0, 2.0)], 0.0, 0.0, LIMITS) == []
    assert lines_in_view([wall(0.5, 2.0, 4.0, 2.0)], 0.0, 0.0, LIMITS) == [0]


def test_a_wall_before_it_hides_it() -> None:
    near = wall(-2.0, 1.0, 2.0, 1.0)
    assert lines_in_view([AHEAD, near], 0.0, 0.0, LIMITS) == [1]
    half = wall(-2.0, 1.0, 0.0, 1.0)
    assert lines_in_view([AHEAD, half], 0.0, 0.0, LIMITS) == [0, 1]
    assert lines_in_view([AHEAD], 0.0, 0.0, LIMITS, hiding=[near]) == []


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-10, 10), st.floats(-10, 10), st.floats(-3, 3))
def test_the_view_turns_with_the_world(x: float, y: float, dx: float, dy: float, turn: float) -> None:
    walls = [AHEAD, wall(-1.0, 1.0, 0.3, 1.1), wall(2.5, -2.0, 2.5, 2.0, True)]
    robot = from_ends((x, y), (x, y), np.eye(2), True).turned(0.0, 0.0, dx, dy, turn)
    moved = [w.turned(0.0, 0.0, dx, dy, turn) for w in walls]
    # points that lie on the edge of what is in view may fall to either side
    surely = lines_in_view(walls, x, y, ViewLimits(least_m=0.8))
    perhaps = lines_in_view(walls, x, y, ViewLimits(least_m=0.2))
    assert set(surely) <= set(lines_in_view(moved, robot.x_m, robot.y_m, LIMITS)) <= set(perhaps)


@pytest.mark.parametrize("walls", [[], [wall(0.0, 0.0, 0.0, 0.0)]])
def test_nothing_to_see(walls: list[LineEstimate]) -> None:
    assert lines_in_view(walls, 0.0, 0.0, LIMITS) == []
