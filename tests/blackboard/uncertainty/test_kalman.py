"""Kalman merge: the source's formulas by hand, and that a merge never knows less than it was given."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.kalman import Estimate, VectorEstimate, measure, merge, merge_vectors, transform_covariance

MEANS = st.floats(-1e3, 1e3)
VARIANCES = st.floats(1e-6, 1e3)
ESTIMATES = st.builds(lambda mean, variance: Estimate(mean=mean, variance=variance), MEANS, VARIANCES)


@st.composite
def vectors(draw: st.DrawFn) -> VectorEstimate:
    """Three parameters, their covariance with a spread of axes turned at random."""
    mean = np.array(draw(st.tuples(MEANS, MEANS, MEANS)))
    roots = np.array(draw(st.lists(st.floats(-2.0, 2.0), min_size=9, max_size=9))).reshape(3, 3)
    return VectorEstimate(mean=mean, covariance=roots @ roots.T + 0.01 * np.eye(3))


def test_one_parameter_by_hand() -> None:
    """Section 5.2.4.1: 10 + (16 - 10) * 4 / (4 + 8) = 12, variance 4 * 8 / 12."""
    merged = merge(Estimate(mean=10.0, variance=4.0), Estimate(mean=16.0, variance=8.0))
    assert merged.mean == pytest.approx(12.0)
    assert merged.variance == pytest.approx(32 / 12)


def test_exact_and_ignorant_sides() -> None:
    exact, vague = Estimate(mean=1.0, variance=0.0), Estimate(mean=7.0, variance=1e12)
    assert merge(exact, vague) == merge(vague, exact) == exact
    assert merge(exact, exact) == exact
    assert merge(Estimate(mean=1e17, variance=1.0), Estimate(mean=0.1, variance=0.0)).mean == 0.1
    assert merge(Estimate(mean=1.0, variance=2.0), vague).mean == pytest.approx(1.0, abs=1e-9)


def test_two_parameters_by_hand() -> None:
    """C = diag(1, 3), K = diag(1/4, 3/4) for an observation of covariance diag(3, 1)."""
    merged = merge_vectors(
        VectorEstimate(mean=np.array([0.0, 0.0]), covariance=np.diag([1.0, 3.0])),
        VectorEstimate(mean=np.array([4.0, 4.0]), covariance=np.diag([3.0, 1.0])),
    )
    assert merged.mean == pytest.approx([1.0, 3.0])
    assert merged.covariance == pytest.approx(np.diag([0.75, 0.75]))


def test_a_measurement_moves_what_it_is_correlated_with() -> None:
    """z = x1, C = [[2, 1], [1, 2]], R = 2: K = (1/2, 1/4), C - K H C = [[1, 1/2], [1/2, 7/4]]."""
    after = measure(
        VectorEstimate(mean=np.zeros(2), covariance=np.array([[2.0, 1.0], [1.0, 2.0]])),
        VectorEstimate(mean=np.array([4.0]), covariance=np.array([[2.0]])),
        [[1.0, 0.0]],
    )
    assert after.mean == pytest.approx([2.0, 1.0])
    assert after.covariance == pytest.approx(np.array([[1.0, 0.5], [0.5, 1.75]]))


def test_a_quarter_turn_swaps_the_axes_of_a_covariance() -> None:
    """Section 5.2.4.2: C_new = F C F' with F the re-reference of the robot's position."""
    f = [[0.0, -1.0, 0.3], [1.0, 0.0, -0.2], [0.0, 0.0, 1.0]]
    assert transform_covariance(np.diag([4.0, 1.0, 0.0]), f) == pytest.approx(np.diag([1.0, 4.0, 0.0]))
    assert transform_covariance(np.diag([4.0, 1.0]), [[3.0, 2.0]]) == pytest.approx(np.array([[40.0]]))


@given(ESTIMATES, ESTIMATES)
def test_a_merge_is_surer_lies_between_and_has_no_order(first: Estimate, second: Estimate) -> None:
    merged = merge(first, second)
    assert 0 < merged.variance <= min(first.variance, second.variance)
    low, high = sorted((first.mean, second.mean))
    assert low - 1e-9 <= merged.mean <= high + 1e-9
    other = merge(second, first)
    assert (other.mean, other.variance) == pytest.approx((merged.mean, merged.variance), rel=1e-9, abs=1e-9)


@given(ESTIMATES, ESTIMATES, ESTIMATES)
def test_three_in_any_order(a: Estimate, b: Estimate, c: Estimate) -> None:
    left, right = merge(merge(a, b), c), merge(a, merge(b, c))
    assert (left.mean, left.variance) == pytest.approx((right.mean, right.variance), rel=1e-9, abs=1e-9)
    assert 1 / left.variance == pytest.approx(1 / a.variance + 1 / b.variance + 1 / c.variance, rel=1e-9)


@given(vectors(), vectors())
def test_a_merge_of_vectors_is_surer_in_every_direction(first: VectorEstimate, second: VectorEstimate) -> None:
    merged = merge_vectors(first, second)
    for given_ in (first, second):
        assert np.linalg.eigvalsh(given_.covariance - merged.covariance)[0] >= -1e-7
    assert np.linalg.eigvalsh(merged.covariance)[0] > 0
    assert np.array_equal(merged.covariance, merged.covariance.T)
    information = np.linalg.inv(first.covariance) + np.linalg.inv(second.covariance)
    assert merged.covariance == pytest.approx(np.linalg.inv(information), rel=1e-5, abs=1e-7)
    other = merge_vectors(second, first)
    assert other.mean == pytest.approx(merged.mean, rel=1e-5, abs=1e-5)


@given(ESTIMATES, ESTIMATES)
def test_a_vector_of_one_is_a_parameter(first: Estimate, second: Estimate) -> None:
    one = [VectorEstimate(mean=np.array([e.mean]), covariance=np.array([[e.variance]])) for e in (first, second)]
    merged, expected = merge_vectors(*one), merge(first, second)
    assert merged.mean[0] == pytest.approx(expected.mean, rel=1e-9, abs=1e-9)
    assert merged.covariance[0, 0] == pytest.approx(expected.variance, rel=1e-6)


def test_bad_input_is_refused_in_one_line() -> None:
    flat = VectorEstimate(mean=np.zeros(2), covariance=np.zeros((2, 2)))
    cases = [
        (lambda: Estimate(mean=math.inf, variance=1.0), "mean = inf must be finite"),
        (lambda: Estimate(mean=0.0, variance=-1.0), r"variance = -1.0 is outside \[0, infinity\)"),
        (lambda: Estimate(mean="east", variance=1.0), "mean = 'east' must be a number, not str"),  # type: ignore[arg-type]
        (lambda: merge(Estimate(mean=0.0, variance=0.0), Estimate(mean=1.0, variance=0.0)), "both exact and differ"),
        (lambda: VectorEstimate(mean=np.zeros(2), covariance=np.eye(3)), "covariance is 3 x 3 and must be 2 x 2"),
        (lambda: merge_vectors(flat, flat), "covariance of the difference is singular"),
        (lambda: measure(flat, flat, [[1.0, 0.0]]), "measurement matrix has 1 rows for 2 measured numbers"),
        (lambda: measure(flat, flat, np.eye(3)), "measurement matrix has 3 columns where 2 are needed"),
        (lambda: transform_covariance(np.eye(2), np.eye(3)), "jacobian has 3 columns where 2 are needed"),
        (lambda: transform_covariance([[1.0, 2.0]], np.eye(2)), "covariance is 1 x 2 and must be square"),
        (
            lambda: merge_vectors(flat, VectorEstimate(mean=np.zeros(1), covariance=np.eye(1))),
            "cannot merge 1 observed parameters with 2 of the model",
        ),
    ]
    for call, said in cases:
        with pytest.raises(UncertaintyError, match=said):
            call()
