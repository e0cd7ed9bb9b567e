"""Rules of a program as rules of experta: their conditions as rows for the network, their actions as the function to call."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from rules.engines.experta_import import Rule as ExpertaRule
from rules.engines.matching.disjuncts import Part, disjuncts
from rules.engines.matching.facts import WorkingFact
from rules.engines.matching.network import Bound
from rules.language.syntax import Match, Rule, Test
from rules.language.values import Value

Act = Callable[[dict[str, Value]], None]  # what a rule does, with its variables' values


@dataclass(slots=True, eq=False)
class Row:
    """One way for the conditions of a rule to hold; `bound` is filled in by the network."""

    parts: tuple[Part, ...]
    bound: Bound = field(default_factory=dict)

    def indices(self, facts: tuple[WorkingFact, ...]) -> tuple[int | None, ...]:
        """Return the index of the fact at each condition, None where it is no one fact."""
        matched = iter(facts)
        return tuple(
            next(matched).index if isinstance(part, Match) else None
            for part in self.parts
            if not isinstance(part, Test)
        )

    def bindings(self, facts: tuple[WorkingFact, ...]) -> dict[str, Value]:
        """Return the variables' values."""
        return {name: there.place.value()(facts[there.level]) for name, there in self.bound.items()}


def experta_rules(rules: Sequence[Rule], acts: Sequence[Act]) -> list[Any]:
    """Return what experta fires: one rule for each rule, in the order of definition."""
    return [_experta_rule(rule, act) for rule, act in zip(rules, acts, strict=True)]


def _experta_rule(rule: Rule, act: Act) -> Any:
    rows = [Row(parts) for parts in disjuncts(rule.conditions)]
    made = ExpertaRule(*rows, salience=rule.salience)(act)
    made.__name__ = rule.name
    return made
