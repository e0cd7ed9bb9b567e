"""Lines put together to walls."""

from math import cos, pi, radians, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.kinds import LINE, MODEL_LINE
from blackboard.messages.geometry import Point
from blackboard.messages.model import ModelLine
from blackboard.messages.world import Line
from blackboard.vocabulary import Vocabulary
from knowledge_sources.walls import Piece, WallLimits, Walls, as_piece, fuse


def line(x0: float, y0: float, x1: float, y1: float, support: int = 30) -> Line:
    start, end = Point(x_m=x0, y_m=y0), Point(x_m=x1, y_m=y1)
    return Line(start=start, end=end, alpha_rad=0.0, rho_m=0.0, sigma_rho_m=0.02, support=support)


def posted(*lines: Line) -> tuple[Board, list[Entry[Line]]]:
    board = Board(Vocabulary())
    for i, value in enumerate(lines):
        board.post(LINE, value, id=str(i), source="test")
    return board, board.entries(LINE)


def piece(x0: float, y0: float, x1: float, y1: float) -> Piece:
    return Piece(key="k", x0_m=x0, y0_m=y0, x1_m=x1, y1_m=y1, sigma_rho_m=0.02, sigma_theta_rad=0.01)


def test_two_sightings_of_one_wall_are_one_that_covers_both() -> None:
    walls = Walls(WallLimits()).update(posted(line(0, 0.02, 1, 0.02), line(0.8, -0.02, 3, -0.02))[1])
    assert len(walls) == 1
    (x0, y0), (x1, y1) = walls[0].ends
    assert (min(x0, x1), max(x0, x1)) == pytest.approx((0, 3), abs=0.02)
    assert abs(y0) < 0.04
    assert abs(y1) < 0.04
    assert [e.id for e in walls[0].entries] == ["1", "0"]  # longest first


def test_a_wall_that_loses_what_held_it_together_becomes_two() -> None:
    board, lines = posted(line(0, 0, 1, 0), line(0.9, 0, 3.1, 0), line(3, 0, 5, 0))
    walls = Walls(WallLimits())
    (whole,) = walls.update(lines)
    board.retract(LINE, "1", source="test")
    parts = walls.update(board.entries(LINE))
    assert [[e.id for e in wall.entries] for wall in parts] == [["2"], ["0"]]  # the longer one keeps the number
    assert parts[0].number == whole.number
    board.post(LINE, line(0.9, 0, 3.1, 0), id="1", source="test")
    (again,) = walls.update(board.entries(LINE))
    assert again.number == whole.number
    assert len(again.entries) == 3


@pytest.mark.parametrize(
    ("second", "count"),
    [
        (line(1.5, 0, 3, 0), 1),  # a gap of 0.5 m
        (line(1.7, 0, 3, 0), 2),  # of 0.7 m: the robot could pass
        (line(0, 0.09, 1, 0.09), 1),
        (line(0, 0.15, 1, 0.15), 2),  # two walls side by side
        (line(1, 0, 0, 0), 1),  # undirected
        (line(0, 0, 0, 1), 2),
    ],
)
def test_what_is_one_wall(second: Line, count: int) -> None:
    assert len(Walls(WallLimits()).update(posted(line(0, 0, 1, 0), second)[1])) == count


def test_a_wall_seen_from_both_sides_stays_two() -> None:
    def model(theta: float, left: bool) -> ModelLine:
        return ModelLine(
            theta_rad=theta, rho_m=0.0, d_m=0.0, half_length_m=1.0, sigma_theta_rad=0.01, sigma_rho_m=0.02,
            covariance_theta_rho_m_rad=0.0, inherited_sigma_theta_rad=0.0, inherited_sigma_rho_m=0.0, faces_left=left,
            start=Point(x_m=-cos(theta), y_m=0.0), end=Point(x_m=cos(theta), y_m=0.0), observations=1,
        )  # fmt: skip

    def count(*lines: ModelLine) -> int:
        board = Board(Vocabulary())
        for i, value in enumerate(lines):
            board.post(MODEL_LINE, value, id=str(i), source="test")
        return len(Walls(WallLimits()).update(board.entries(MODEL_LINE)))

    assert count(model(0.0, True), model(0.0, False)) == 2
    assert count(model(0.0, True), model(pi, True)) == 2  # left of the other way
    assert count(model(0.0, True), model(pi, False)) == 1
    assert count(model(0.0, True), model(0.0, True)) == 1


def test_numbers_stay_while_lines_come_and_go_and_a_bridge_joins_walls() -> None:
    board, _ = posted(line(0, 0, 1, 0), line(2, 0, 3, 0), line(0, 2, 1, 2))
    walls = Walls(WallLimits())
    assert [w.number for w in walls.update(board.entries(LINE))] == [1, 2, 3]
    board.post(LINE, line(0.9, 0, 2.1, 0), id="bridge", source="test")
    assert [w.number for w in walls.update(board.entries(LINE))] == [1, 3]
    board.retract(LINE, "2", source="test")
    assert [w.number for w in walls.update(board.entries(LINE))] == [1]
    board.post(LINE, line(0, 5, 1, 5), id="0", source="test")  # revised: it is elsewhere now
    found = walls.update(board.entries(LINE))
    assert [w.number for w in found] == [1, 4]
    assert [sorted(str(e.id) for e in w.entries) for w in found] == [["1", "bridge"], ["0"]]


def test_an_observed_line_becomes_a_piece() -> None:
    _, entries = posted(line(0, 0, 2, 0, support=300))
    found = as_piece(entries[0])
    assert (found.length_m, found.side) == (2.0, 0)
    assert 0.02 <= found.sigma_rho_m < 0.03  # the floor of what the points share
    assert 0.01 < found.sigma_theta_rad < 0.05


coordinate = st.floats(-5, 5)


@given(st.floats(-pi, pi), st.floats(0.1, 5), coordinate, coordinate)
def test_one_piece_is_its_own_wall(theta: float, half: float, x: float, y: float) -> None:
    dx, dy = half * cos(theta), half * sin(theta)
    wall = fuse([piece(x - dx, y - dy, x + dx, y + dy)])
    (x0, y0), (x1, y1) = wall.ends
    assert (x0, y0, x1, y1) == pytest.approx((x - dx, y - dy, x + dx, y + dy), abs=1e-6)
    assert wall.sigma_rho_m == pytest.approx(0.02)


def test_a_tilted_piece_is_no_part() -> None:
    c, s = cos(radians(8)), sin(radians(8))
    assert len(Walls(WallLimits()).update(posted(line(0, 0, 2, 0), line(0, 0, c, s))[1])) == 2
