"""Bayesian probability: how probable each of several hypotheses is after the evidence.

Source: Bou-Ghannam 1992, section 2.5.3.1: P(Hi/E) = P(E/Hi) P(Hi) / sum_k P(E/Hk) P(Hk). The hypotheses exclude each other and
one of them is true; pieces of evidence are independent given the hypothesis. The odds-likelihood form is the same theorem for
a hypothesis and its negation: O(H/E) = O(H) P(E/H) / P(E/not H).
"""

import math
from collections.abc import Iterable, Mapping

from blackboard.errors import UncertaintyError, did_you_mean
from blackboard.uncertainty.limits import sums_to_one, within


def posterior(priors: Mapping[str, float], likelihoods: Mapping[str, float]) -> dict[str, float]:
    """Return P(Hi/E) for each hypothesis, in the order of `priors`.

    `likelihoods` holds P(E/Hi) for the same names; densities will do too, since only their ratios count. Raises
    UncertaintyError where priors do not add up to 1, names differ, or the evidence is impossible under every hypothesis.
    """
    checked = {name: within(f"prior of '{name}'", value, 0.0, 1.0) for name, value in priors.items()}
    sums_to_one("priors", checked.values())
    for name in likelihoods:
        if name not in checked:
            raise UncertaintyError(f"likelihood of '{name}', which has no prior{did_you_mean(name, checked)}")
    for name in checked:
        if name not in likelihoods:
            raise UncertaintyError(f"likelihood of '{name}' is missing")
    given = {name: within(f"likelihood of '{name}'", likelihoods[name], 0.0) for name in checked}
    largest = max((given[name] for name, prior in checked.items() if prior > 0), default=0.0)
    if largest == 0.0:
        raise UncertaintyError(
            "the evidence is impossible under every hypothesis that is possible: the hypotheses miss a case"
        )
    joint = {name: prior * (given[name] / largest) if prior > 0 else 0.0 for name, prior in checked.items()}
    total = math.fsum(joint.values())
    return {name: value / total for name, value in joint.items()}


def posterior_after(priors: Mapping[str, float], evidence: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """Return the posterior after several independent pieces of evidence, each the likelihoods as in `posterior`."""
    beliefs = dict(priors)
    sums_to_one("priors", (within(f"prior of '{name}'", value, 0.0, 1.0) for name, value in beliefs.items()))
    for likelihoods in evidence:
        beliefs = posterior(beliefs, likelihoods)
    return beliefs


def odds(probability: float) -> float:
    """Return p / (1 - p); a probability of 1 has no finite odds and is refused."""
    probability = within("probability", probability, 0.0, 1.0)
    if probability == 1.0:
        raise UncertaintyError("probability = 1 has no finite odds; no evidence could ever change it")
    return probability / (1.0 - probability)


def probability(odds: float) -> float:
    """Return the probability p whose odds are p / (1 - p)."""
    odds = within("odds", odds, 0.0)
    return odds / (1.0 + odds)


def likelihood_ratio(given_true: float, given_false: float) -> float:
    """Return P(E/H) / P(E/not H): above 1 the evidence speaks for H, below 1 against it."""
    given_true = within("likelihood when true", given_true, 0.0)
    given_false = within("likelihood when false", given_false, 0.0)
    if given_false == 0.0:
        raise UncertaintyError("likelihood when false = 0 proves the hypothesis; give it a small chance of error")
    return given_true / given_false


def odds_after(prior_odds: float, likelihood_ratios: Iterable[float]) -> float:
    """Return the odds after independent pieces of evidence, each given by its likelihood ratio."""
    result = within("prior odds", prior_odds, 0.0)
    for ratio in likelihood_ratios:
        result = within("odds", result * within("likelihood ratio", ratio, 0.0), 0.0)
    return result
