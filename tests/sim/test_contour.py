"""Bitmaps to polygons: areas, holes, thin walls, slanted edges."""

from math import atan, degrees, pi

import numpy as np
import pytest
import shapely

from sim.contour import outline_free


def test_a_room_is_a_rectangle() -> None:
    free = np.zeros((30, 50), dtype=bool)
    free[5:25, 10:40] = True
    area = outline_free(free)
    assert area.equals(shapely.box(10, 5, 40, 25))
    assert area.area == 600


def test_a_thing_in_the_room_is_a_hole() -> None:
    free = np.ones((30, 30), dtype=bool)
    free[10:20, 10:14] = False
    area = outline_free(free)
    assert len(area.interiors) == 1
    assert not area.contains(shapely.Point(12, 15))
    assert area.bounds == (0, 0, 30, 30)


def test_a_diagonal_wall_one_cell_thin_has_no_holes() -> None:
    free = ~np.eye(40, dtype=bool)
    area = outline_free(free)
    assert len(shapely.get_parts(area)) == 2


@pytest.mark.parametrize("slope", [0.05, 0.3, 0.7, 1.0])
def test_a_slanted_wall_is_straight(slope: float) -> None:
    rows, columns = np.mgrid[0:190, 0:160] + 0.5
    ring = shapely.get_parts(outline_free(rows > 20 + slope * columns))[0].exterior
    corners = np.array(ring.coords)
    edges = np.diff(corners, axis=0)
    deviation = (corners[:, 1] - 20 - slope * corners[:, 0]) / (1 + slope**2) ** 0.5
    slanted = (np.abs(deviation[1:]) < 1.5) & (np.abs(deviation[:-1]) < 1.5)
    length = np.hypot(*edges[slanted].T)
    assert length.sum() == pytest.approx(160 * (1 + slope**2) ** 0.5, rel=0.02)
    bearing = np.arctan2(edges[slanted, 1], edges[slanted, 0]) % pi
    assert degrees(float(np.average(np.abs(bearing - atan(slope)), weights=length))) < 1.0
    assert np.abs(deviation[np.abs(deviation) < 1.5]).max() < 1.1


def test_every_cell_that_is_not_at_the_edge_keeps_its_side() -> None:
    rng = np.random.default_rng(3)
    free = np.kron(rng.random((8, 8)) < 0.6, np.ones((6, 6))).astype(bool)
    area = outline_free(free)
    rows, columns = np.mgrid[0:48, 0:48]
    inside = shapely.contains_xy(area, columns + 0.5, rows + 0.5)
    padded = np.pad(free, 1, mode="edge")
    even = np.all([padded[1 + i : 49 + i, 1 + j : 49 + j] == free for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0)
    even[[0, -1], :] = even[:, [0, -1]] = False
    assert (inside == free)[even].all()


def test_small_things_and_ends_of_thin_walls_stay() -> None:
    free = np.ones((40, 40), dtype=bool)
    free[20, 20] = False
    free[5:20, 10:12] = False
    area = outline_free(free)
    assert len(area.interiors) == 2
    wall = min(area.interiors, key=lambda ring: ring.centroid.y)
    assert wall.bounds == (10, 5, 12, 20)
