"""The Hough transform on walls whose alpha and rho are known."""

from math import cos, degrees, pi, radians, sin

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.echoes import Echoes, in_order
from knowledge_sources.hough import HoughSpace, accumulate, cell_lines, chance_threshold, heaviest_nearby, heavy_cells

SPACE = HoughSpace(origin_x_m=0.0, origin_y_m=0.0, alpha_cells=360, rho_step_m=0.05, rho_cells=100)


def points(xy: npt.ArrayLike, half_cone_rad: float = 0.0, max_incidence_rad: float = pi / 2) -> Echoes:
    """Return echoes heard from the origin."""
    there = np.array(xy, dtype=np.float64).reshape(-1, 2)
    cones = np.full(len(there), half_cone_rad)
    return in_order(np.zeros_like(there), there, cones, max_incidence_rad, max_incidence_rad)


def wall(alpha_deg: float, rho_m: float, half_length_m: float = 1.0, count: int = 41) -> npt.NDArray[np.float64]:
    alpha, t = radians(alpha_deg), np.linspace(-half_length_m, half_length_m, count)
    return np.stack([rho_m * cos(alpha) - t * sin(alpha), rho_m * sin(alpha) + t * cos(alpha)], axis=1)


@pytest.mark.parametrize(
    ("alpha_deg", "rho_m"),
    [(0.0, 2.02), (90.0, 1.52), (180.0, 3.02), (270.0, 0.52), (37.0, 2.52), (359.0, 1.02), (1.0, 4.02)],
)
def test_a_wall_fills_its_cell(alpha_deg: float, rho_m: float) -> None:
    votes = accumulate(points(wall(alpha_deg, rho_m)), SPACE)
    assert votes[int(alpha_deg), int(rho_m / 0.05)] == 41 == votes.max()


def test_step_2_by_hand() -> None:
    # The point (1, 1): rho = cos(alpha) + sin(alpha) is 1 at 0 and 90 degrees, 1.414 at 45, 0 at 135 and 315, and negative between.
    votes = accumulate(points([(1.0, 1.0)]), SPACE)
    assert votes[45, 28] == 1
    assert votes[20, int((cos(radians(20)) + sin(radians(20))) / 0.05)] == 1
    assert votes[136:315].sum() == 0


def test_every_undirected_line_through_a_point_gets_one_vote() -> None:
    votes = accumulate(points([(0.83, 0.41)]), SPACE)
    assert votes.sum() == 180
    assert ((votes[:180] + votes[180:]).sum(axis=1) == 1).all()


def test_a_wall_through_the_origin_shows_under_both_its_names() -> None:
    # Seen from beside it: alpha 60 and 240 degrees with rho in the first cell; noise of rounding decides which.
    there = wall(60.0, 0.0)
    sensed_from = np.tile([-cos(radians(60)), -sin(radians(60))], (len(there), 1))
    echoes = in_order(sensed_from, there, np.zeros(len(there)), pi / 2, pi / 2)
    votes = accumulate(echoes, SPACE)
    assert votes[60, 0] + votes[240, 0] == 41


def test_rho_counts_from_the_space_s_origin() -> None:
    space = HoughSpace(origin_x_m=1.0, origin_y_m=-2.0, alpha_cells=360, rho_step_m=0.05, rho_cells=100)
    votes = accumulate(points(wall(90.0, 1.02)), space)  # y = 1.02 is 3.02 from y = -2
    assert votes[90, 60] == 41


def test_what_is_further_than_the_space_reaches_has_no_vote() -> None:
    assert accumulate(points([(7.0, 0.0)]), SPACE)[0].sum() == 0


def test_a_cone_votes_for_the_tangents_of_its_arc() -> None:
    # Heard at 2.02 m straight ahead in a cone of 12 degrees: walls that face within 6 degrees of it are 2.02 m away; a wall at 16
    # degrees met the cone's edge, 10 degrees off its normal, at 2.02 cos(10) = 1.99 m.
    votes = accumulate(points([(2.02, 0.0)], radians(6.0), radians(30.0)), SPACE)
    assert [int(np.flatnonzero(votes[a])[0]) for a in (0, 5, 355)] == [40, 40, 40]
    assert np.flatnonzero(votes[16]).tolist() == [int(2.02 * cos(radians(10.0)) / 0.05)] == [39]
    assert votes[37:324].sum() == 0


def test_heavy_cells_come_heaviest_first_and_ties_in_order() -> None:
    votes = np.zeros((360, 4), dtype=np.intp)
    votes[7, 1], votes[300, 2], votes[5, 3], votes[6, 0] = 9, 12, 9, 3
    i, j = heavy_cells(votes, 4)
    assert list(zip(i.tolist(), j.tolist(), strict=True)) == [(300, 2), (5, 3), (7, 1)]


def test_only_the_heaviest_of_neighbours_stays_and_alpha_wraps() -> None:
    votes = np.zeros((360, 10), dtype=np.intp)
    votes[359, 4], votes[1, 4], votes[180, 4], votes[180, 9] = 8, 9, 5, 2
    i, j = heavy_cells(votes, 1)
    kept = heaviest_nearby(votes, i, j, 3, 1)
    assert list(zip(i[kept].tolist(), j[kept].tolist(), strict=True)) == [(1, 4), (180, 4), (180, 9)]


def test_threshold_of_chance() -> None:
    votes = np.array([[0, 4, 4], [0, 4, 4]], dtype=np.intp)
    assert chance_threshold(votes, 6, 3.0) == pytest.approx(4 + 3 * 2)
    assert chance_threshold(votes, 20, 3.0) == 20
    assert chance_threshold(np.zeros((3, 3), dtype=np.intp), 6, 3.0) == 6


def test_cells_stand_for_their_middles() -> None:
    alpha, rho = cell_lines(SPACE, np.array([90]), np.array([10]))
    assert degrees(alpha[0]) == pytest.approx(90.0)
    assert rho[0] == pytest.approx(0.525)


def test_no_points_no_votes() -> None:
    assert accumulate(points([]), SPACE).sum() == 0


@given(st.lists(st.tuples(st.floats(-4, 4), st.floats(-4, 4)), max_size=20), st.floats(0.0, 0.3))
def test_votes_are_within_bounds(xy: list[tuple[float, float]], half_cone_rad: float) -> None:
    votes = accumulate(points(xy, half_cone_rad), SPACE)
    assert votes.min() >= 0
    assert votes.sum() <= 181 * len(xy)
