"""Bayes: the theorem by hand, both its forms agreeing, evidence in any order."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.bayes import (
    likelihood_ratio,
    odds,
    odds_after,
    posterior,
    posterior_after,
    probability,
)

NAMES = ("door", "wall", "person")
LIKELIHOODS = st.fixed_dictionaries({name: st.floats(0.01, 1.0) for name in NAMES})
PRIORS = st.tuples(*[st.floats(0.01, 1.0)] * 3).map(
    lambda weights: dict(zip(NAMES, (w / math.fsum(weights) for w in weights), strict=True))
)


def test_three_hypotheses_by_hand() -> None:
    """0.5 * 0.2, 0.3 * 0.6, 0.2 * 0.1 = 0.10, 0.18, 0.02 of 0.30."""
    after = posterior({"door": 0.5, "wall": 0.3, "person": 0.2}, {"wall": 0.6, "door": 0.2, "person": 0.1})
    assert list(after) == ["door", "wall", "person"]
    assert after == pytest.approx({"door": 1 / 3, "wall": 0.6, "person": 1 / 15})


def test_two_pieces_of_evidence_by_hand() -> None:
    """Even odds, twice evidence four times as likely when true: 16 to 1."""
    seen = {"door": 0.8, "wall": 0.2}
    assert posterior_after({"door": 0.5, "wall": 0.5}, [seen, seen])["door"] == pytest.approx(16 / 17)
    assert odds_after(odds(0.5), [likelihood_ratio(0.8, 0.2)] * 2) == pytest.approx(16.0)
    assert posterior_after({"door": 0.25, "wall": 0.75}, []) == {"door": 0.25, "wall": 0.75}


def test_densities_so_small_that_their_products_vanish() -> None:
    after = posterior({"door": 0.5, "wall": 0.5}, {"door": 3e-320, "wall": 1e-320})
    assert after["door"] == pytest.approx(0.75, rel=1e-3)
    assert posterior({"door": 0.3, "wall": 0.7}, {"door": 5e-324, "wall": 5e-324}) == {"door": 0.3, "wall": 0.7}


def test_a_hypothesis_that_is_ruled_out_stays_out() -> None:
    after = posterior({"door": 0.0, "wall": 1.0}, {"door": 1.0, "wall": 1e-9})
    assert after == {"door": 0.0, "wall": 1.0}


@given(PRIORS, LIKELIHOODS)
def test_a_posterior_is_a_probability(priors: dict[str, float], likelihoods: dict[str, float]) -> None:
    after = posterior(priors, likelihoods)
    assert math.fsum(after.values()) == pytest.approx(1.0)
    assert all(0 <= value <= 1 for value in after.values())
    scaled = posterior(priors, {name: 7.0 * value for name, value in likelihoods.items()})
    assert scaled == pytest.approx(after)


@given(PRIORS, LIKELIHOODS)
def test_the_order_of_names_changes_no_bit(priors: dict[str, float], likelihoods: dict[str, float]) -> None:
    turned = posterior(dict(reversed(priors.items())), likelihoods)
    assert {name: turned[name] for name in priors} == posterior(priors, likelihoods)


@given(PRIORS, st.lists(LIKELIHOODS, max_size=5))
def test_evidence_in_any_order(priors: dict[str, float], evidence: list[dict[str, float]]) -> None:
    assert posterior_after(priors, evidence) == pytest.approx(posterior_after(priors, evidence[::-1]))


@given(st.floats(0.01, 0.99), st.floats(0.01, 1.0), st.floats(0.01, 1.0))
def test_odds_say_the_same(prior: float, given_true: float, given_false: float) -> None:
    after = posterior({"true": prior, "false": 1 - prior}, {"true": given_true, "false": given_false})["true"]
    assert probability(odds_after(odds(prior), [likelihood_ratio(given_true, given_false)])) == pytest.approx(after)


@given(st.floats(0.0, 0.999))
def test_odds_and_back(value: float) -> None:
    assert probability(odds(value)) == pytest.approx(value, abs=1e-15)


def test_bad_input_is_refused_in_one_line() -> None:
    even = {"door": 0.5, "wall": 0.5}
    cases = [
        (lambda: posterior({"door": 0.5, "wall": 0.4}, even), "priors add up to 0.9, not to 1"),
        (lambda: posterior({}, {}), "priors add up to 0, not to 1"),
        (lambda: posterior({"door": 1.5, "wall": -0.5}, even), r"prior of 'door' = 1.5 is outside \[0, 1\]"),
        (lambda: posterior(even, {"door": 0.5}), "likelihood of 'wall' is missing"),
        (
            lambda: posterior(even, {**even, "wal": 0.5}),
            "likelihood of 'wal', which has no prior; did you mean 'wall'?",
        ),
        (lambda: posterior(even, {"door": 0.5, "wall": -0.1}), "likelihood of 'wall' = -0.1 is outside"),
        (lambda: posterior(even, {"door": 0.0, "wall": 0.0}), "impossible under every hypothesis"),
        (
            lambda: posterior({"door": 1.0, "wall": 0.0}, {"door": 0.0, "wall": 1.0}),
            "impossible under every hypothesis",
        ),
        (lambda: posterior_after({"door": 0.7}, []), "priors add up to 0.7"),
        (lambda: odds(1.0), "probability = 1 has no finite odds"),
        (lambda: probability(-1.0), "odds = -1.0 is outside"),
        (lambda: likelihood_ratio(0.5, 0.0), "likelihood when false = 0 proves"),
        (lambda: odds_after(1.0, [-2.0]), "likelihood ratio = -2.0 is outside"),
    ]
    for call, said in cases:
        with pytest.raises(UncertaintyError, match=said):
            call()
