import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.report.palette import cell_colours
from blackboard.report.view import View, colours_over, known_part, scale_bar_m, simplified, view_of

NO_LINES = np.empty((0, 4))
NO_POSES = np.empty((0, 4))


def test_the_known_part_is_cut_out_with_its_corner(make_grid):
    cells = np.full((6, 8), 128)
    cells[2, 3], cells[4, 5] = 0, 255
    part = known_part(make_grid(cells, 10.0, 20.0, 0.5))
    assert part is not None
    assert part.cells.tolist() == [[0, 128, 128], [128, 128, 128], [128, 128, 255]]
    assert (part.x_min_m, part.y_min_m) == (11.5, 21.0)


def test_a_grid_without_knowledge_has_no_known_part(make_grid):
    assert known_part(make_grid([[128, 128]])) is None
    assert known_part(make_grid(np.empty((0, 0)))) is None


def test_the_view_holds_grid_robot_and_lines_with_a_margin(make_grid):
    grid = make_grid(np.zeros((40, 60)), 0.0, 0.0, 0.1)  # 6 x 4 m
    path = np.array([[0.0, 6.5, 1.0, 0.0]])
    lines = np.array([[0.0, 0.0, 0.0, 5.0]])
    view = view_of(grid, path, lines, 0.2)
    assert view == View(pytest.approx(-0.3), pytest.approx(-0.3), pytest.approx(7.0), pytest.approx(5.3))


def test_nothing_at_all_still_has_a_view():
    view = view_of(None, NO_POSES, NO_LINES, 0.2)
    assert (view.width_m, view.height_m) == (2.0, 2.0)


@given(st.floats(0.1, 500), st.floats(0.1, 500))
def test_a_widened_view_holds_the_old_one_and_has_its_shape(width_m, height_m):
    view = View(0.0, 0.0, width_m, height_m)
    wide = view.widened(0.4, 0.9)
    assert 0.4 - 1e-9 <= wide.height_m / wide.width_m <= 0.9 + 1e-9
    assert wide.x_min_m <= 1e-9
    assert wide.y_min_m <= 1e-9
    assert wide.x_max_m >= width_m - 1e-9
    assert wide.y_max_m >= height_m - 1e-9


def test_colours_cover_only_the_cells_in_view(make_grid):
    grid = make_grid([[0, 0, 255], [0, 0, 0]], 0.0, 0.0, 1.0)
    picture, covered = colours_over(grid, View(1.5, 0.2, 9.0, 0.8), cell_colours())
    assert covered == View(1.0, 0.0, 3.0, 1.0)
    assert picture.tolist() == [[[255, 255, 255], [38, 48, 61]]]


def test_a_grid_out_of_view_gives_no_cells(make_grid):
    picture, _ = colours_over(make_grid([[0]]), View(5.0, 5.0, 6.0, 6.0), cell_colours())
    assert picture.size == 0


@pytest.mark.parametrize(("width_m", "bar_m"), [(8.0, 1.0), (40.0, 5.0), (10.0, 2.0), (2.0, 0.2), (250.0, 50.0)])
def test_the_scale_bar_is_round(width_m, bar_m):
    assert scale_bar_m(width_m) == pytest.approx(bar_m)


def test_simplifying_keeps_the_ends_and_steps_of_the_length_asked():
    points = np.array([[0.0, 0.0], [0.4, 0.0], [1.0, 0.0], [1.5, 0.0], [1.9, 0.0]])
    assert simplified(points, 1.0).tolist() == [0, 2, 4]
    assert simplified(points[:1], 1.0).tolist() == [0]
    assert simplified(points[:0], 1.0).tolist() == []
