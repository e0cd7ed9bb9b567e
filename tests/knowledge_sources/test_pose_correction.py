"""What matched lines say of the pose: displacements recovered, a corridor, jumps and outliers."""

from math import cos, pi, radians, sin

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.messages.geometry import Point
from blackboard.messages.model import LineMatch
from blackboard.uncertainty.matrices import Array
from knowledge_sources.line_estimates import LineEstimate, from_ends
from knowledge_sources.line_match import difference
from knowledge_sources.pose_correction import Correction, correct, least_sigmas, stretch_to

SURE = np.diag([1e-6, 1e-6])
PRIOR = np.diag([0.2**2, 0.2**2, 0.1**2])


def wall(start: tuple[float, float], end: tuple[float, float]) -> LineEstimate:
    return from_ends(start, end, SURE, True)


def seen_wrongly(line: LineEstimate, at: tuple[float, float], shift: tuple[float, float], turn: float) -> LineMatch:
    """Return the match of a wall with itself as a robot sees it whose pose must be turned and shifted by this to be right."""
    wrong = line.turned(at[0] + shift[0], at[1] + shift[1], -shift[0], -shift[1], -turn)
    gap = difference(wrong, line, np.zeros((2, 2)))
    c = gap.covariance
    return LineMatch(
        observed="1-0",
        model="1",
        theta_rad=gap.model.theta_rad,
        middle=Point(x_m=wrong.x_m, y_m=wrong.y_m),
        turn_rad=gap.turn_rad,
        offset_m=gap.offset_m,
        covariance=(float(c[0, 0]), float(c[0, 1]), float(c[1, 1])),
        model_sigma_theta_rad=0.0,
        model_sigma_rho_m=0.0,
    )


def solve(matches: list[LineMatch], at: tuple[float, float] = (0.0, 0.0), prior: Array = PRIOR) -> Correction:
    return correct(matches, *at, prior, outlier_sigmas=2.5, least_information=0.1, confidence=0.999)


ROOM = (wall((-2.0, 3.0), (2.0, 3.0)), wall((4.0, -1.0), (4.0, 2.0)))


def test_two_walls_give_the_whole_displacement() -> None:
    found = solve([seen_wrongly(line, (1.0, 0.5), (0.10, -0.20), 0.03) for line in ROOM], (1.0, 0.5))
    assert (found.shift_x_m, found.shift_y_m) == pytest.approx((0.10, -0.20), abs=5e-3)
    assert found.turn_rad == pytest.approx(0.03, abs=1e-3)
    assert found.allowed


@settings(deadline=None)
@given(st.floats(-pi, pi), st.floats(-10, 10), st.floats(-10, 10), st.floats(-0.1, 0.1), st.floats(-0.03, 0.03))
def test_the_correction_turns_with_the_world(way: float, x: float, y: float, shift: float, turn: float) -> None:
    here = solve([seen_wrongly(line, (1.0, 0.5), (shift, 0.05), turn) for line in ROOM], (1.0, 0.5))
    c, s = cos(way), sin(way)
    at = x + c * 1.0 - s * 0.5, y + s * 1.0 + c * 0.5
    turned = c * shift - s * 0.05, s * shift + c * 0.05
    there = solve([seen_wrongly(w.turned(0, 0, x, y, way), at, turned, turn) for w in ROOM], at)
    assert there.turn_rad == pytest.approx(here.turn_rad, abs=1e-7)
    assert there.shift_x_m == pytest.approx(c * here.shift_x_m - s * here.shift_y_m, abs=1e-6)
    assert there.shift_y_m == pytest.approx(s * here.shift_x_m + c * here.shift_y_m, abs=1e-6)


@pytest.mark.parametrize("way_rad", [0.0, 0.7, pi / 2, 2.5])
def test_in_a_corridor_nothing_moves_along_it(way_rad: float) -> None:
    walls = [wall((-3.0, 1.0), (3.0, 1.0)), wall((4.0, -1.0), (-2.0, -1.0))]
    turned = [w.turned(0.0, 0.0, 0.0, 0.0, way_rad) for w in walls]
    c, s = cos(way_rad), sin(way_rad)
    # what drives the pose along the corridor is the prior's own correlation of heading and place
    correlated = PRIOR + 0.01 * np.ones((3, 3))
    found = solve(
        [seen_wrongly(w, (0.0, 0.0), (0.3 * c - 0.1 * s, 0.3 * s + 0.1 * c), 0.02) for w in turned], prior=correlated
    )
    along, across = c * found.shift_x_m + s * found.shift_y_m, -s * found.shift_x_m + c * found.shift_y_m
    assert along == pytest.approx(0.0, abs=1e-4)
    assert across == pytest.approx(0.1, abs=0.01)
    direction = np.array([c, s])
    before, after = (direction @ k[:2, :2] @ direction for k in (correlated, found.covariance))
    assert after == pytest.approx(before, rel=1e-3)


