"""Expected echoes in grids drawn by hand."""

from math import cos, pi, radians

import numpy as np
import pytest

from blackboard.grid import Grid
from blackboard.messages.geometry import IDENTITY, Pose
from knowledge_sources.sonar_matching.forward_model import OUTSIDE, expect, inside, known
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.window import Heard

PARAMS = SonarMatcherParams()
CELL_M = PARAMS.cell_m
HERE = Pose(x_m=0.01, y_m=0.01, heading_rad=0.0)


def hall(x_wall_m: float = 2.0, thick: int = 2) -> Grid:
    """Empty everywhere within 6 m, with a wall that begins at x_wall_m, some cells thick."""
    grid = Grid(CELL_M)
    grid.cover(-6.0, -6.0, 6.0, 6.0)
    grid.cells[:] = 0
    column = round(x_wall_m / CELL_M) - round(grid.x_min_m / CELL_M)
    grid.cells[:, column : column + thick] = 255
    return grid


def sonar(range_m: float, heading_rad: float = 0.0, cone_rad: float = radians(12)) -> Heard:
    return Heard(np.array([[0.0, 0.0, heading_rad]]), np.array([range_m]), np.array([cone_rad]))


def longer_m(grid: Grid, heard: Heard, *poses: tuple[float, float, float]) -> list[float]:
    return [float(r) for r in expect(grid, heard, np.array(poses), PARAMS)[:, 0]]


def test_a_wall_is_expected_in_the_middle_of_its_band() -> None:
    assert longer_m(hall(), sonar(2.04), (0.01, 0.01, 0.0)) == [pytest.approx(0.0, abs=CELL_M / 2)]
    assert longer_m(hall(thick=4), sonar(2.04), (0.01, 0.01, 0.0)) == [pytest.approx(0.05, abs=CELL_M / 2)]


def test_moving_towards_the_wall_shortens_the_echo_by_the_way() -> None:
    near, far = longer_m(hall(), sonar(2.0), (0.21, 0.01, 0.0), (0.01, 0.01, 0.0))
    assert far - near == pytest.approx(0.2, abs=CELL_M / 2)


def test_a_slanted_cone_hears_the_wall_with_its_edge() -> None:
    slanted = longer_m(hall(1.5), sonar(1.6, radians(20), radians(30)), (0.01, 0.01, 0.0))
    assert slanted == [pytest.approx(1.54 / cos(radians(5)) - 1.6, abs=CELL_M)]


def test_where_nothing_stands_near_the_echo_none_is_expected() -> None:
    assert longer_m(hall(), sonar(2.0, pi), (0.01, 0.01, 0.0)) == [OUTSIDE]
    assert longer_m(hall(), sonar(1.0), (0.01, 0.01, 0.0)) == [OUTSIDE]


def test_an_echo_over_unmapped_places_is_not_known() -> None:
    grid, heard = hall(), sonar(2.0)
    assert known(grid, heard, HERE, PARAMS)[0]
    column = round(1.4 / CELL_M) - round(grid.x_min_m / CELL_M)
    grid.cells[:, column : column + 8] = 128
    assert not known(grid, heard, HERE, PARAMS)[0]


def test_an_echo_out_of_an_unmapped_place_is_not_known_and_draws_nobody() -> None:
    grid = Grid(CELL_M)
    grid.cover(-6.0, -6.0, 6.0, 6.0)
    column = round(1.9 / CELL_M) - round(grid.x_min_m / CELL_M)
    grid.cells[:, :column] = 0
    assert not known(grid, sonar(2.0), HERE, PARAMS)[0]
    assert longer_m(grid, sonar(2.0), (0.01, 0.01, 0.0)) == [PARAMS.neutral_m]


def test_what_would_end_outside_the_grid_is_named() -> None:
    both = Heard(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, pi]]), np.array([3.0, 4.9]), np.array([0.2, 0.2]))
    east = Pose(x_m=-0.5, y_m=0.0, heading_rad=0.0)
    grid = Grid(CELL_M)
    grid.cover(-6.0, -6.0, 6.0, 6.0)
    assert inside(grid, both, IDENTITY, 1.0).tolist() == [True, True]
    assert inside(grid, both, east, 1.2).tolist() == [True, False]
