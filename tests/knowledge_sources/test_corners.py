"""Corners: hand-worked meetings of walls, their shapes on a grid, and the source on a board."""

from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Support
from blackboard.grid import Grid, tile_id
from blackboard.kinds import CORNER, GRID, LINE, VERDICT
from blackboard.messages.geometry import Point, wrap_angle
from blackboard.messages.world import Line
from blackboard.vocabulary import Vocabulary
from knowledge_sources.corner_search import CornerLimits, corners, meetings, sigmas
from knowledge_sources.corners import Corners, CornersParams
from knowledge_sources.walls import Wall

LIMITS = CornerLimits()


def wall(number: int, x0: float, y0: float, x1: float, y1: float, sigma_theta: float = 0.0) -> Wall:
    return Wall(
        number=number, x_m=(x0 + x1) / 2, y_m=(y0 + y1) / 2, theta_rad=float(np.arctan2(y1 - y0, x1 - x0)),
        half_length_m=float(np.hypot(x1 - x0, y1 - y0)) / 2, sigma_rho_m=0.02, sigma_theta_rad=sigma_theta, side=0,
    )  # fmt: skip


def grid_with_empty(*boxes: tuple[float, float, float, float]) -> Grid:
    """Return a grid of 6.4 x 6.4 m about the origin, unknown but for these boxes."""
    grid = Grid(0.05)
    grid.cover(-3.1, -3.1, 3.1, 3.1)
    for x0, y0, x1, y1 in boxes:
        r0, r1 = (round((y - grid.y_min_m) / 0.05) for y in (y0, y1))
        c0, c1 = (round((x - grid.x_min_m) / 0.05) for x in (x0, x1))
        grid.cells[r0:r1, c0:c1] = 0
    return grid


def test_two_walls_meet_at_a_right_angle() -> None:
    (found,) = meetings([wall(1, 0.1, 0, 2, 0), wall(2, 0, 0.2, 0, 1)], LIMITS)
    assert (found.x_m, found.y_m) == pytest.approx((0.0, 0.0))
    assert found.opening_rad == pytest.approx(pi / 2)
    assert found.bisector_rad == pytest.approx(pi / 4)
    assert found.gap_m == pytest.approx(0.2)  # the larger of the two
    assert found.name == "1-2"
    # the offset of the level wall is y, that of the upright one x
    assert sigmas(found.covariance) == pytest.approx((0.02, 0.02, 0.0))


def test_the_uncertainty_grows_with_the_way_from_the_middle_and_with_slant() -> None:
    (square,) = meetings([wall(1, 0, 0, 2, 0, sigma_theta=0.03), wall(2, 0, 0, 0, 1)], LIMITS)
    sigma_x, sigma_y, _ = sigmas(square.covariance)
    assert sigma_x == pytest.approx(0.02)
    assert sigma_y == pytest.approx(sqrt(0.02**2 + 0.03**2))  # 1 m from the middle
    slant = wall(2, 0, 0, cos(radians(45)), sin(radians(45)))
    (found,) = meetings([wall(1, 0, 0, 2, 0), slant], LIMITS)
    sigma_x, sigma_y, correlation = sigmas(found.covariance)
    assert sigma_y == pytest.approx(0.02)
    assert sigma_x == pytest.approx(0.02 * sqrt(3))  # x = y - sqrt(2) rho: variances 1 + 2
    assert correlation == pytest.approx(1 / sqrt(3))


@pytest.mark.parametrize(
    "second",
    [
        wall(2, 0, 0.4, 0, 1),  # ends 0.4 m short
        wall(2, -0.5, 0, -0.5, 1),  # half a metre beyond the first one's end
        wall(2, 0, 0, 2, 0.5),  # too slanted to say where
        wall(2, 1, -1, 1, 1),  # through each other: one is a mistake
        wall(2, 0, 0, 0, 0.1),  # too short
        wall(2, 0, 1, 2, 1),  # parallel
    ],
)
def test_what_is_no_corner(second: Wall) -> None:
    assert meetings([wall(1, 0, 0, 2, 0), second], LIMITS) == []


def test_inside_the_angle_is_concave_outside_is_convex() -> None:
    walls = [wall(1, 0, 0, 2, 0), wall(2, 0, 0, 0, 2)]
    assert corners(walls, grid_with_empty((0, 0, 2, 2)), LIMITS)[0].shape == "concave"
    around = grid_with_empty((-2, -2, 2, 0), (-2, 0, 0, 2))
    assert corners(walls, around, LIMITS)[0].shape == "convex"
    assert corners(walls, grid_with_empty((-2, -2, 2, 2)), LIMITS)[0].shape == "unknown"
    assert corners(walls, None, LIMITS)[0].shape == "unknown"


