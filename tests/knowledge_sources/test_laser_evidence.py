"""Laser sweeps in the grid, worked by hand and by symmetry: 5 cm cells, the laser in the middle of cell (0, 0)."""

from dataclasses import replace
from math import cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.grid import UNKNOWN, Grid
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserScan
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.laser_evidence import LaserEvidence

CELL_M = 0.05
HERE = CELL_M / 2
DEGREE = pi / 180
PARAMS = EouGridParams(laser_range_m=5.0, laser_down=10, laser_up=48)
Ranges = list[float | None]


def folded(*scans: LaserScan, at: Pose | None = None, params: EouGridParams = PARAMS) -> Grid:
    grid = Grid(CELL_M)
    grid.cover(-6.0, -6.0, 6.0, 6.0)
    evidence = LaserEvidence(params)
    for scan in scans:
        evidence.fold(grid, scan, at or Pose(x_m=HERE, y_m=HERE, heading_rad=0.0))
    return grid


def sweep(ranges_m: Ranges, first_rad: float = 0.0, step_rad: float = DEGREE) -> LaserScan:
    return LaserScan(angle_min_rad=first_rad, angle_step_rad=step_rad, ranges_m=tuple(ranges_m))


def around(grid: Grid, reach: int = 110) -> np.ndarray:
    """Return the cells around (0, 0), (2 reach + 1, 2 reach + 1)."""
    steps = (np.arange(-reach, reach + 1) + 0.5) * CELL_M
    x, y = np.meshgrid(steps, steps)
    return grid.values_at(np.stack([x.ravel(), y.ravel()], axis=1)).reshape(x.shape)


def value(grid: Grid, row: int, column: int) -> int:
    return int(grid.values_at(np.array([[(column + 0.5) * CELL_M, (row + 0.5) * CELL_M]]))[0])


def test_a_beam_at_two_metres() -> None:
    # Eleven beams of 2.01 m, a degree apart. Down by 10 to 10 cm before the end (1.91 m, column 38); up by 48 in column 40.
    grid = folded(sweep([2.01] * 11, -5 * DEGREE))
    assert [value(grid, 0, c) for c in (0, 1, 38, 39, 40, 41)] == [118, 118, 118, UNKNOWN, 176, UNKNOWN]
    # Half a step beyond the outer beams the sweep ends: at column 30, 5.5 degrees are 2.9 rows.
    assert [value(grid, row, 30) for row in (-3, -2, 0, 2, 3)] == [UNKNOWN, 118, 118, 118, UNKNOWN]
    assert value(grid, 0, -1) == UNKNOWN


def test_values_stay_within_a_byte() -> None:
    grid = folded(*[sweep([2.01] * 11, -5 * DEGREE)] * 40)
    assert (value(grid, 0, 10), value(grid, 0, 40)) == (0, 255)


def test_several_beams_that_end_in_one_cell_count_once() -> None:
    grid = folded(sweep([0.51] * 5, -DEGREE, DEGREE / 2))
    assert value(grid, 0, 10) == UNKNOWN + 48


def test_someone_who_stood_there_fades() -> None:
    grid = folded(*[sweep([1.01] * 3, -DEGREE)] * 3, *[sweep([2.01] * 3, -DEGREE)] * 26)
    assert value(grid, 0, 20) == 0


def test_what_does_not_return_says_nothing_and_long_beams_only_clear() -> None:
    assert (folded(sweep([None] * 181)).cells == UNKNOWN).all()
    assert (folded(sweep([0.0] * 181)).cells == UNKNOWN).all()
    assert (folded(sweep([])).cells == UNKNOWN).all()
    grid = folded(sweep([9.0] * 11, -5 * DEGREE))
    assert (value(grid, 0, 98), value(grid, 0, 101)) == (118, UNKNOWN)  # up to 5 m
    assert (grid.cells <= UNKNOWN).all()


def test_an_end_right_at_the_laser_clears_nothing() -> None:
    grid = folded(sweep([0.06] * 11, -5 * DEGREE))
    assert [(grid.cells < UNKNOWN).sum(), (grid.cells > UNKNOWN).sum()] == [0, 1]


@pytest.mark.parametrize("beams", [360, 361])
@pytest.mark.parametrize("first_rad", [-pi, -pi + DEGREE / 2, 0.0, 1.234])
def test_a_full_turn_leaves_no_seam(beams: int, first_rad: float) -> None:
    # 361 beams: the last meets the first, and neither may count twice.
    grid = folded(sweep([2.0] * beams, first_rad))
    rows, columns = np.mgrid[-110:111, -110:111]
    away = np.hypot(rows, columns) * CELL_M
    cells = around(grid)
    assert (cells[away < 1.89] == 118).all()
    assert (cells[away > 2.08] == UNKNOWN).all()
    assert set(np.unique(cells[away >= 1.89])) <= {118, UNKNOWN, 176}
    assert (cells == 176).sum() > 200  # of the circle's some 220 cells


