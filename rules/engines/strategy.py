"""Which activation fires next: the greatest salience, then the newest.

Activations that one change brings are born in the order in which the network comes to them: as a rule the rule that is defined
last is first born, and so last to fire.
"""

from bisect import bisect_left, insort
from operator import attrgetter
from typing import Any

from rules.engines.compilation import Row
from rules.engines.experta_import import Activation, Strategy
from rules.engines.matching.facts import WorkingFact

_key = attrgetter("key")


class RuleActivation(Activation):  # type: ignore[misc]
    """A rule and the facts that match one row of its conditions. Two of them are equal only if they are one."""

    def __init__(self, rule: Any, row: Row, facts: tuple[WorkingFact, ...], key: tuple[int, ...]) -> None:
        self.rule = rule
        self.row = row
        self.facts = facts
        self.key = key
        self.waits = True  # on the agenda, or about to be put there

    @property
    def context(self) -> dict[str, Any]:
        """Return the values of the rule's variables."""
        return self.row.bindings(self.facts)

    __hash__ = object.__hash__
    __eq__ = object.__eq__


class NewestFirst(Strategy):  # type: ignore[misc]
    """Keeps the agenda sorted, the next activation last; what is removed is found by its key, which no two share."""

    def _update_agenda(self, agenda: Any, added: list[RuleActivation], removed: list[RuleActivation]) -> None:
        for activation in removed:
            if activation.waits:
                activation.waits = False
                del agenda.activations[bisect_left(agenda.activations, activation.key, key=_key)]
        for activation in added:
            insort(agenda.activations, activation, key=_key)
