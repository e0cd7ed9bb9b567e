"""The nodes of the network: joins, `not` and `exists`, tests, and the ends of rules.

Each acts at once, as in CLIPS: where one fact makes a group hold and then not, in one change, what waited for it is born anew.
"""

from collections.abc import Callable
from typing import Any

from rules.engines.matching.expressions import Check
from rules.engines.matching.facts import WorkingFact
from rules.engines.matching.memories import (
    AlphaMemory,
    Facts,
    Index,
    Memory,
    Token,
    ancestors,
    drop,
    drop_children,
)


class JoinNode(Memory):
    """A pattern: each token of the memory before it with each fact that matches."""

    def __init__(self, left: Index, right: Index, test: Check | None) -> None:
        super().__init__()
        self.left = left
        self.right = right
        self.test = test

    def take(self, token: Token) -> None:
        facts = token.facts
        for fact in self.right.found(self.left.key(facts)):
            if self.test is None or self.test(facts, fact):
                self.put(Token(self, token, fact, (*facts, fact)))

    def meet(self, fact: WorkingFact) -> None:
        for token in self.left.newest(self.right.key(fact)):
            facts = token.facts
            if self.test is None or self.test(facts, fact):
                self.put(Token(self, token, fact, (*facts, fact)))


class OneFactNode(Memory):
    """`not`, or `exists` where `wanted`, over one pattern: each token rests on one fact that matches, or on none.

    `state` is that fact. Only the tokens that pass stand in the memory; the others wait in `resting`.
    """

    def __init__(self, resting: Index, right: Index, test: Check | None, wanted: bool) -> None:
        super().__init__()
        self.resting = resting
        self.right = right
        self.test = test
        self.wanted = wanted

    def take(self, token: Token) -> None:
        mine = Token(self, token, None, token.facts)
        self.resting.add(mine, mine.facts)
        self._rest(mine)
        if (mine.state is not None) is self.wanted:
            self.put(mine)

    def _rest(self, token: Token) -> None:
        """Find a fact for a token to rest on."""
        facts = token.facts
        for fact in self.right.found(self.resting.key(facts)):
            if self.test is None or self.test(facts, fact):
                token.state = fact
                fact.blocks[token] = None
                return

    def meet(self, fact: WorkingFact) -> None:
        for token in self.resting.newest(self.right.key(fact)):
            if token.state is None and (self.test is None or self.test(token.facts, fact)):
                token.state = fact
                fact.blocks[token] = None
                self._turned(token)

    def lost(self, token: Token) -> None:
        """Find another fact for a token whose fact is gone."""
        token.state = None
        self._rest(token)
        if token.state is None:
            self._turned(token)

    def _turned(self, token: Token) -> None:
        if (token.state is not None) is self.wanted:
            self.put(token)
        else:
            super().forget(token)
            drop_children(token)

    def forget(self, token: Token) -> None:
        self.resting.remove(token, token.facts)
        if (token.state is not None) is self.wanted:
            super().forget(token)
        if token.state is not None:
            del token.state.blocks[token]

    def clear(self) -> None:
        super().clear()
        self.resting.buckets.clear()


class FilterNode(Memory):
    """A test of tokens."""

    def __init__(self, test: Check | None) -> None:
        super().__init__()
        self.test = test

    def take(self, token: Token) -> None:
        if self.test is None or self.test(token.facts, None):
            self.put(Token(self, token, None, token.facts))


class GroupNode(Memory):
    """`not`, or `exists` where `wanted`, over rows of conditions, which start from this memory and end in a GroupEnd.

    A token's `state` is the number of matches that have come from it. What passes goes on in `passed`.
    """

    def __init__(self, wanted: bool) -> None:
        super().__init__()
        self.wanted = wanted
        self.passed = Memory()

    def take(self, token: Token) -> None:
        mine = Token(self, token, None, token.facts)
        mine.state = Matches()
        self.put(mine)
        mine.state.begun = True
        self.settle(mine)

    def settle(self, token: Token) -> None:
        """Pass a token on, or take back what has passed, as its number of matches asks for."""
        opened = (token.state.count > 0) is self.wanted
        if opened and token.state.passed is None:
            token.state.passed = Token(self.passed, token, None, token.facts)
            self.passed.put(token.state.passed)
        elif not opened and token.state.passed is not None:
            passed, token.state.passed = token.state.passed, None
            drop(passed)


class Matches:
    """What a group knows of one token: how many matches there are, and the token that has passed on."""

    __slots__ = ("begun", "count", "passed")

    def __init__(self) -> None:
        self.begun = False  # once the conditions inside have seen the token
        self.count = 0
        self.passed: Token | None = None


class GroupEnd(Memory):
    """Where the matches inside a group arrive and are counted."""

    def __init__(self, group: GroupNode) -> None:
        super().__init__()
        self.group = group

    def take(self, token: Token) -> None:
        mine = Token(self, token, None, token.facts)
        mine.state = next(at for at in ancestors(token) if at.owner is self.group)
        self._count(mine, 1)

    def forget(self, token: Token) -> None:
        self._count(token, -1)

    def _count(self, token: Token, change: int) -> None:
        group = token.state
        group.state.count += change
        if group.alive and group.state.begun:
            self.group.settle(group)


class RuleEnd(Memory):
    """Where the matches of a whole rule arrive."""

    def __init__(self, matched: Callable[[Facts], Any], unmatched: Callable[[Any], None]) -> None:
        super().__init__()
        self.matched = matched
        self.unmatched = unmatched

    def take(self, token: Token) -> None:
        mine = Token(self, token, None, token.facts)
        mine.state = self.matched(token.facts)

    def forget(self, token: Token) -> None:
        self.unmatched(token.state)


class RootMemory(Memory):
    """What stands before the first condition: one token without facts."""

    def start(self) -> None:
        self.put(Token(self, None, None, ()))


def remove(fact: WorkingFact) -> None:
    """Take a fact out of the network; what rests on it looks for another."""
    for memory in fact.memories:
        assert isinstance(memory, AlphaMemory)
        memory.forget(fact)
    fact.memories.clear()
    while fact.tokens:
        drop(next(iter(fact.tokens)))
    for token in reversed(list(fact.blocks)):  # CLIPS's order
        if token.alive:
            assert isinstance(token.owner, OneFactNode)
            token.owner.lost(token)
    fact.blocks.clear()
