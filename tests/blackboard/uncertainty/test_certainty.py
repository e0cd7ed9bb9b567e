"""Certainty factors: the rules of the source by hand, their bounds and orders."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.certainty import all_of, any_of, certainty_factor, combine, combine_all, through_rule

FACTORS = st.floats(-1.0, 1.0)
INNER = st.floats(-0.95, 0.95)


def test_belief_less_disbelief() -> None:
    """Section 2.5.3.2: CF = MB - MD; 1 is absolute truth, -1 absolute denial, 0 little evidence either way."""
    assert certainty_factor(0.8, 0.3) == pytest.approx(0.5)
    assert (certainty_factor(1, 0), certainty_factor(0, 1), certainty_factor(0, 0)) == (1.0, -1.0, 0.0)


def test_and_or_and_through_a_rule() -> None:
    assert all_of([0.9, -0.2, 0.4]) == -0.2
    assert any_of([0.9, -0.2, 0.4]) == 0.9
    assert through_rule(0.5, 0.8) == pytest.approx(0.4)
    assert through_rule(-0.5, 0.8) == pytest.approx(-0.4)


def test_the_three_cases() -> None:
    assert combine(0.6, 0.5) == pytest.approx(0.8)  # 0.6 + 0.5 - 0.3
    assert combine(-0.6, -0.5) == pytest.approx(-0.8)  # -0.6 - 0.5 + 0.3
    assert combine(0.8, -0.5) == pytest.approx(0.6)  # 0.3 / (1 - 0.5)
    assert combine(0.5, -0.5) == 0.0
    assert combine(1.0, -0.5) == 1.0
    assert combine_all([0.6, 0.5, -0.6]) == pytest.approx(0.5)  # 0.2 / 0.4


@given(FACTORS, FACTORS)
def test_combination_is_bounded_and_has_no_order(a: float, b: float) -> None:
    if {a, b} == {1.0, -1.0}:
        return
    combined = combine(a, b)
    assert -1 <= combined <= 1
    assert combine(b, a) == combined
    assert combine(-a, -b) == -combined
    assert combine(a, 0.0) == a


@given(INNER, INNER, INNER)
def test_three_rules_in_any_order(a: float, b: float, c: float) -> None:
    assert combine_all([a, b, c]) == pytest.approx(combine_all([c, a, b]), abs=1e-9)
    assert combine(combine(a, b), c) == pytest.approx(combine(a, combine(b, c)), abs=1e-9)


@given(INNER, INNER, INNER)
def test_more_evidence_for_never_lowers_it(a: float, b: float, c: float) -> None:
    low, high = sorted((b, c))
    assert combine(a, low) <= combine(a, high) + 1e-12


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0), FACTORS)
def test_bounds_of_the_rest(belief: float, disbelief: float, factor: float) -> None:
    measured = certainty_factor(belief, disbelief)
    assert -1 <= measured <= 1
    assert abs(through_rule(measured, factor)) <= min(abs(measured), abs(factor)) + 1e-15
    assert all_of([measured, factor]) <= any_of([measured, factor])


def test_bad_input_is_refused_in_one_line() -> None:
    cases = [
        (lambda: certainty_factor(1.2, 0.0), r"belief = 1.2 is outside \[0, 1\]"),
        (lambda: certainty_factor(0.2, -0.1), r"disbelief = -0.1 is outside \[0, 1\]"),
        (lambda: combine(1.5, 0.0), r"first certainty factor = 1.5 is outside \[-1, 1\]"),
        (lambda: combine(1.0, -1.0), "certain of the opposite"),
        (lambda: combine_all([]), "no certainty factors were given"),
        (lambda: all_of([0.5, 2.0]), "number 2 certainty factor = 2.0 is outside"),
        (lambda: through_rule(float("nan"), 0.5), "premise certainty factor = nan must be finite"),
        (lambda: combine(True, 0.5), "first certainty factor = True must be a number, not bool"),
    ]
    for call, said in cases:
        with pytest.raises(UncertaintyError, match=said):
            call()
