"""Which lines a run shows: the model's where there is one, in the observed lines' form."""

from math import cos, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.board import Board
from blackboard.command.gather import as_observed, lines_of
from blackboard.kinds import LINE, MODEL_LINE
from blackboard.messages.geometry import Point
from blackboard.messages.model import ModelLine
from blackboard.messages.world import Line
from blackboard.vocabulary import Vocabulary

COORDINATE = st.floats(-50, 50)


def model_line(x1: float, y1: float, x2: float, y2: float) -> ModelLine:
    return ModelLine(
        theta_rad=0.0,
        rho_m=0.0,
        d_m=0.0,
        half_length_m=1.0,
        sigma_theta_rad=0.01,
        sigma_rho_m=0.02,
        covariance_theta_rho_m_rad=0.0,
        inherited_sigma_theta_rad=0.0,
        inherited_sigma_rho_m=0.0,
        faces_left=True,
        start=Point(x_m=x1, y_m=y1),
        end=Point(x_m=x2, y_m=y2),
        observations=7,
    )


@given(COORDINATE, COORDINATE, COORDINATE, COORDINATE)
def test_both_ends_lie_on_the_carrier(x1: float, y1: float, x2: float, y2: float) -> None:
    board = Board(Vocabulary())
    entry = as_observed(board.post(MODEL_LINE, model_line(x1, y1, x2, y2), id="1", source="match_merge"))
    line = entry.value
    assert line.rho_m >= 0
    assert -pi < line.alpha_rad <= pi
    assert line.start.x_m * cos(line.alpha_rad) + line.start.y_m * sin(line.alpha_rad) == pytest.approx(line.rho_m)
    assert line.end.x_m * cos(line.alpha_rad) + line.end.y_m * sin(line.alpha_rad) == pytest.approx(
        line.rho_m, abs=1e-9
    )
    assert (entry.id, line.support, line.sigma_rho_m) == ("1", 7, 0.02)


def test_the_model_goes_before_what_was_observed() -> None:
    board = Board(Vocabulary())
    assert lines_of(board) == []
    start, end = Point(x_m=0.0, y_m=2.0), Point(x_m=3.0, y_m=2.0)
    seen = Line(start=start, end=end, alpha_rad=pi / 2, rho_m=2.0, sigma_rho_m=0.01, support=30)
    board.post(LINE, seen, id="1-0", source="line_finder")
    assert [entry.value for entry in lines_of(board)] == [seen]
    board.post(MODEL_LINE, model_line(0.0, 2.0, 3.0, 2.0), id="1", source="match_merge")
    (shown,) = lines_of(board)
    assert (shown.value.alpha_rad, shown.value.rho_m) == (pytest.approx(pi / 2), pytest.approx(2.0))