def test_a_single_beam_without_a_step() -> None:
    grid = folded(sweep([2.01], 0.0, 0.0))
    assert [value(grid, 0, c) for c in (0, 20, 37, 40)] == [118, 118, 118, 176]
    assert (around(grid) != UNKNOWN).sum() == 40  # 39 cells and the end: no wider than the beam


def test_beams_far_apart_speak_for_themselves_only() -> None:
    # Four rangers to the front, left, back and right, as small flying robots have.
    grid = folded(sweep([2.01, 1.01, None, 3.01], 0.0, pi / 2))
    assert [value(grid, 0, c) for c in (20, 40, -20)] == [118, 176, UNKNOWN]
    assert [value(grid, r, 0) for r in (10, 20, -40, -60)] == [118, 176, 118, 176]
    assert (value(grid, 10, 10), value(grid, -10, 10)) == (UNKNOWN, UNKNOWN)


ENDS = st.lists(st.one_of(st.none(), st.floats(0.0, 6.0)), min_size=1, max_size=200)


@given(ENDS, st.floats(-pi, pi), st.sampled_from([DEGREE, 0.5 * DEGREE, 0.1, 2.0]))
def test_the_order_of_the_beams_does_not_matter(ranges: Ranges, first_rad: float, step_rad: float) -> None:
    turns = len(ranges) * step_rad
    ranges = ranges if turns < 2 * pi else ranges[:3]
    last_rad = first_rad + (len(ranges) - 1) * step_rad
    last_rad -= 2 * pi * round(last_rad / (2 * pi))
    one, other = folded(sweep(ranges, first_rad, step_rad)), folded(sweep(ranges[::-1], last_rad, -step_rad))
    assert (one.cells != other.cells).sum() <= 4  # cells on the very edge between two beams


@given(ENDS, st.floats(0.013, 1.5))
def test_a_quarter_turn_of_the_robot_turns_the_grid(ranges: Ranges, heading_rad: float) -> None:
    grids = [
        around(folded(sweep(ranges), at=Pose(x_m=HERE, y_m=HERE, heading_rad=heading_rad + quarter)))
        for quarter in (0.0, pi / 2)
    ]
    assert (np.rot90(grids[0], -1) != grids[1]).sum() <= 4


@given(ENDS, st.floats(-pi, pi), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_only_what_lies_before_an_end_goes_down(ranges: Ranges, heading_rad: float, x_m: float, y_m: float) -> None:
    at = Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad)
    grid = folded(sweep(ranges), at=at)
    rows, columns = np.nonzero(grid.cells < UNKNOWN)
    x = grid.x_min_m + (columns + 0.5) * CELL_M - x_m
    y = grid.y_min_m + (rows + 0.5) * CELL_M - y_m
    away, bearing = np.hypot(x, y), np.arctan2(y, x)
    beam = np.round(((bearing - heading_rad + 0.1) % (2 * pi) - 0.1) / DEGREE)
    longest = max((r for r in ranges if r is not None), default=0.0)
    assert (away <= min(longest, 5.0) + CELL_M).all()
    far = away > 1.0  # nearer, a cell spans several beams
    assert (beam[far] >= -3).all()
    assert (beam[far] <= len(ranges) + 2).all()


def test_the_laser_s_place_in_its_cell_counts() -> None:
    near, far = (
        folded(sweep([2.0] * 11, -5 * DEGREE), at=Pose(x_m=x, y_m=HERE, heading_rad=0.0)) for x in (0.001, 0.049)
    )
    # Cleared up to 1.90 m from where it stands: cell centres at 1.875 m and 1.925 m lie at 1.874 m and 1.876 m.
    assert [value(near, 0, c) for c in (37, 38)] == [118, UNKNOWN]
    assert [value(far, 0, c) for c in (37, 38)] == [118, 118]


def test_the_grid_may_grow_between_sweeps() -> None:
    scan, here = sweep([2.01] * 11, -5 * DEGREE), Pose(x_m=HERE, y_m=HERE, heading_rad=0.0)
    grid = Grid(CELL_M)
    grid.cover(-6.0, -6.0, 6.0, 6.0)
    evidence = LaserEvidence(PARAMS)
    evidence.fold(grid, scan, here)
    grid.cover(-30.0, -30.0, 30.0, 30.0)
    evidence.fold(grid, scan, here)
    assert np.array_equal(around(grid), around(folded(scan, scan)))


def test_a_fine_grid() -> None:
    grid = Grid(0.02)
    grid.cover(-3.0, -3.0, 3.0, 3.0)
    params = replace(PARAMS, cell_m=0.02, laser_range_m=2.0)
    LaserEvidence(params).fold(grid, sweep([1.0] * 91), Pose(x_m=0.01, y_m=0.01, heading_rad=0.0))
    ends = [(0.01 + cos(radians(i)), 0.01 + sin(radians(i))) for i in range(91)]
    assert (grid.values_at(np.array(ends)) == 176).all()
