"""Parallel and collinear pairs."""

from math import radians

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.errors import MissionError
from blackboard.kinds import LINE, LINE_RELATION
from blackboard.messages.geometry import Point
from blackboard.messages.world import Line
from blackboard.parameters import parse_parameters
from blackboard.vocabulary import Vocabulary
from knowledge_sources.line_relations import LineRelations, LineRelationsParams


def line(x0: float, y0: float, x1: float, y1: float) -> Line:
    start, end = Point(x_m=x0, y_m=y0), Point(x_m=x1, y_m=y1)
    return Line(start=start, end=end, alpha_rad=0.0, rho_m=0.0, sigma_rho_m=0.02, support=30)


def related(*lines: Line) -> Board:
    board = Board(Vocabulary())
    source = LineRelations(LineRelationsParams(), name="relations")
    access = Access(board, source.name, (LINE,), source.posts)
    for i, value in enumerate(lines):
        entry = board.post(LINE, value, id=str(i), source="finder")
    source.activate(entry, access)
    return board


def test_the_walls_of_a_corridor_are_parallel() -> None:
    (entry,) = related(line(0, 0, 4, 0), line(5, 1.8, 1, 1.8)).entries(LINE_RELATION)
    found = entry.value
    assert (entry.id, found.relation) == ("1-2", "parallel")
    assert found.distance_m == pytest.approx(1.8)
    assert found.shared_m == pytest.approx(3.0)
    assert (found.place.x_m, found.place.y_m) == pytest.approx((2.5, 0.9))
    assert found.angle_rad == pytest.approx(0.0, abs=1e-9)
    assert len(entry.supports) == 2


def test_walls_that_draw_nearer_are_as_far_apart_as_where_they_run_side_by_side() -> None:
    slope = 0.05  # 2.9 degrees: at x = 9 the second wall is 0.25 m nearer than at x = 4
    values = (line(8, 0, 10, 0), line(0, 2.0, 8.8, 2.0 - 8.8 * slope))
    for pair in (values, values[::-1]):
        (entry,) = related(*pair).entries(LINE_RELATION)
        found = entry.value
        assert found.relation == "parallel"
        assert found.distance_m == pytest.approx(2.0 - 8.4 * slope, abs=0.01)
        assert (found.place.x_m, found.place.y_m) == pytest.approx((8.4, found.distance_m / 2), abs=0.06)


def test_a_wall_with_a_door_in_it_is_a_collinear_pair() -> None:
    (entry,) = related(line(0, 0, 2, 0), line(2.9, 0.03, 5, 0.03)).entries(LINE_RELATION)
    found = entry.value
    assert found.relation == "collinear"
    assert found.gap_m == pytest.approx(0.9)
    assert found.distance_m == pytest.approx(0.03)
    assert found.place.x_m == pytest.approx(2.45)


@pytest.mark.parametrize(
    "second",
    [
        line(0, 0, 0, 3),  # upright
        line(0, 5, 3, 5),  # too far off
        line(3.5, 1, 6, 1),  # beside nothing of the first
        line(7, 0, 9, 0),  # 4 m on
        line(0, 1, 0.3, 1),  # too short
        line(0, 1, 3, 1.5),  # ten degrees
    ],
)
def test_other_pairs_are_not_related(second: Line) -> None:
    assert related(line(0, 0, 3, 0), second).entries(LINE_RELATION) == []


def test_parameters() -> None:
    given = {"lines": "model", "angle_deg": 2.0}
    assert parse_parameters(LineRelationsParams, given, "m.toml").angle_rad == pytest.approx(radians(2.0))
    for key, value in (("lines", "seen"), ("angle_rad", 0.0), ("gap_m", -1.0)):
        with pytest.raises(MissionError, match=key):
            parse_parameters(LineRelationsParams, {key: value}, "m.toml")
