"""Clusters of lines: distances that wrap, and step 5 by hand."""

from math import degrees, pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.line_clusters import cluster_lines, line_distances, mean_line


def test_step_5_by_hand() -> None:
    # (10 x 30 + 20 x 31 + 10 x 33) / 40 = 31.25 degrees; (10 x 2.00 + 20 x 2.05 + 10 x 2.20) / 40 = 2.075 m
    alpha, rho = mean_line(
        np.radians([30.0, 31.0, 33.0]),
        np.array([2.0, 2.05, 2.2]),
        np.array([10.0, 20.0, 10.0]),
        radians(30.0),
        2.0,
    )
    assert degrees(alpha) == pytest.approx(31.25)
    assert rho == pytest.approx(2.075)


def test_the_mean_across_0_degrees() -> None:
    # 359 and 2 with weights 1 and 2: 1 degree, not 121.
    alpha, rho = mean_line(np.radians([359.0, 2.0]), np.array([1.0, 1.3]), np.array([1.0, 2.0]), radians(359.0), 1.0)
    assert degrees(alpha) == pytest.approx(1.0)
    assert rho == pytest.approx(1.2)


def test_the_mean_across_the_origin() -> None:
    # (40 degrees, 0.05 m) and (220 degrees, 0.03 m) are one line: -0.03 m at 40 degrees. Mean 0.01 m.
    alpha, rho = mean_line(np.radians([40.0, 220.0]), np.array([0.05, 0.03]), np.ones(2), radians(40.0), 0.05)
    assert degrees(alpha) == pytest.approx(40.0)
    assert rho == pytest.approx(0.01)


def test_a_mean_beyond_the_origin_looks_the_other_way() -> None:
    alpha, rho = mean_line(np.radians([40.0, 220.0]), np.array([0.02, 0.06]), np.ones(2), radians(40.0), 0.02)
    assert degrees(alpha) == pytest.approx(220.0)
    assert rho == pytest.approx(0.02)


def test_distances_by_hand() -> None:
    # At a lever of 2 m: 1.5 rad apart is 3 m; with 4 m of rho that is 5 m.
    distance, turn, shift = line_distances(np.array([2.0]), np.array([7.0]), 0.5, 3.0, 2.0)
    assert (distance[0], turn[0], shift[0]) == pytest.approx((5.0, 1.5, 4.0))


def test_lines_on_either_side_of_the_origin_are_near() -> None:
    distance, turn, shift = line_distances(np.array([pi + 0.01]), np.array([0.02]), 0.0, 0.03, 1.0)
    assert (turn[0], shift[0]) == pytest.approx((0.01, -0.05))
    assert distance[0] == pytest.approx(np.hypot(0.01, 0.05))


def test_cells_about_0_degrees_are_one_cluster() -> None:
    alpha = np.radians([0.0, 359.0, 1.0, 90.0, 91.0, 180.0])
    rho = np.array([2.0, 2.0, 2.05, 3.0, 3.0, 1.0])
    centres, nearest = cluster_lines(alpha, rho, 2.9, 0.5)
    assert len(centres) == 3
    assert nearest[0] == nearest[1] == nearest[2]
    assert nearest[3] == nearest[4]


ALPHA, RHO = st.floats(0, 2 * pi), st.floats(0, 5)


@given(ALPHA, RHO, ALPHA, RHO)
def test_distance_is_symmetric_and_zero_to_itself(a: float, r: float, b: float, s: float) -> None:
    there = line_distances(np.array([a]), np.array([r]), b, s, 2.9)[0][0]
    back = line_distances(np.array([b]), np.array([s]), a, r, 2.9)[0][0]
    assert there == pytest.approx(back, abs=1e-9)
    assert line_distances(np.array([a]), np.array([r]), a, r, 2.9)[0][0] == 0.0
