import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.report.visibility import viewpoints, visible
from blackboard.report.walls import Samples, sample, wall_edges


def seen_m(truth, positions: list[tuple[float, float]], range_m: float) -> float:
    edges = wall_edges(truth)
    samples = sample(edges, 0.01)
    return float(samples.weights_m[visible(samples, edges, np.array(positions), range_m)].sum())


def test_from_the_middle_all_but_the_cabinets_shadow_is_seen(box_truth):
    # From (2, 1) the edges of the cabinet's top (y = 0.6) are passed at 0.4 / 0.5, so that the side walls below 0 are
    # hidden by the floor's end: the rays meet y = 0 at x = 2 -+ 1.25. Hidden: the bottom from 0.75 to 1.5 and from 2.5 to
    # 3.25, and both ends of the cabinet.
    total_m = 2 * 0.6 + 1 + 2 * 1.5 + 2 * 3 + 4
    assert seen_m(box_truth, [(2.0, 1.0)], 10.0) == pytest.approx(total_m - 2 * 0.75 - 2 * 0.6, abs=0.04)


def test_range_limits_what_is_seen(box_truth):
    # 0.5 m from the left wall, range 1 m: half a chord is sqrt(1 - 0.25)
    assert seen_m(box_truth, [(0.5, 1.5)], 1.0) == pytest.approx(2 * np.sqrt(0.75), abs=0.03)
    assert seen_m(box_truth, [(0.5, 1.5)], 0.4) == 0.0


def test_walls_are_not_seen_from_behind(box_truth):
    assert seen_m(box_truth, [(2.0, 0.3)], 0.45) == 0.0  # inside the cabinet


def test_more_positions_see_no_less(box_truth):
    one = seen_m(box_truth, [(2.0, 1.0)], 10.0)
    both = seen_m(box_truth, [(2.0, 1.0), (0.3, 0.3)], 10.0)
    assert both > one + 0.5


@settings(max_examples=30, deadline=None)
@given(st.floats(0.1, 3.9), st.floats(0.8, 2.9), st.floats(-np.pi, np.pi))
def test_turning_the_world_changes_nothing(x_m, y_m, turn_rad):
    edges = np.array([[0.0, 0.0, 4.0, 0.0], [4.0, 0.0, 4.0, 3.0], [4.0, 3.0, 0.0, 3.0], [0.0, 3.0, 0.0, 0.0]])
    edges = np.concatenate([edges, [[2.5, 0.6, 1.5, 0.6], [1.5, 0.6, 2.5, 0.6]]])
    matrix = np.array([[np.cos(turn_rad), np.sin(turn_rad)], [-np.sin(turn_rad), np.cos(turn_rad)]])
    turned = np.concatenate([edges[:, :2] @ matrix, edges[:, 2:] @ matrix], axis=1)
    position = np.array([[x_m, y_m]])
    straight, other = sample(edges, 0.1), sample(turned, 0.1)
    before = visible(straight, edges, position, 10.0)
    after = visible(other, turned, position @ matrix, 10.0)
    assert (before != after).sum() <= 2  # a ray that grazes a corner may fall on either side


def test_no_samples_and_no_positions_see_nothing():
    nothing = Samples(np.empty((0, 2)), np.empty((0, 2)), np.empty(0))
    assert visible(nothing, np.empty((0, 4)), np.zeros((1, 2)), 10.0).tolist() == []
    wall = np.array([[0.0, 1.0, 1.0, 1.0]])
    assert not visible(sample(wall, 0.1), wall, np.empty((0, 2)), 10.0).any()


def test_a_viewpoint_stands_for_each_square():
    path = np.array([[0, 0.01, 0.01, 0], [1, 0.2, 0.2, 0], [2, 0.3, 0.2, 0], [3, 0.1, 0.1, 0], [4, -0.1, 0.1, 0]])
    assert viewpoints(path).tolist() == [[0.01, 0.01], [0.3, 0.2], [-0.1, 0.1]]
