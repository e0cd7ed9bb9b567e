"""Expected echoes in grids drawn by hand."""

from math import cos, pi, radians

import numpy as np
import pytest

from blackboard.grid import Grid
from blackboard.messages.geometry import IDENTITY, Pose
from knowledge_sources.sonar_matching.forward_model import cover, expect
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.window import Heard

PARAMS = SonarMatcherParams(wall_behind_m=0.0)
CELL_M = PARAMS.cell_m


def hall(x_wall_m: float = 2.0) -> Grid:
    """Empty everywhere within 4 m, with a wall two cells thick that begins at x_wall_m."""
    grid = Grid(CELL_M)
    grid.cover(-4.0, -4.0, 4.0, 4.0)
    first_column = round(grid.x_min_m / CELL_M)
    grid.cells[:] = 0
    column = round(x_wall_m / CELL_M) - first_column
    grid.cells[:, column : column + 2] = 255
    return grid


def sonar(range_m: float, heading_rad: float = 0.0, cone_rad: float = radians(12)) -> Heard:
    return Heard(np.array([[0.0, 0.0, heading_rad]]), np.array([range_m]), np.array([cone_rad]))


def expected_m(grid: Grid, heard: Heard, *poses: tuple[float, float, float]) -> list[float]:
    cover(grid, heard, IDENTITY, PARAMS, 1.0)
    return [float(r) for r in expect(grid, heard, np.array(poses), PARAMS).ranges_m[:, 0]]


def test_a_wall_ahead_is_expected_where_it_begins() -> None:
    assert expected_m(hall(), sonar(2.0), (0.01, 0.01, 0.0)) == [pytest.approx(1.99, abs=CELL_M)]


def test_moving_towards_the_wall_shortens_the_echo_by_the_way() -> None:
    near, far = expected_m(hall(), sonar(2.0), (0.51, 0.01, 0.0), (0.01, 0.01, 0.0))
    assert far - near == pytest.approx(0.5, abs=CELL_M / 2)


def test_a_slanted_cone_hears_the_wall_with_its_edge() -> None:
    slanted = expected_m(hall(1.5), sonar(1.6, radians(20), radians(30)), (0.01, 0.01, 0.0))
    assert slanted == [pytest.approx(1.49 / cos(radians(5)), abs=CELL_M)]


def test_where_nothing_stands_no_echo_is_expected() -> None:
    assert expected_m(hall(), sonar(2.0, pi), (0.01, 0.01, 0.0)) == [np.inf]


def test_an_echo_from_unmapped_places_is_not_known() -> None:
    grid = hall()
    column = round(1.0 / CELL_M) - round(grid.x_min_m / CELL_M)
    grid.cells[:, column : column + 8] = 128
    heard = sonar(2.0)
    cover(grid, heard, IDENTITY, PARAMS, 1.0)
    assert not expect(grid, heard, np.array([[0.01, 0.01, 0.0]]), PARAMS).known[0, 0]
    assert expect(hall(), heard, np.array([[0.01, 0.01, 0.0]]), PARAMS).known[0, 0]


def test_the_grid_grows_to_hold_every_ray() -> None:
    grid = Grid(CELL_M)
    heard = sonar(3.0)
    cover(grid, heard, Pose(x_m=-7.0, y_m=9.0, heading_rad=0.0), PARAMS, 1.0)
    assert grid.x_min_m <= -11.4
    assert grid.y_min_m + grid.cells.shape[0] * CELL_M >= 13.4
    assert expect(grid, heard, np.array([[-7.9, 9.9, 2.0]]), PARAMS).ranges_m[0, 0] == np.inf
