"""Normal distance: the source's per-parameter test, cases by hand, and what may not change it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.normal_distance import (
    check_consistency,
    difference_covariance,
    normal_distance,
    parameter_distance,
    parameter_matches,
)

REALS = st.floats(-100.0, 100.0)
SIGMAS = st.floats(0.01, 10.0)


def test_two_parameters_by_hand() -> None:
    """e = (3, 4), C = diag(1, 4) + diag(8, 12): d = 9/9 + 16/16 = 2, below 5.99."""
    c = difference_covariance(np.diag([1.0, 4.0]), np.diag([8.0, 12.0]))
    outcome = check_consistency([3.0, 4.0], c)
    assert outcome.distance == pytest.approx(2.0)
    assert outcome.bound == pytest.approx(5.991, abs=6e-4)
    assert outcome.accepted
    assert not check_consistency([6.0, 8.0], c).accepted  # d = 8
    assert check_consistency([6.0, 8.0], c, confidence=0.99).accepted  # below 9.21


def test_correlated_parameters_by_hand() -> None:
    """C = [[2, 1], [1, 2]], C^-1 = [[2, -1], [-1, 2]] / 3: along the correlation the distance is short, across it long."""
    c = [[2.0, 1.0], [1.0, 2.0]]
    assert normal_distance([1.0, 1.0], c) == pytest.approx(2 / 3)
    assert normal_distance([1.0, -1.0], c) == pytest.approx(2.0)


def test_errors_in_common_do_not_count() -> None:
    """C = Ci - Cij - Cji + Cj: 4 - 1 - 1 + 2 = 4; errors wholly in common leave nothing."""
    assert difference_covariance([[4.0]], [[2.0]], [[1.0]]) == pytest.approx(np.array([[4.0]]))
    assert difference_covariance([[4.0]], [[4.0]], [[4.0]]) == pytest.approx(np.array([[0.0]]))


def test_each_parameter_within_two_standard_deviations() -> None:
    """Section 5.2.4.1: |o - m| <= 2 sqrt(so^2 + sm^2); sigmas 3 and 4 allow 10."""
    assert parameter_matches(10.0, 3.0, 4.0)
    assert parameter_matches(-10.0, 3.0, 4.0)
    assert not parameter_matches(10.000001, 3.0, 4.0)
    assert parameter_matches(14.9, 3.0, 4.0, k=3.0)
    assert parameter_distance(10.0, 3.0, 4.0) == pytest.approx(4.0)
    assert parameter_matches(0.0, 0.0, 0.0)


def test_metres_beside_radians_are_not_singular() -> None:
    assert normal_distance([100.0, 1e-6], np.diag([1e4, 1e-12])) == pytest.approx(2.0)


@given(st.tuples(REALS, REALS, REALS), st.tuples(SIGMAS, SIGMAS, SIGMAS))
def test_independent_parameters_add_their_distances(e: tuple[float, ...], sigmas: tuple[float, ...]) -> None:
    alone = sum(parameter_distance(x, s, 0.0) for x, s in zip(e, sigmas, strict=True))
    assert normal_distance(e, np.diag(np.square(sigmas))) == pytest.approx(alone, rel=1e-9, abs=1e-12)


@given(
    st.tuples(REALS, REALS), SIGMAS, SIGMAS, st.floats(-0.95, 0.95), st.floats(0.0, 2 * math.pi), st.floats(0.1, 9.0)
)
def test_axes_and_units_do_not_matter(
    e: tuple[float, float], s1: float, s2: float, correlation: float, turn: float, unit: float
) -> None:
    c = np.array([[s1 * s1, correlation * s1 * s2], [correlation * s1 * s2, s2 * s2]])
    f = unit * np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    before = normal_distance(e, c)
    assert before >= 0
    assert normal_distance(f @ np.array(e), f @ c @ f.T) == pytest.approx(before, rel=1e-4, abs=1e-6)
    assert normal_distance((-e[0], -e[1]), c) == before


def test_the_share_accepted_is_the_confidence() -> None:
    generator = np.random.default_rng(4)
    c = np.array([[2.0, 0.8, 0.0], [0.8, 1.0, 0.1], [0.0, 0.1, 0.5]])
    differences = generator.multivariate_normal(np.zeros(3), c, size=2000)
    accepted = sum(check_consistency(e, c).accepted for e in differences)
    assert accepted / 2000 == pytest.approx(0.95, abs=0.015)  # three standard deviations of the share


def test_bad_input_is_refused_in_one_line() -> None:
    cases = [
        (lambda: normal_distance([1.0], np.eye(2)), "difference covariance is 2 x 2 and must be 1 x 1"),
        (lambda: normal_distance([1.0, 0.0], [[1.0, 2.0], [2.0, 1.0]]), "negative eigenvalue -1"),
        (lambda: normal_distance([1.0, 0.0], [[1.0, 0.5], [0.0, 1.0]]), "is not symmetric"),
        (lambda: normal_distance([1.0, 0.0], np.diag([1.0, 0.0])), "singular: parameter 1 has no uncertainty"),
        (lambda: normal_distance([1.0, 0.0], np.ones((2, 2))), "singular: some combination"),
        (lambda: normal_distance([math.nan], [[1.0]]), "difference holds a number that is not finite"),
        (lambda: normal_distance([], np.eye(1)), "difference has the shape"),
        (lambda: normal_distance(["wall"], np.eye(1)), "difference must be an array of numbers"),
        (lambda: difference_covariance(np.eye(2), np.eye(2), [[1.0, 0.0]]), "cross covariance has 1 rows where 2"),
        (lambda: difference_covariance([[1.0]], [[1.0]], [[2.0]]), "negative eigenvalue"),
        (lambda: parameter_distance(1.0, 0.0, 0.0), "both sigmas are 0"),
        (lambda: parameter_matches(1.0, -1.0, 0.0), r"first sigma = -1.0 is outside \[0, infinity\)"),
        (lambda: parameter_matches(1.0, 1.0, 1.0, k=-2.0), "k = -2.0 is outside"),
    ]
    for call, said in cases:
        with pytest.raises(UncertaintyError, match=said) as caught:
            call()
        assert "\n" not in str(caught.value)
