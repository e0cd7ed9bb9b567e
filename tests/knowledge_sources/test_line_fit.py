"""Refit and bends."""

from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest

from knowledge_sources.echoes import Array, Echoes, expected_ranges, in_order, met
from knowledge_sources.line_fit import bend, refit, refit_all

ALPHA, RHO = radians(20.0), 3.0


def cones_along_a_wall(noise_m: float = 0.0) -> Echoes:
    """Return what cones hear that pass a wall 20 degrees aside, some through their edges."""
    rng = np.random.default_rng(3)
    t = np.linspace(-1.5, 1.5, 60)
    here = np.stack([0.4 * t - t * sin(ALPHA), t * cos(ALPHA)], axis=1)
    bearing = ALPHA + np.tile(np.radians([-25.0, -10.0, 0.0, 4.0, 15.0, 30.0]), 10)
    ahead = np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    cones = np.full(60, radians(6.0))
    heard = in_order(here, here + ahead, cones, radians(30.0), pi / 2)
    ranges = expected_ranges(heard, ALPHA, RHO, np.array([-9.0]), np.array([9.0])) + noise_m * rng.standard_normal(60)
    return Echoes(heard.x_m, heard.y_m, ranges, heard.bearing_rad, heard.half_cone_rad, heard.max_incidence_rad)


def test_cones_give_back_their_wall_exactly() -> None:
    fit, along, out = refit(cones_along_a_wall(), ALPHA + radians(4.0), RHO - 0.08, rounds=6)
    assert fit.alpha_rad == pytest.approx(ALPHA, abs=1e-6)
    assert fit.rho_m == pytest.approx(RHO, abs=1e-6)
    assert out == pytest.approx(np.full(60, RHO), abs=1e-6)
    assert along.min() < -1.5


def test_uncertainty_is_that_of_least_squares() -> None:
    fit, along, _ = refit(cones_along_a_wall(0.01), ALPHA, RHO, rounds=4)
    assert fit.spread_m == pytest.approx(0.01, rel=0.3)
    assert fit.tilt_rad == pytest.approx(0.01 / (float(along.std()) * sqrt(60)), rel=0.5)
    assert abs(fit.alpha_rad - ALPHA) < 4 * fit.tilt_rad


def test_outliers_do_not_turn_the_line() -> None:
    heard = cones_along_a_wall(0.01)
    ranges = heard.range_m.copy()
    ranges[:6] -= 0.3
    spoilt = Echoes(heard.x_m, heard.y_m, ranges, heard.bearing_rad, heard.half_cone_rad, heard.max_incidence_rad)
    fit, _, _ = refit(spoilt, ALPHA, RHO, rounds=6)
    assert abs(fit.alpha_rad - ALPHA) < radians(1.0)


def test_one_point_says_nothing_of_the_direction() -> None:
    here, there = np.zeros((5, 2)), np.tile([[2.0, 0.0]], (5, 1))
    fit, _, _ = refit(in_order(here, there, np.zeros(5), pi / 2, pi / 2), 0.1, 2.0, rounds=3)
    assert fit.tilt_rad == pi


def test_all_at_once_come_to_the_same_lines() -> None:
    heard = cones_along_a_wall()
    line = np.repeat([0, 1], len(heard))
    twice = heard.join(heard)
    alpha, rho = ALPHA + np.radians([3.0, -2.0]), RHO + np.array([-0.03, 0.04])
    for _ in range(8):
        beyond, along = met(twice, alpha[line], rho[line])
        alpha, rho = refit_all(line, beyond, along, alpha, rho, 0.3)
    assert alpha == pytest.approx([ALPHA, ALPHA], abs=1e-4)
    assert rho == pytest.approx([RHO, RHO], abs=1e-4)


def wavy(offsets: list[float]) -> tuple[Array, Array]:
    return np.arange(len(offsets)) / 10.0, np.array(offsets) + 0.003 * (-1.0) ** np.arange(len(offsets))


def test_a_step_is_found_where_it_is() -> None:
    along, out = wavy([0.0] * 8 + [0.1] * 12)
    at, better = bend(along, out, 3)
    assert at == 8
    assert better > 50


def test_a_bend_is_found_where_it_is() -> None:
    along, out = wavy([0.0] * 10 + [0.04 * k for k in range(1, 11)])
    at, better = bend(along, out, 3)
    assert 9 <= at <= 12
    assert better > 20


def test_a_straight_line_has_no_bend() -> None:
    along, out = wavy([0.02 * k for k in range(20)])
    assert bend(along, out, 3)[1] < 4


def test_too_few_points_have_no_bend() -> None:
    assert bend(np.arange(5.0), np.array([0.0, 0, 0, 9, 9]), 3) == (0, 0.0)
