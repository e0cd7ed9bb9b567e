"""Certainty factors: belief and disbelief kept apart, from -1 (absolute denial) over 0 (little evidence) to 1 (absolute truth).

Source: Bou-Ghannam 1992, section 2.5.3.2 (certainty theory, as in MYCIN): CF = MB - MD; AND is MIN, OR is MAX; through a rule
CF(Q) = CF(P) CF1; two rules with the same conclusion by the three cases for both positive, both negative, and otherwise.
"""

from collections.abc import Iterable
from functools import reduce

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.limits import within


def certainty_factor(belief: float, disbelief: float) -> float:
    """Return CF = MB - MD of a measure of belief and one of disbelief, each in [0, 1]."""
    return within("belief", belief, 0.0, 1.0) - within("disbelief", disbelief, 0.0, 1.0)


def all_of(factors: Iterable[float]) -> float:
    """Return CF(H1 AND H2 ...): the smallest factor. Raises UncertaintyError when there is none."""
    return min(_factors(factors))


def any_of(factors: Iterable[float]) -> float:
    """Return CF(H1 OR H2 ...): the largest factor. Raises UncertaintyError when there is none."""
    return max(_factors(factors))


def through_rule(premise: float, rule: float) -> float:
    """Return CF(Q) = CF(P) * CF1 where P implies Q with the factor CF1.

    As printed, a denied premise denies the conclusion. Where "not P" says nothing about Q, do not apply the rule then.
    """
    return _factor("premise", premise) * _factor("rule", rule)


def combine(first: float, second: float) -> float:
    """Return the factor of a conclusion that two independent rules give with the factors `first` and `second`.

    Raises UncertaintyError where one is 1 and the other -1: the third case then divides by zero, and both cannot be true.
    """
    a, b = _factor("first", first), _factor("second", second)
    if a > 0 and b > 0:
        return min(a + b - a * b, 1.0)
    if a < 0 and b < 0:
        return max(a + b + a * b, -1.0)
    rest = 1.0 - min(abs(a), abs(b))
    if rest == 0.0:
        raise UncertaintyError(
            "one rule is certain and the other certain of the opposite (1 and -1): one of them is wrong"
        )
    return (a + b) / rest


def combine_all(factors: Iterable[float]) -> float:
    """Return the factor of a conclusion that several independent rules give, combined in turn; the order does not matter."""
    return reduce(combine, _factors(factors))


def _factor(name: str, value: float) -> float:
    return within(f"{name} certainty factor", value, -1.0, 1.0)


def _factors(values: Iterable[float]) -> list[float]:
    checked = [_factor(f"number {i}", value) for i, value in enumerate(values, 1)]
    if not checked:
        raise UncertaintyError("no certainty factors were given; at least one is needed")
    return checked
