from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.component import WorldTruth
from blackboard.grid import KnownPart
from blackboard.messages.geometry import Pose
from blackboard.report.scores import area_decided, grid_score, line_score, score_table, sensing_range_m

START = Pose(x_m=1.0, y_m=2.0, heading_rad=0.0)
ALONG = np.array([[0.0, 1.0, 2.0, 0.0], [1.0, 3.0, 2.0, 0.0]])  # two places that see all but the bottom's shadow


def test_cells_of_the_box_by_hand(make_grid, box_truth):
    # Row at y = 1.5: from x = -0.3, cells of 0.1 m; the wall's surface is at x = 0.
    #          -0.25 -0.15 -0.05 0.05 0.15 0.25
    row = [255, 255, 255, 255, 255, 128]
    score = grid_score(make_grid([row], -0.3, 1.45, 0.1), box_truth)
    assert (score.decided, score.occupied, score.empty) == (5, 5, 0)
    assert score.occupied_right_fraction == pytest.approx(2 / 5)  # 5 cm off on either side, the others 15 cm and more
    assert score.empty_right_fraction is None
    row = [0, 0, 0, 0, 0, 128]
    score = grid_score(make_grid([row], -0.3, 1.45, 0.1), box_truth)
    assert score.empty_right_fraction == pytest.approx(3 / 5)  # half a cell into the wall is still right


def test_the_cabinet_is_not_empty_and_its_inside_is_no_surface(make_grid, box_truth):
    inside = make_grid([[0]], 1.95, 0.25, 0.1)  # centre (2, 0.3): 0.3 m from the cabinet's surface
    assert grid_score(inside, box_truth).right_fraction == 0.0
    assert grid_score(make_grid([[255]], 1.95, 0.25, 0.1), box_truth).right_fraction == 0.0
    assert grid_score(make_grid([[255]], 1.95, 0.45, 0.1), box_truth).right_fraction == 1.0  # 0.1 m from it


def test_cells_that_are_not_sure_do_not_count(make_grid, box_truth):
    score = grid_score(make_grid([[65, 100, 128, 160, 191]], 1.0, 1.0), box_truth)
    assert score.decided == 0
    assert score.right_fraction is None


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_grid_drawn_from_the_truth_scores_full_and_its_negative_badly(seed):
    floor = shapely.box(0.0, 0.0, 4.0, 3.0)
    truth = WorldTruth(solid=shapely.difference(shapely.box(-1, -1, 5, 4), floor), floor=floor)
    rng = np.random.default_rng(seed)
    x_m, y_m = np.meshgrid(-0.2 + 0.05 * (np.arange(88) + 0.5), -0.2 + 0.05 * (np.arange(68) + 0.5))
    surface = shapely.distance(floor.exterior, shapely.points(x_m, y_m)) < 0.05
    inside = shapely.contains_xy(floor, x_m, y_m)
    cells = np.where(surface, 255, np.where(inside, 0, 128)).astype(np.uint8)
    cells[rng.random(cells.shape) < 0.3] = 128
    assert grid_score(KnownPart(cells, -0.2, -0.2, 0.05), truth).right_fraction == 1.0
    negative = np.where(cells == 0, 255, np.where(cells == 255, 0, 128)).astype(np.uint8)
    assert grid_score(KnownPart(negative, -0.2, -0.2, 0.05), truth).right_fraction < 0.2


def test_every_wall_that_is_seen_can_be_found(make_line, box_truth):
    walls = [(0, 0, 1.5, 0), (1.5, 0.6, 2.5, 0.6), (2.5, 0, 4, 0), (4, 0, 4, 3), (4, 3, 0, 3), (0, 3, 0, 0)]
    walls += [(1.5, 0, 1.5, 0.6), (2.5, 0, 2.5, 0.6)]
    score = line_score([make_line(*map(float, w)).value for w in walls], box_truth, ALONG, 10.0)
    assert score.found_fraction == pytest.approx(1.0)
    assert score.spurious_fraction == pytest.approx(0.0)
    assert score.lines_m == pytest.approx(15.2)


def test_the_upper_wall_alone_is_its_share_of_what_is_seen(make_line, box_truth):
    score = line_score([make_line(0.0, 3.0, 4.0, 3.0).value], box_truth, ALONG, 10.0)
    assert score.found_fraction == pytest.approx(4.0 / score.visible_m)


@pytest.mark.parametrize(
    ("start", "end", "spurious"),
    [
        ((1.0, 2.96), (3.0, 2.96), 0.0),  # 4 cm off
        ((1.0, 2.94), (3.0, 2.94), 1.0),  # 6 cm off
        ((1.0, 2.96), (2.0, 3.0), 0.0),  # 2.3 degrees
        ((1.0, 2.96), (1.6, 3.0), 1.0),  # 3.8 degrees
        ((3.0, 3.0), (5.0, 3.0), 0.475),  # a metre and 5 cm of its two lie on the wall: 19 of 40 samples lie off
        ((0.5, 1.5), (3.5, 1.5), 1.0),  # across the room
        ((3.0, 2.96), (1.0, 2.96), 0.0),  # drawn the other way
    ],
)
def test_a_line_off_every_wall_is_spurious(make_line, box_truth, start, end, spurious):
    score = line_score([make_line(*start, *end).value], box_truth, ALONG, 10.0)
    assert score.spurious_fraction == pytest.approx(spurious, abs=1e-9)
    if spurious == 1.0:
        assert score.found_fraction == 0.0


