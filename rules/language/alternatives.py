"""Conditions without `and` and `or`: CLIPS makes one rule of each way through the `or`s, and so do the engines and checks."""

from collections.abc import Sequence
from itertools import product

from rules.language.syntax import All, AnyOf, Condition, Exists, Not

MOST_ALTERNATIVES = 64  # of one rule; a rule that writes out to more is no longer one thought


def alternatives(conditions: Sequence[Condition]) -> list[tuple[Condition, ...]]:
    """Return the rows of plain conditions (Match, Test, Not, Exists) that the conditions write out to, in CLIPS's order."""
    return [sum(choice, ()) for choice in product(*map(_choices, conditions))]


def number_of_alternatives(conditions: Sequence[Condition]) -> int:
    """Return how many rows there would be, those within `not` and `exists` counted too."""
    number = 1
    for condition in conditions:
        if isinstance(condition, All):
            number *= number_of_alternatives(condition.conditions)
        elif isinstance(condition, AnyOf):
            number *= sum(number_of_alternatives((one,)) for one in condition.conditions)
        elif isinstance(condition, Not):
            number *= number_of_alternatives((condition.condition,))
        elif isinstance(condition, Exists):
            number *= number_of_alternatives(condition.conditions)
    return number


def _choices(condition: Condition) -> list[tuple[Condition, ...]]:
    if isinstance(condition, All):
        return alternatives(condition.conditions)
    if isinstance(condition, AnyOf):
        return [row for one in condition.conditions for row in _choices(one)]
    return [(condition,)]
