"""experta's matcher on our network: facts in, activations out."""

from collections.abc import Callable, Iterable
from typing import Any

from rules.engines.compilation import Row
from rules.engines.experta_import import Matcher
from rules.engines.matching.facts import WorkingFact
from rules.engines.matching.network import Bound, Network
from rules.engines.matching.nodes import RuleEnd
from rules.engines.strategy import RuleActivation


class NetworkMatcher(Matcher):  # type: ignore[misc]
    """Matches the facts of an engine against its rules; what `changes` returns goes to the strategy."""

    network: Network

    def __init__(self, engine: Any) -> None:
        super().__init__(engine)
        self.added: dict[RuleActivation, None] = {}
        self.removed: list[RuleActivation] = []
        self.born = 0

    def build(self, network: Network) -> None:
        """Put the rules of the engine into an empty network."""
        self.network = network
        for rule in self.engine.get_rules():
            for row in rule:
                network.add_row(row.parts, self._end_of(rule, row))

    def _end_of(self, rule: Any, row: Row) -> Callable[[Bound], RuleEnd]:
        def matched(facts: tuple[WorkingFact, ...]) -> RuleActivation:
            self.born += 1
            activation = RuleActivation(rule, row, facts, (rule.salience, self.born))
            self.added[activation] = None
            return activation

        def end(bound: Bound) -> RuleEnd:
            row.bound = bound
            return RuleEnd(matched, self._unmatched)

        return end

    def _unmatched(self, activation: RuleActivation) -> None:
        if activation in self.added:  # born in the same change
            del self.added[activation]
        elif activation.waits:
            self.removed.append(activation)

    def changes(
        self, adding: Iterable[WorkingFact] = (), deleting: Iterable[WorkingFact] = ()
    ) -> tuple[list[RuleActivation], list[RuleActivation]]:
        """Pass changes through the network; return the activations that have come and those that have gone."""
        for fact in deleting:
            self.network.remove(fact)
        for fact in adding:
            self.network.put(fact)
        return self._taken()

    def _taken(self) -> tuple[list[RuleActivation], list[RuleActivation]]:
        added, removed = list(self.added), self.removed
        self.added, self.removed = {}, []
        return added, removed

    def clear(self) -> None:
        """Forget all facts and activations."""
        self._taken()
        self.network.clear()

    def reset(self) -> None:
        """Start: activations that need no fact are among the next changes."""
        self.network.start()