def test_no_lines_find_nothing_and_are_not_spurious(box_truth):
    score = line_score([], box_truth, ALONG, 10.0)
    assert score.found_fraction == 0.0
    assert score.spurious_fraction is None


def test_out_of_range_nothing_is_asked_for(make_line, box_truth):
    score = line_score([make_line(0.0, 3.0, 4.0, 3.0).value], box_truth, ALONG, 0.5)
    assert score.visible_m == 0.0
    assert score.found_fraction is None


def test_short_walls_are_not_asked_for_but_lines_on_them_are_right(make_line):
    post = shapely.box(1.0, 1.0, 1.4, 1.4)
    truth = WorldTruth(solid=post, floor=shapely.box(0, 0, 40, 40))
    score = line_score([make_line(1.0, 1.0, 1.4, 1.0).value], truth, np.array([[0.0, 1.2, 0.5, 0.0]]), 3.0)
    assert score.found_fraction == 0.0  # what is asked for are the room's walls
    assert score.spurious_fraction == 0.0


def test_a_line_without_length_counts_for_nothing(make_line, box_truth):
    score = line_score([make_line(1.0, 3.0, 1.0, 3.0).value], box_truth, ALONG, 10.0)
    assert score.lines_m == 0.0
    assert score.found_fraction == 0.0


def test_half_a_room_decided_is_a_half(make_grid, box_truth):
    cells = np.full((60, 80), 128)  # the floor in cells of 5 cm
    cells[30:, :] = 0  # the upper 4 x 1.5 m
    grid = make_grid(cells)
    assert area_decided(grid, box_truth, START) == pytest.approx(6.0 / 11.4, abs=1e-3)
    assert area_decided(make_grid(np.zeros((60, 80))), box_truth, START) == 1.0
    assert area_decided(make_grid(np.zeros((10, 10)), 30.0, 30.0), box_truth, START) == 0.0
    moved = Pose(x_m=30.0, y_m=30.0, heading_rad=0.0)
    assert area_decided(make_grid(np.zeros((60, 80)), 30.0, 30.0), box_truth, START, map_from_world=moved) == 1.0
    assert area_decided(None, box_truth, START) == 0.0


def test_what_cannot_be_reached_is_not_asked_for(make_grid):
    wall = shapely.box(1.9, 0.0, 2.1, 2.6)  # leaves a gap of 0.4 m
    truth = WorldTruth(solid=wall, floor=shapely.box(0.0, 0.0, 4.0, 3.0))
    cells = np.full((60, 80), 128)
    cells[:, :38] = 0
    grid = make_grid(cells)
    assert area_decided(grid, truth, START) < 0.55
    assert area_decided(grid, truth, START, radius_m=0.25) == pytest.approx(1.0, abs=0.02)
    nowhere = Pose(x_m=20.0, y_m=0.0, heading_rad=0.0)
    assert area_decided(grid, truth, nowhere) == 0.0


def test_the_side_of_a_closed_door_counts_where_the_robot_ends(make_grid, result):
    door = shapely.box(1.9, 0.0, 2.1, 3.0)
    truth = WorldTruth(solid=door, floor=shapely.box(0.0, 0.0, 4.0, 3.0))
    cells = np.full((60, 80), 128)
    cells[:, :38] = 0  # the left side is known
    for ends_x_m, share in ((0.5, 1.0), (3.5, 0.0)):
        path = np.array([[0.0, 0.5, 1.5, 0.0], [9.0, ends_x_m, 1.5, 0.0]])
        rows = score_table(replace(result, grid=make_grid(cells), truth=truth, true_trajectory=path))
        assert rows["reachable_decided_fraction"] == pytest.approx(share, abs=0.02)


def test_the_table_rows_come_with_truth_only(result):
    rows = score_table(result)
    assert set(rows) == {
        "grid_right_fraction",
        "reachable_decided_fraction",
        "reachable_decided_aligned_fraction",
        "walls_found_fraction",
        "lines_spurious_fraction",
    }
    assert all(0.0 <= value <= 1.0 for value in rows.values())
    assert rows["lines_spurious_fraction"] == 0.0
    assert score_table(replace(result, truth=None)) == {}
    bare = replace(result, grid=None, lines=[], true_trajectory=None, trajectory=np.empty((0, 4)))
    assert score_table(bare) == {}


def test_the_range_is_that_of_the_farthest_sensor(robot):
    assert sensing_range_m(robot) == 10.0
