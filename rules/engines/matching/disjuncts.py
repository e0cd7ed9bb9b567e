"""Conditions without `or` and `and`, as rows of patterns, tests and groups.

Inside `not` and `exists`, each way through the `or`s is a branch: `not` holds where no branch has a match, `exists` where one has.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from rules.language.alternatives import alternatives
from rules.language.syntax import Condition, Exists, Match, Not, Test


@dataclass(frozen=True, slots=True)
class Group:
    """`not`, or `exists` where `wanted`: rows of conditions of which none must match, or at least one."""

    branches: tuple[tuple["Part", ...], ...]
    wanted: bool


Part: TypeAlias = Match | Test | Group


def disjuncts(conditions: Sequence[Condition]) -> list[tuple[Part, ...]]:
    """Return the rows of conditions of which each is a way for all of these conditions to hold."""
    return [tuple(map(_part, row)) for row in alternatives(conditions)]


def _part(condition: Condition) -> Part:
    if isinstance(condition, Not):
        return Group(tuple(disjuncts([condition.condition])), wanted=False)
    if isinstance(condition, Exists):
        return Group(tuple(disjuncts(condition.conditions)), wanted=True)
    assert isinstance(condition, Match | Test)
    return condition