@given(st.lists(st.tuples(st.floats(-pi, pi), st.floats(0.5, 3.0)), max_size=5))
def test_the_covariance_stays_one_and_never_grows(walls: list[tuple[float, float]]) -> None:
    lines = [wall((-1.0, d), (1.0, d)).turned(0.0, 0.0, 0.0, 0.0, way) for way, d in walls]
    after = solve([seen_wrongly(line, (0.0, 0.0), (0.0, 0.0), 0.0) for line in lines]).covariance
    assert (np.linalg.eigvalsh(after) >= -1e-12).all()
    assert (np.diag(after) <= np.diag(PRIOR) * (1 + 1e-9)).all()


def test_a_jump_that_the_uncertainty_does_not_allow() -> None:
    # a metre where 0.2 m is one sigma: 25 sigmas squared, and chi-square of three at 0.999 is 16.27
    found = solve([seen_wrongly(line, (0.0, 0.0), (1.0, 0.0), 0.0) for line in ROOM])
    assert found.distance == pytest.approx(25.0, rel=0.01)
    assert found.bound == pytest.approx(16.27, abs=0.01)
    assert not found.allowed


def test_a_line_that_the_others_contradict_is_left_out() -> None:
    good = [*ROOM, wall((-4.0, -1.0), (-4.0, 2.0)).flipped()]
    found = [seen_wrongly(line, (0.0, 0.0), (0.05, 0.0), 0.0) for line in good]
    found.insert(1, seen_wrongly(ROOM[0], (0.0, 0.0), (0.0, 0.4), 0.0))
    solved = solve(found)
    assert solved.used == (0, 2, 3)
    assert solved.shift_y_m == pytest.approx(0.0, abs=5e-3)


def test_without_matches_nothing_moves() -> None:
    found = solve([])
    assert (found.shift_x_m, found.shift_y_m, found.turn_rad, found.distance) == (0.0, 0.0, 0.0, 0.0)
    assert found.covariance == pytest.approx(PRIOR)


def test_lines_give_no_more_than_they_inherited() -> None:
    sure = np.diag([1e-6, 1e-6, 1e-8])
    stretch = stretch_to(sure, PRIOR, np.array([0.05, 0.1, radians(1.0)]))
    assert stretch == pytest.approx([50.0, 100.0, radians(1.0) * 1e4])
    surer_before = np.diag([0.01**2, 0.01**2, 0.001**2])
    assert stretch_to(sure, surer_before, np.array([0.05, 0.05, 0.1])) == pytest.approx([10.0, 10.0, 10.0])
    assert stretch_to(PRIOR, sure, np.array([0.05, 0.05, 0.1])) == pytest.approx(1.0)


def test_a_line_tells_only_of_what_lies_across_it() -> None:
    corridor = seen_wrongly(wall((0.0, 1.0), (9.0, 1.0)), (4.0, 0.0), (0.0, 0.0), 0.0)  # along x
    far_end = seen_wrongly(wall((9.0, -1.0), (9.0, 1.0)), (4.0, 0.0), (0.0, 0.0), 0.0)  # along y
    slant = seen_wrongly(wall((0.0, 0.0), (3.0, 3.0)), (4.0, 0.0), (0.0, 0.0), 0.0)
    near, known, far = (
        msgspec.structs.replace(match, model_sigma_rho_m=sigma_m, model_sigma_theta_rad=0.01)
        for match, sigma_m in ((corridor, 0.02), (slant, 0.1), (far_end, 0.3))
    )
    assert least_sigmas([near])[0] > 1000.0
    assert least_sigmas([near])[1:] == pytest.approx([0.02, 0.01])
    assert least_sigmas([near, far]) == pytest.approx([0.3, 0.02, 0.01])
    assert least_sigmas([near, far, known]) == pytest.approx([0.1 * 2**0.5, 0.02, 0.01])
