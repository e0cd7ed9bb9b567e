"""Match and merge: the thesis's formulas by hand, and what must hold however the world lies."""

from math import cos, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from knowledge_sources.line_estimates import LineEstimate, NoiseFloor, from_ends
from knowledge_sources.line_match import MatchLimits, difference, matches, merge_lines

NOTHING = np.zeros((2, 2))
NO_FLOOR = NoiseFloor(theta_rad=1e-6, rho_m=1e-6)
LIMITS = MatchLimits()


def level(x0: float, x1: float, y: float, sigma_theta: float = 0.01, sigma_rho: float = 0.02) -> LineEstimate:
    return from_ends((x0, y), (x1, y), np.diag([sigma_theta**2, sigma_rho**2]), True)


def same(observed: LineEstimate, model: LineEstimate) -> bool:
    return matches(observed, difference(observed, model, NOTHING), LIMITS)


def test_collinearity_at_two_sigmas() -> None:
    # 2 sqrt(0.02^2 + 0.015^2) = 0.05
    model = level(0.0, 4.0, 1.0, sigma_rho=0.015)
    assert same(level(1.0, 3.0, 1.049), model)
    assert not same(level(1.0, 3.0, 1.051), model)


def test_orientation_at_two_sigmas() -> None:
    model = level(-2.0, 2.0, 0.0, sigma_theta=0.0075)
    limit = 2 * sqrt(0.01**2 + 0.0075**2)
    for turn, fits in ((0.98 * limit, True), (-0.98 * limit, True), (1.02 * limit, False)):
        assert same(level(-1.0, 1.0, 0.0).turned(0.0, 0.0, 0.0, 0.0, turn), model) is fits


def test_overlap_at_two_half_lengths_and_a_doorway() -> None:
    # half lengths of 1 m: 2 sqrt(2) m between the middles, that is a gap of 0.83 m
    model = level(0.0, 2.0, 0.0, sigma_theta=1e-4)
    assert same(level(2.82, 4.82, 0.0, sigma_theta=1e-4), model)
    assert not same(level(2.84, 4.84, 0.0, sigma_theta=1e-4), model)
    long = level(0.0, 10.0, 0.0, sigma_theta=1e-5)  # by lengths alone a gap of 2 m would do
    assert same(level(10.9, 12.9, 0.0, sigma_theta=1e-5), long)
    assert not same(level(11.1, 13.1, 0.0, sigma_theta=1e-5), long)


def test_far_ends_of_a_tilted_line_are_less_sure() -> None:
    model = level(0.0, 4.0, 0.0, sigma_theta=0.02)
    assert not same(level(1.5, 2.5, 0.08), model)
    assert same(level(4.0, 5.0, 0.08), model)  # 2.5 m from the middle: 2 sqrt(0.02^2 + 0.02^2 + 0.05^2) = 0.115


def test_both_sides_of_a_wall_are_two_lines() -> None:
    wall = level(0.0, 4.0, 1.0)
    assert same(wall.flipped(), wall)  # the same side, told from the other end
    behind = from_ends((0.0, 1.0), (4.0, 1.0), wall.covariance, False)
    assert not same(behind, wall)
    assert not same(behind.flipped(), wall)


def test_merging_by_hand() -> None:
    # p_m = 1, s_m = 0.04; p_o = 1.05, s_o = 0.02: p = 1 + 0.05 * 0.0016 / 0.002 = 1.04, s^2 = 0.0016 * 0.0004 / 0.002
    merged = merge_lines(level(0.0, 2.0, 1.0, sigma_rho=0.04), level(0.0, 2.0, 1.05, sigma_rho=0.02), NO_FLOOR)
    assert (merged.y_m, merged.theta_rad) == pytest.approx((1.04, 0.0))
    assert merged.covariance == pytest.approx(np.diag([0.01**2 / 2, 3.2e-4]))


