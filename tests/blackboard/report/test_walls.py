import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from blackboard.component import WorldTruth
from blackboard.report.walls import free_floor, sample, surface, wall_edges


def lengths(edges: np.ndarray) -> list[float]:
    return sorted(np.hypot(edges[:, 2] - edges[:, 0], edges[:, 3] - edges[:, 1]).round(6).tolist())


def test_the_free_floor_of_the_box_is_what_the_cabinet_leaves(box_truth):
    assert free_floor(box_truth).area == pytest.approx(4 * 3 - 1 * 0.6)


def test_the_walls_of_the_box(box_truth):
    # left and right 3, top 4, bottom 1.5 on either side of the cabinet, cabinet 0.6 + 1 + 0.6
    assert lengths(wall_edges(box_truth)) == [0.6, 0.6, 1.0, 1.5, 1.5, 3.0, 3.0, 4.0]


def test_the_floor_lies_to_the_left_of_every_wall(box_truth):
    edges = wall_edges(box_truth)
    along = edges[:, 2:] - edges[:, :2]
    left = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(along[:, 0], along[:, 1])[:, None]
    middles = (edges[:, :2] + edges[:, 2:]) / 2 + 0.01 * left
    assert shapely.contains_xy(free_floor(box_truth), middles).all()


def test_needless_corners_are_no_corners():
    floor = shapely.Polygon([(2, 0), (4, 0), (4, 1.5), (4.004, 2), (4, 3), (0, 3), (0, 0), (1, 0)])
    truth = WorldTruth(solid=shapely.MultiPolygon(), floor=floor)
    assert lengths(wall_edges(truth)) == [3.0, 3.0, 4.0, 4.0]


@pytest.mark.parametrize("quad_segs", [4, 16, 200])
def test_a_drum_has_no_long_edge_however_finely_it_is_drawn(quad_segs):
    drum = shapely.Point(2, 1.5).buffer(0.4, quad_segs=quad_segs)
    edges = wall_edges(WorldTruth(solid=drum, floor=shapely.box(0, 0, 4, 3)))
    assert lengths(edges)[-4:] == [3.0, 3.0, 4.0, 4.0]
    assert lengths(edges)[-5] < 0.5


def test_a_wall_without_thickness_is_seen_from_both_sides():
    truth = WorldTruth(solid=shapely.LineString([(1, 1), (3, 1)]), floor=shapely.box(0, 0, 4, 3))
    edges = wall_edges(truth).tolist()
    assert [1.0, 1.0, 3.0, 1.0] in edges
    assert [3.0, 1.0, 1.0, 1.0] in edges
    assert surface(truth).distance(shapely.Point(2, 1)) == 0.0


def test_a_world_without_floor_has_no_walls():
    assert len(wall_edges(WorldTruth(solid=shapely.box(0, 0, 9, 9), floor=shapely.box(0, 0, 4, 3)))) == 0


def test_samples_stand_in_the_middle_of_equal_pieces():
    samples = sample(np.array([[0.0, 0.0, 0.2, 0.0], [5.0, 5.0, 5.0, 5.0], [1.0, 0.0, 1.0, -0.12]]), 0.1)
    assert samples.points == pytest.approx(np.array([[0.05, 0], [0.15, 0], [1.0, -0.03], [1.0, -0.09]]))
    assert samples.weights_m == pytest.approx([0.1, 0.1, 0.06, 0.06])
    assert samples.directions == pytest.approx(np.array([[1, 0], [1, 0], [0, -1], [0, -1]]))


coordinate = st.floats(-50, 50, allow_nan=False)


@given(st.lists(st.tuples(coordinate, coordinate, coordinate, coordinate), max_size=5))
def test_samples_weigh_what_the_segments_measure(ends):
    segments = np.array(ends).reshape(-1, 4)
    total_m = np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]).sum()
    assert sample(segments, 0.05).weights_m.sum() == pytest.approx(total_m)
