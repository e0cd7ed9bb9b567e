"""Lines along which the grid is empty, and new ones where a change is in doubt."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.grid import Grid, tile_id
from blackboard.kinds import CHANGE, GRID, MODEL_LINE, NEW_AREA_VISITED
from blackboard.messages.conflicts import Change
from blackboard.messages.geometry import Point
from blackboard.messages.model import ModelLine, NewAreaVisited
from blackboard.uncertainty.endorsements import standing
from blackboard.vocabulary import Vocabulary
from knowledge_sources.line_doubts import LineDoubts, LineDoubtsParams, empty_along, share_within


def line(x0: float, y0: float, x1: float, y1: float) -> ModelLine:
    return ModelLine(
        theta_rad=0.0,  # not read: ends say it all
        rho_m=0.0,
        d_m=0.0,
        half_length_m=1.0,
        sigma_theta_rad=0.01,
        sigma_rho_m=0.01,
        covariance_theta_rho_m_rad=0.0,
        inherited_sigma_theta_rad=0.0,
        inherited_sigma_rho_m=0.0,
        faces_left=True,
        start=Point(x_m=x0, y_m=y0),
        end=Point(x_m=x1, y_m=y1),
        observations=5,
    )


def grid_with_wall() -> Grid:
    """Return a grid of 4 by 4 m that is empty, but for a wall along y = 2 up to x = 2, and unknown for x > 3."""
    grid = Grid(0.05)
    grid.cover(0.0, 0.0, 3.99, 3.99)
    grid.cells[:80, :60] = 0
    grid.cells[40, :40] = 255
    return grid


def test_along_which_share_a_line_is_empty() -> None:
    grid = grid_with_wall()
    assert empty_along(line(0.0, 2.02, 2.0, 2.02), grid, 0.15) == 0.0
    assert empty_along(line(0.0, 2.15, 2.0, 2.15), grid, 0.15) == 0.0  # beside it, as the pose may err
    assert empty_along(line(0.0, 2.4, 2.0, 2.4), grid, 0.15) == 1.0
    assert empty_along(line(1.0, 2.02, 3.0, 2.02), grid, 0.15) == pytest.approx(0.5, abs=0.1)
    assert empty_along(line(3.5, 0.5, 3.5, 1.5), grid, 0.15) == 0.0  # where nothing is known nothing is empty
    assert empty_along(line(9.0, 9.0, 9.0, 10.0), grid, 0.15) == 0.0


@given(st.floats(0.3, 2.5), st.floats(0.3, 3.5), st.floats(0.3, 2.5), st.floats(0.3, 3.5), st.floats(0.0, 0.2))
def test_a_line_is_the_same_from_either_end_and_no_emptier_in_a_wider_band(
    x0: float, y0: float, x1: float, y1: float, beside: float
) -> None:
    grid = grid_with_wall()
    there, back = (empty_along(w, grid, beside) for w in (line(x0, y0, x1, y1), line(x1, y1, x0, y0)))
    assert there == pytest.approx(back, abs=0.35)  # cells at an edge may fall to either side
    assert 0.0 <= empty_along(line(x0, y0, x1, y1), grid, beside + 0.1) <= 1.0
    assert empty_along(line(x0, y0, x1, y1), grid, round(beside / 0.05) * 0.05 + 0.1) <= there + 1e-9


def test_which_share_lies_where_something_has_changed() -> None:
    change = Change(change="appeared", place=Point(x_m=1.0, y_m=1.0), size_m=1.0, first_s=0.0)
    assert share_within(line(0.6, 1.0, 1.4, 1.0), change, 0.0) == 1.0
    assert share_within(line(1.0, 1.0, 3.0, 1.0), change, 0.0) == pytest.approx(0.25)
    assert share_within(line(1.0, 1.0, 3.0, 1.0), change, 0.25) == pytest.approx(0.375, abs=0.01)
    assert share_within(line(2.0, 2.0, 3.0, 2.0), change, 0.0) == 0.0


def test_on_a_board_reasons_come_and_go() -> None:
    board, source = Board(Vocabulary()), LineDoubts(LineDoubtsParams(), name="line_doubts")
    access = Access(board, source.name, [GRID, *source.reads], source.posts)
    board.post(MODEL_LINE, line(0.0, 2.0, 2.0, 2.0), id="wall", source="merge")
    board.post(MODEL_LINE, line(0.5, 1.0, 1.5, 1.0), id="gone", source="merge")
    new = NewAreaVisited(line=line(0.2, 2.0, 0.8, 2.0), seen_from=Point(x_m=0.0, y_m=0.0))
    board.post(NEW_AREA_VISITED, new, id="1", source="merge")
    change = Change(change="appeared", place=Point(x_m=0.5, y_m=2.0), size_m=0.8, first_s=0.0)
    board.post(CHANGE, change, id="7", source="changes")

    def look(grid: Grid) -> dict[str, list[str]]:
        for tile in grid.take_changed():
            board.post(GRID, tile, id=tile_id(tile), source="grid")
        source.activate(board.entries(GRID)[0], access)
        entries: list[Entry[object]] = [*board.entries(MODEL_LINE), *board.entries(NEW_AREA_VISITED)]  # type: ignore[list-item]
        return {str(e.id): [f"{s.verdict} {s.about} {s.strength}" for s in standing(e.endorsements)] for e in entries}

    grid = grid_with_wall()
    assert look(grid) == {"wall": [], "gone": ["against grid strong"], "1": ["against change fair"]}
    revision = board.entries(MODEL_LINE)[1].revision
    grid.cells[20, 10:30] = 255  # it was there after all
    accepted = Change(change="appeared", place=Point(x_m=0.5, y_m=2.0), size_m=0.8, first_s=0.0, accepted=True)
    board.post(CHANGE, accepted, id="7", source="changes")
    assert look(grid) == {"wall": [], "gone": [], "1": []}
    assert board.entries(MODEL_LINE)[1].revision == revision + 1
    look(grid)
    assert board.entries(MODEL_LINE)[1].revision == revision + 1  # nothing new to say
    assert np.array_equal(grid.cells[20, 10:30], np.full(20, 255))
