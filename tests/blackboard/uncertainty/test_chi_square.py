"""Chi-square: tabulated values, closed forms for one, two and four degrees of freedom, and the way there and back."""

import math
from statistics import NormalDist

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.chi_square import chi_square_probability, chi_square_quantile

# NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.4: (probability, degrees of freedom, bound)
TABLE = [
    (0.90, 1, 2.706),
    (0.95, 1, 3.841),
    (0.95, 2, 5.991),
    (0.95, 3, 7.815),
    (0.99, 3, 11.345),
    (0.999, 6, 22.458),
    (0.95, 10, 18.307),
    (0.975, 30, 46.979),
    (0.95, 100, 124.342),
    (0.05, 1, 0.004),
    (0.05, 3, 0.352),
    (0.025, 10, 3.247),
    (0.01, 100, 70.065),
]
PROBABILITIES = st.one_of(st.floats(1e-12, 0.5), st.floats(1e-12, 0.5).map(lambda p: 1 - p))


@pytest.mark.parametrize(("probability", "dimension", "bound"), TABLE)
def test_tabulated_bounds(probability: float, dimension: int, bound: float) -> None:
    assert chi_square_quantile(probability, dimension) == pytest.approx(bound, abs=6e-4)


def test_two_standard_deviations_are_95_percent() -> None:
    """Section 5.2.4.1: 95 % of the measurements fall within twice the standard deviation."""
    assert chi_square_probability(2.0**2, 1) == pytest.approx(0.9544997361036416, rel=1e-13)


@given(PROBABILITIES)
def test_one_degree_is_a_squared_normal(probability: float) -> None:
    expected = NormalDist().inv_cdf((1 - probability) / 2) ** 2  # its own error is that of 1 - p near 0
    assert chi_square_quantile(probability, 1) == pytest.approx(expected, rel=1e-9, abs=1e-15)


@given(PROBABILITIES)
def test_two_degrees_are_exponential(probability: float) -> None:
    assert chi_square_quantile(probability, 2) == pytest.approx(-2 * math.log1p(-probability), rel=1e-12)


@given(st.floats(0.0, 200.0))
def test_four_degrees_in_closed_form(distance: float) -> None:
    expected = -math.expm1(-distance / 2) - distance / 2 * math.exp(-distance / 2)
    assert chi_square_probability(distance, 4) == pytest.approx(expected, rel=1e-12, abs=1e-15)


@given(PROBABILITIES, st.integers(1, 3000))
def test_the_quantile_undoes_the_probability(probability: float, dimension: int) -> None:
    distance = chi_square_quantile(probability, dimension)
    assert chi_square_probability(distance, dimension) == pytest.approx(probability, rel=1e-9)


@given(PROBABILITIES, PROBABILITIES, st.integers(1, 60))
def test_more_confidence_or_more_parameters_allow_more(first: float, second: float, dimension: int) -> None:
    low, high = sorted((first, second))
    assert chi_square_quantile(low, dimension) <= chi_square_quantile(high, dimension) * (1 + 1e-12)
    assert chi_square_quantile(low, dimension) < chi_square_quantile(low, dimension + 1)


def test_the_ends() -> None:
    assert chi_square_quantile(0.0, 5) == 0.0
    assert chi_square_probability(0.0, 5) == 0.0
    assert chi_square_quantile(1e-300, 1) == pytest.approx(0.0, abs=1e-300)  # too short for a double
    assert chi_square_quantile(1 - 2**-53, 2) == pytest.approx(2 * 53 * math.log(2), rel=1e-12)
    assert chi_square_quantile(0.975, 1_000_000) == pytest.approx(1_002_773.70, abs=0.01)


@pytest.mark.parametrize(
    ("probability", "dimension", "said"),
    [
        (1.0, 2, "probability = 1 has no finite bound"),
        (1.5, 2, r"probability = 1.5 is outside \[0, 1\]"),
        (math.nan, 2, "probability = nan must be finite"),
        (0.95, 0, "dimension = 0 must be a whole number of at least 1"),
        (0.95, 2.5, "dimension = 2.5 must be a whole number"),
        (0.95, True, "dimension = True"),
    ],
)
def test_what_has_no_bound_is_refused(probability: float, dimension: int, said: str) -> None:
    with pytest.raises(UncertaintyError, match=said):
        chi_square_quantile(probability, dimension)


def test_a_negative_distance_is_refused() -> None:
    with pytest.raises(UncertaintyError, match=r"distance = -1 is outside \[0, infinity\)"):
        chi_square_probability(-1, 2)
