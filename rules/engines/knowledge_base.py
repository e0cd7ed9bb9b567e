"""experta's engine, mended: working memory, network and agenda are the same at every moment.

experta gathers changes and matches them before the next firing, so that asserting and retracting one fact in one right-hand side
fails. Here each change goes through the network at once.
"""

from collections.abc import Callable
from typing import Any

from rules.engines.experta_import import FactList, KnowledgeEngine
from rules.engines.matcher import NetworkMatcher
from rules.engines.matching.facts import WorkingFact
from rules.engines.matching.network import Network
from rules.engines.strategy import NewestFirst, RuleActivation
from rules.language.values import FactValue


class WorkingMemory(FactList):  # type: ignore[misc]
    """The facts by index, from 1 on. A fact that stands already is not declared again; indices are not used twice."""

    def __init__(self) -> None:
        super().__init__()
        self.last_index = 1
        self.by_key: dict[Any, int] = {}

    def declare(self, fact: WorkingFact, index: int | None = None) -> WorkingFact | None:
        """Put a fact in, at its own place where `index` is that of a fact it replaces; None where the same stands already."""
        key = fact.key
        if key in self.by_key:
            return None
        if index is None:
            index, self.last_index = self.last_index, self.last_index + 1
        fact.index = self.by_key[key] = index
        self[index] = fact
        return fact

    def retract(self, index: int) -> WorkingFact:
        """Take a fact out; KeyError where there is none of this index."""
        fact: WorkingFact = self.pop(index)
        del self.by_key[fact.key]
        return fact


class KnowledgeBase(KnowledgeEngine):  # type: ignore[misc]
    """Facts, rules and agenda of one program."""

    __matcher__ = NetworkMatcher
    __strategy__ = NewestFirst

    facts: WorkingMemory

    def __init__(self, rules: list[Any], network: Network) -> None:
        self.rules = rules
        super().__init__()
        self.matcher.build(network)
        self.facts = WorkingMemory()

    def get_rules(self) -> list[Any]:
        """Return the rules in the order of their definition."""
        return self.rules

    def clear(self) -> None:
        """Empty working memory and agenda."""
        self.facts = WorkingMemory()
        self.agenda.activations.clear()
        self.matcher.clear()

    def reset(self) -> None:
        """Empty working memory and agenda, and start: rules that need no fact are put on the agenda."""
        self.clear()
        self.matcher.reset()
        self._synchronise()

    def declare(self, value: FactValue) -> int | None:
        """Assert a fact and return its index; None where the same stands already."""
        fact = self.facts.declare(WorkingFact(value))
        if fact is None:
            return None
        self._synchronise(adding=(fact,))
        return fact.index

    def retract(self, index: int) -> FactValue:
        """Take a fact out and return it; KeyError where there is none of this index."""
        fact = self.facts.retract(index)
        self._synchronise(deleting=(fact,))
        return fact.value

    def replace(self, index: int, value: FactValue) -> tuple[FactValue, bool]:
        """Put a fact in the place of another, under its index.

        Return what stood there, and whether the new one stands there now: not where the same stands elsewhere already.
        """
        old = self.facts[index]
        del self.facts.by_key[old.key]
        self._synchronise(deleting=(old,))
        fact = self.facts.declare(WorkingFact(value), index)
        if fact is None:
            del self.facts[index]
            return old.value, False
        self._synchronise(adding=(fact,))
        return old.value, True

    def take(self, wanted: Callable[[RuleActivation], bool] | None = None) -> RuleActivation | None:
        """Take the next activation off the agenda, or the next that is wanted; None where there is none."""
        waiting = self.agenda.activations
        at = len(waiting) - 1
        while at >= 0 and wanted is not None and not wanted(waiting[at]):
            at -= 1
        if at < 0:
            return None
        activation: RuleActivation = waiting.pop(at)
        activation.waits = False
        return activation

    def _synchronise(self, adding: tuple[WorkingFact, ...] = (), deleting: tuple[WorkingFact, ...] = ()) -> None:
        added, removed = self.matcher.changes(adding, deleting)
        self.strategy.update_agenda(self.agenda, added, removed)
