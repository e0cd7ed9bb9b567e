"""Frontiers on hand-made grids."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.grid import Grid
from knowledge_sources.frontiers import (
    Frontier,
    could_be_reached,
    frontier_mask,
    frontiers,
    in_sight,
    merged,
    pieces,
    place_to_stand,
    unknown_near,
    within_reach,
)
from knowledge_sources.room_to_move import room_to_move
from knowledge_sources.ways_params import WaysParams


def room(door: tuple[float, float] | None) -> Grid:
    """Return a grid with a room from (-1, -1) to (1, 1), walls two cells thick, and a door in the right one."""
    grid = Grid(0.05)
    grid.cover(-1.5, -1.5, 1.5, 1.5)
    xs = grid.x_min_m + (np.arange(grid.cells.shape[1]) + 0.5) * 0.05
    ys = grid.y_min_m + (np.arange(grid.cells.shape[0]) + 0.5) * 0.05
    x, y = np.meshgrid(xs, ys)
    reach = np.maximum(np.abs(x), np.abs(y))
    grid.cells[reach < 1.1] = 255
    grid.cells[reach < 1.0] = 0
    if door is not None:
        grid.cells[(x > 0) & (reach > 1.0) & (reach < 1.1) & (y > door[0]) & (y < door[1])] = 128
    return grid


def found_in(grid: Grid, least_m: float, depth_cells: int) -> list[Frontier]:
    return frontiers(frontier_mask(grid.cells, depth_cells), grid, least_m)


def test_a_closed_room_has_no_frontier_and_a_door_is_one() -> None:
    assert found_in(room(None), 0.1, 3) == []
    (found,) = found_in(room((-0.3, 0.5)), 0.5, 3)
    assert (found.x_m, found.y_m) == pytest.approx((0.975, 0.1), abs=0.03)
    assert found.length_m == pytest.approx(0.8)
    assert found_in(room((-0.3, 0.5)), 0.9, 3) == []


def test_a_thin_undecided_strip_is_no_frontier() -> None:
    grid = room(None)
    grid.cells[54:74, 60:62] = 128  # two cells wide
    assert found_in(grid, 0.1, 3) == []
    assert len(found_in(grid, 0.1, 2)) == 1  # all round it


def test_every_frontier_cell_is_empty_and_beside_an_undecided_one() -> None:
    grid = room((-0.5, 0.5))
    rows, columns = np.nonzero(frontier_mask(grid.cells, 3))
    assert len(rows) == 20
    assert (grid.cells[rows, columns] == 0).all()
    assert (grid.cells[rows, columns + 1] == 128).all()


def test_the_robot_stands_where_all_is_empty_or_nowhere() -> None:
    grid = room((-0.3, 0.5))
    stand = place_to_stand(grid, 0.975, 0.1, 0.3, 0.9)
    assert stand is not None
    assert stand.x_m == pytest.approx(0.675, abs=0.051)
    assert abs(stand.y_m - 0.1) < 0.1
    assert place_to_stand(grid, 0.975, 0.1, 0.3, 0.2) is None  # not so near
    assert place_to_stand(grid, 0.0, 0.0, 1.1, 5.0) is None  # no room for such a robot
    assert place_to_stand(grid, 40.0, 40.0, 0.3, 1.0) is None  # far outside


def test_the_robot_does_not_stand_behind_a_wall() -> None:
    grid = room(None)
    grid.cells[(grid.cells == 128)] = 0  # free outside as well
    inside, outside = place_to_stand(grid, 0.9, 0.0, 0.3, 0.9), place_to_stand(grid, 1.15, 0.0, 0.3, 0.9)
    assert inside is not None
    assert outside is not None
    assert inside.x_m == pytest.approx(0.675, abs=0.051)
    assert outside.x_m == pytest.approx(1.425, abs=0.051)
    place = (1.3, 0.0)
    there = place_to_stand(grid, *place, 0.3, 0.65)
    assert there is not None
    column = round((1.1 - grid.x_min_m) / 0.05)
    grid.cells[:, column:] = 255  # nothing is free outside, except a niche too small for the robot
    grid.cells[62:67, column + 3 : column + 6] = 0
    assert place_to_stand(grid, *place, 0.3, 0.7) is None  # room enough at (0.67, 0), and a wall between
    assert place_to_stand(grid, *place, 0.3, 0.7, wall_m=0.4) is not None  # an end of a line, in its wall's band


def test_frontiers_reach_to_the_edge_of_what_is_stored() -> None:
    grid = Grid(0.05)
    grid.cover(0.0, 0.0, 3.1, 3.1)  # one tile, all of it empty: nobody knows what lies beyond
    grid.cells[:] = 0
    (found,) = found_in(grid, 0.5, 3)
    assert len(pieces(frontier_mask(grid.cells, 3))[0]) == 4 * 63
    assert found.length_m == pytest.approx(3.2 * 2**0.5, abs=0.1)


def test_the_robot_could_come_to_what_lies_behind_a_gap_that_it_fits_through() -> None:
    for door, beyond in (((-0.3, 0.5), True), ((-0.25, 0.25), False), (None, False)):
        part = room(door).known_part()
        assert part is not None
        place = room_to_move(part, 0.3, (0.0, 0.0), WaysParams())
        fresh = could_be_reached(place, 0.3, 0.1)
        assert fresh.any() == beyond, door
        assert not (fresh & place.open).any()


def test_a_pocket_too_small_to_enter_is_left_out() -> None:
    grid = room(None)
    grid.cells[58:62, 58:62] = 128  # undecided cells
    part = grid.known_part()
    assert part is not None
    place = room_to_move(part, 0.3, None, WaysParams())
    held_m2 = could_be_reached(place, 0.3, 0.0).sum() * 0.05**2
    assert 0.2 < held_m2 < 0.6  # closed within 0.21 m of them
    assert could_be_reached(place, 0.3, held_m2 + 0.01).sum() == 0
    near = within_reach(place.open, could_be_reached(place, 0.3, 0.1), 0.1, 0.05)
    assert near.any()
    assert not near[place.open].all()


def test_the_frontier_around_a_place_is_measured() -> None:
    grid = room((-0.3, 0.5))
    mask = frontier_mask(grid.cells, 3)
    assert unknown_near(mask, grid, 1.0, 0.1, 1.0) == pytest.approx(0.8)
    assert unknown_near(mask, grid, 1.0, -0.3, 0.2) == pytest.approx(0.2, abs=0.051)
    assert unknown_near(mask, grid, -1.0, 0.0, 0.5) == 0.0
    assert unknown_near(mask, grid, -90.0, 0.0, 0.5) == 0.0


def test_near_places_are_one_group() -> None:
    assert merged([(0.0, 0.0), (5.0, 0.0), (0.3, 0.0)], 0.6) == [[(0.0, 0.0), (0.3, 0.0)], [(5.0, 0.0)]]


@given(st.lists(st.lists(st.booleans(), min_size=7, max_size=7), min_size=1, max_size=7))
def test_pieces_share_the_cells_out_and_do_not_touch(rows: list[list[bool]]) -> None:
    mask = np.array(rows)
    found = [{(int(r), int(c)) for r, c in piece} for piece in pieces(mask)]
    assert sum(map(len, found)) == mask.sum()
    for i, one in enumerate(found):
        for other in found[i + 1 :]:
            assert all(max(abs(a - c), abs(b - d)) > 1 for a, b in one for c, d in other)


@given(st.integers(0, 2**32 - 1), st.floats(0.05, 0.4))
def test_the_place_to_stand_is_the_nearest_that_touches_nothing(seed: int, radius_m: float) -> None:
    grid = Grid(0.05)
    grid.cover(0.0, 0.0, 3.1, 3.1)
    grid.cells[:] = np.where(np.random.default_rng(seed).random(grid.cells.shape) < 0.01, 255, 0)
    centres = (np.arange(64) + 0.5) * 0.05
    x, y = np.meshgrid(centres, centres)
    edge = np.minimum(np.minimum(x, y), np.minimum(3.2 - x, 3.2 - y))
    full = np.stack([x[grid.cells == 255], y[grid.cells == 255]], axis=1)
    apart = np.hypot(x[..., None] - full[:, 0], y[..., None] - full[:, 1]).min(axis=2, initial=9.0)

    def nearest_m(margin_m: float) -> float:
        """A body that just touches may count as either."""
        clear = (apart > radius_m + margin_m) & (edge >= radius_m + margin_m)
        return float(np.where(clear, np.hypot(x - 1.6, y - 1.6), 9.0).min())

    stand, seeing = (place_to_stand(grid, 1.6, 1.6, radius_m, 1.0, wall_m=wall_m) for wall_m in (2.0, 0.0))
    if seeing is not None:
        assert stand is not None
        away_m = np.hypot(seeing.x_m - 1.6, seeing.y_m - 1.6)
        assert away_m >= np.hypot(stand.x_m - 1.6, stand.y_m - 1.6)
        assert in_sight(grid, (seeing.x_m, seeing.y_m), (1.6, 1.6), away_m)
    if stand is None:
        assert nearest_m(1e-9) > 1.0
    else:
        away_m = np.hypot(stand.x_m - 1.6, stand.y_m - 1.6)
        assert nearest_m(-1e-9) - 1e-9 <= away_m <= min(nearest_m(1e-9), 1.0) + 1e-9