def test_where_the_grid_shows_a_way_between_the_lines_there_is_no_corner() -> None:
    walls = [wall(1, 0.25, 0, 2, 0), wall(2, 0, 0, 0, 2)]
    room, way = (0.0, 0.0, 2.0, 2.0), (0.05, -0.1, 0.2, 0.1)
    assert [m.gap_m for m in corners(walls, grid_with_empty(room), LIMITS)] == [0.25]  # seen from one side only
    assert corners(walls, grid_with_empty(room, way), LIMITS) == []
    assert len(corners(walls, grid_with_empty(room, (0.1, -0.1, 0.15, 0.0)), LIMITS)) == 1  # a cell: chance


def test_a_wall_that_ends_at_another_makes_a_corner_on_the_side_where_there_is_room() -> None:
    walls = [wall(1, -2, 0, 2, 0), wall(2, 0.5, 0, 0.5, 1)]
    assert [m.name for m in corners(walls, grid_with_empty((0.5, 0, 2, 2)), LIMITS)] == ["1-2-ahead"]
    assert [m.name for m in corners(walls, grid_with_empty((-2, 0, 0.5, 2)), LIMITS)] == ["1-2-behind"]
    both = [m.name for m in corners(walls, grid_with_empty((0.5, 0, 2, 2), (-2, 0, 0.4, 2)), LIMITS)]
    assert both == ["1-2-ahead", "1-2-behind"]
    assert corners(walls, None, LIMITS) == []


def test_of_corners_at_one_place_the_one_with_the_longest_arms_stays() -> None:
    walls = [wall(1, 0, 0, 2, 0), wall(2, 0, 0, 0, 2), wall(3, 0.11, 0, 0.11, 0.5)]
    assert [m.name for m in corners(walls, None, LIMITS)] == ["1-2"]


@given(st.floats(-pi, pi), st.floats(-50, 50), st.floats(-50, 50), st.floats(0.6, pi - 0.6))
def test_a_corner_turns_and_moves_with_its_walls(turn: float, x: float, y: float, opening: float) -> None:
    ends = [(1.5 * cos(turn + a), 1.5 * sin(turn + a)) for a in (0.0, opening)]
    walls = [wall(i + 1, x, y, x + dx, y + dy, 0.02) for i, (dx, dy) in enumerate(ends)]
    (found,) = meetings(walls, LIMITS)
    assert (found.x_m, found.y_m) == pytest.approx((x, y), abs=1e-6)
    assert found.opening_rad == pytest.approx(opening, abs=1e-6)
    assert abs(wrap_angle(found.bisector_rad - turn - opening / 2)) < 1e-6
    xx, xy, yy = found.covariance
    assert xx * yy - xy * xy > 0  # a covariance


def line(x0: float, y0: float, x1: float, y1: float) -> Line:
    start, end = Point(x_m=x0, y_m=y0), Point(x_m=x1, y_m=y1)
    return Line(start=start, end=end, alpha_rad=0.0, rho_m=0.0, sigma_rho_m=0.02, support=30)


def test_on_a_board_a_corner_stands_while_its_lines_meet_and_is_denied_afterwards() -> None:
    board = Board(Vocabulary())
    source = Corners(CornersParams(), name="corners")
    access = Access(board, source.name, (LINE, *source.reads), source.posts)
    for tile in grid_with_empty((0, 0, 2, 2)).take_changed():
        board.post(GRID, tile, id=tile_id(tile), source="grid")
    first = board.post(LINE, line(0, 0, 2, 0), id="a", source="finder")
    second = board.post(LINE, line(0, 0, 0, 2), id="b", source="finder")
    source.activate(second, access)
    (entry,) = board.entries(CORNER)
    assert (entry.id, entry.value.shape) == ("1-2", "concave")
    assert entry.value.lines == (first.key, second.key)
    keys = {support.key for support in entry.supports}
    assert {first.key, second.key} < keys
    assert any("/grid/" in key for key in keys)
    assert [(e.who, e.verdict, e.about) for e in entry.endorsements] == [
        ("corners", "for", "lines"),
        ("corners", "for", "room"),
    ]
    (verdict,) = board.entries(VERDICT)
    assert (verdict.id, verdict.value.outcome) == ("corner.1-2", "confirmed")
    posts = board.posts
    source.activate(second, access)
    assert board.posts == posts  # nothing changed, nothing said
    board.retract(LINE, "b", source="finder")
    source.finish(access)
    assert board.entries(CORNER) == []
    gone = board.history.revisions(Support(entry.key, 1, 9))[-1]
    assert gone.event == "retracted"
    assert gone.endorsements[-1].verdict == "against"
    assert "meet there no more" in gone.endorsements[-1].why