def test_a_merged_line_covers_both() -> None:
    merged = merge_lines(level(0.0, 2.0, 0.0), level(1.5, 5.0, 0.0), NO_FLOOR)
    assert merged.ends[0][0] == pytest.approx(0.0)
    assert merged.ends[1][0] == pytest.approx(5.0)


def test_variances_stop_at_the_floor() -> None:
    floor = NoiseFloor(theta_rad=0.005, rho_m=0.01)
    line = level(0.0, 2.0, 0.0)
    for _ in range(50):
        line = merge_lines(line, level(0.0, 2.0, 0.0), floor)
    assert np.sqrt(np.diag(line.covariance)) == pytest.approx([0.005, 0.01])


small = st.floats(-0.05, 0.05)
sigmas = st.floats(0.003, 0.05)


@st.composite
def nearby(draw: st.DrawFn) -> LineEstimate:
    start = draw(st.floats(-1.0, 1.0))
    line = level(start, start + draw(st.floats(0.5, 4.0)), draw(small), draw(sigmas), draw(sigmas))
    line = line.turned(0.0, 0.0, 0.0, 0.0, draw(small))
    return line.flipped() if draw(st.booleans()) else line


@given(nearby(), nearby(), st.floats(-20, 20), st.floats(-20, 20), st.floats(-pi, pi))
def test_nothing_depends_on_where_the_world_lies(
    observed: LineEstimate, model: LineEstimate, x: float, y: float, turn: float
) -> None:
    there = [line.turned(0.0, 0.0, x, y, turn) for line in (observed, model)]
    here, moved = difference(observed, model, NOTHING), difference(there[0], there[1], NOTHING)
    assert (moved.turn_rad, moved.offset_m) == pytest.approx((here.turn_rad, here.offset_m), abs=1e-9)
    assert moved.distance == pytest.approx(here.distance, rel=1e-6, abs=1e-6)
    merged, elsewhere = merge_lines(model, observed, NO_FLOOR), merge_lines(there[1], there[0], NO_FLOOR)
    back = merged.turned(0.0, 0.0, x, y, turn)
    assert (elsewhere.x_m, elsewhere.y_m) == pytest.approx((back.x_m, back.y_m), abs=1e-8)
    assert cos(elsewhere.theta_rad - back.theta_rad) == pytest.approx(1.0)
    assert elsewhere.covariance == pytest.approx(back.covariance, abs=1e-12)


@given(nearby(), nearby())
def test_merging_makes_surer_everywhere(observed: LineEstimate, model: LineEstimate) -> None:
    merged = merge_lines(model, observed, NO_FLOOR)
    c, s = model.direction
    for at in (-2.0, 0.0, 2.0):
        x, y = model.x_m + at * c, model.y_m + at * s
        there = (x - merged.x_m) * merged.direction[0] + (y - merged.y_m) * merged.direction[1]
        assert merged.covariance_at(there)[1, 1] <= model.covariance_at(at)[1, 1] * (1 + 1e-3)
    assert merged.covariance[0, 0] <= min(model.covariance[0, 0], observed.covariance[0, 0]) * (1 + 1e-9)


@given(nearby(), nearby(), nearby())
def test_the_order_of_merging_hardly_matters(a: LineEstimate, b: LineEstimate, c: LineEstimate) -> None:
    one = merge_lines(merge_lines(a, b, NO_FLOOR), c, NO_FLOOR)
    other = merge_lines(merge_lines(a, c, NO_FLOOR), b, NO_FLOOR)
    # exact but for the terms of second order in the tilts, which are up to 0.1 rad
    gap = difference(one, other, NOTHING)
    assert abs(gap.turn_rad) < 0.01
    assert abs(gap.offset_m) < 0.02
    assert one.covariance[0, 0] == pytest.approx(other.covariance[0, 0], rel=0.05)


def test_a_line_across_is_no_match() -> None:
    steep = from_ends((1.0, -1.0), (1.0, 1.0), np.diag([1e-4, 4e-4]), True)
    assert not same(steep, level(0.0, 2.0, 0.0))
