"""The grid: growth keeps values, reading by place, the way over the board and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import BoardError
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, UNKNOWN, Grid, tile_id
from blackboard.messages.geometry import pack_array
from blackboard.messages.world import TILE_CELLS, GridTile

CELL_M = 0.05
SIDE_M = TILE_CELLS * CELL_M


def tile(column: int, row: int, value: int, cell_m: float = CELL_M) -> GridTile:
    cells = np.full((TILE_CELLS, TILE_CELLS), value, np.uint8)
    return GridTile(column=column, row=row, cell_m=cell_m, cells=pack_array(cells))


def centre(column: int, row: int) -> tuple[float, float]:
    return ((column + 0.5) * SIDE_M, (row + 0.5) * SIDE_M)


def write(grid: Grid, x_m: float, y_m: float, value: int) -> None:
    grid.cover(x_m, y_m, x_m, y_m)
    flat, width, first_row, first_column = grid.flat()
    flat[(int(np.floor(y_m / CELL_M)) - first_row) * width + int(np.floor(x_m / CELL_M)) - first_column] = value


def test_no_tiles_make_no_grid() -> None:
    assert Grid.from_tiles([]) is None


def test_tiles_stand_where_they_say() -> None:
    grid = Grid.from_tiles([tile(-1, 2, 10), tile(1, 3, 250)])
    assert grid is not None
    assert grid.cells.shape == (2 * TILE_CELLS, 3 * TILE_CELLS)
    assert (grid.x_min_m, grid.y_min_m) == (-SIDE_M, 2 * SIDE_M)
    points = np.array([centre(-1, 2), centre(1, 3), centre(0, 2), centre(7, 7), centre(-5, 2)])
    assert grid.values_at(points).tolist() == [10, 250, UNKNOWN, UNKNOWN, UNKNOWN]


def test_cell_edges_belong_to_the_cell_above_them() -> None:
    cells = np.full((TILE_CELLS, TILE_CELLS), UNKNOWN, np.uint8)
    cells[3, 5] = 255  # x from 0.25 to 0.30, y from 0.15 to 0.20
    grid = Grid.from_tiles([GridTile(column=0, row=0, cell_m=CELL_M, cells=pack_array(cells))])
    assert grid is not None
    points = np.array([[0.251, 0.151], [0.299, 0.199], [0.301, 0.151], [0.251, 0.149]])
    assert grid.values_at(points).tolist() == [255, 255, UNKNOWN, UNKNOWN]
    assert np.argwhere(grid.occupied).tolist() == [[3, 5]]


@pytest.mark.parametrize("direction", [(5, 0), (-5, 0), (0, 5), (0, -5), (-3, 4)])
def test_growth_keeps_values(direction: tuple[int, int]) -> None:
    grid = Grid(CELL_M)
    grid.update(tile(0, 0, 7))
    grid.update(tile(*direction, 200))
    points = np.array([centre(0, 0), centre(*direction)])
    assert grid.values_at(points).tolist() == [7, 200]
    assert (grid.cells != UNKNOWN).sum() == 2 * TILE_CELLS**2


@given(st.lists(st.tuples(st.integers(-6, 6), st.integers(-6, 6), st.integers(0, 255)), min_size=1, max_size=12))
def test_growing_one_by_one_equals_all_at_once(places: list[tuple[int, int, int]]) -> None:
    tiles = [tile(*place) for place in places]
    grown = Grid(CELL_M)
    for one in tiles:
        grown.update(one)
    at_once = Grid.from_tiles(tiles)
    assert at_once is not None
    assert np.array_equal(grown.cells, at_once.cells)
    assert (grown.x_min_m, grown.y_min_m) == (at_once.x_min_m, at_once.y_min_m)


def test_growing_step_by_step_copies_seldom() -> None:
    grid = Grid(CELL_M)
    stores = set()
    for column in range(60):
        grid.update(tile(column, 0, 1))
        stores.add(grid.flat()[1])
    assert len(stores) < 12
    assert grid.cells.shape == (TILE_CELLS, 60 * TILE_CELLS)


def test_what_was_written_goes_over_the_board_and_back() -> None:
    grid = Grid(CELL_M)
    write(grid, -0.01, 4.0, 255)
    write(grid, 10.0, -7.3, 0)
    changed = grid.take_changed()
    assert [tile_id(t) for t in changed] == ["3_-3", "-1_1"]
    assert grid.take_changed() == []
    write(grid, 10.0, -7.3, 1)
    write(grid, 30.0, 30.0, UNKNOWN)  # growth alone changes no tile
    assert [tile_id(t) for t in grid.take_changed()] == ["3_-3"]
    read = Grid.from_tiles(changed)
    assert read is not None
    assert read.values_at(np.array([[-0.01, 4.0], [10.0, -7.3], [0.0, 0.0]])).tolist() == [255, 0, UNKNOWN]


def test_known_part_is_the_smallest_rectangle() -> None:
    grid = Grid(CELL_M)
    assert grid.known_part() is None
    write(grid, 1.025, 2.025, 0)
    write(grid, -1.025, 2.125, 255)
    part = grid.known_part()
    assert part is not None
    assert part.cells.shape == (3, 42)
    assert part.x_min_m == pytest.approx(-1.05)
    assert part.y_min_m == pytest.approx(2.0)
    assert (part.cells[0, -1], part.cells[2, 0]) == (0, 255)


def test_masks_have_their_limits() -> None:
    grid = Grid(CELL_M)
    grid.update(tile(0, 0, EMPTY_MAX))
    grid.update(tile(1, 0, EMPTY_MAX + 1))
    grid.update(tile(2, 0, OCCUPIED_MIN - 1))
    grid.update(tile(3, 0, OCCUPIED_MIN))
    assert grid.empty[0, ::TILE_CELLS].tolist() == [True, False, False, False]
    assert grid.occupied[0, ::TILE_CELLS].tolist() == [False, False, False, True]


def test_a_tile_of_other_cells_is_refused() -> None:
    grid = Grid(CELL_M)
    with pytest.raises(BoardError, match=r"0_0 has cell_m = 0\.1, the grid 0\.05"):
        grid.update(tile(0, 0, 1, cell_m=0.1))


def test_a_tile_far_off_is_refused_and_the_grid_stays_whole() -> None:
    grid = Grid(CELL_M)
    grid.update(tile(0, 0, 9))
    with pytest.raises(BoardError, match="far off"):
        grid.update(tile(90_000, 90_000, 1))
    assert grid.values_at(np.array([centre(0, 0)])).tolist() == [9]
    assert (grid.cells.shape, grid.x_min_m) == ((TILE_CELLS, TILE_CELLS), 0.0)
    grid.update(tile(1, 0, 5))
    assert grid.cells.shape == (TILE_CELLS, 2 * TILE_CELLS)
