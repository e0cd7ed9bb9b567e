"""Tokens and the memories that hold them, indexed by what joins ask for.

A token is a row of facts that match the first conditions of a rule. Tokens form a tree: what was made from a token goes with it, so
that a retraction costs what it undoes and nothing else. All memories are dicts: their order is that of arrival.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Any, Protocol

from rules.engines.matching.facts import Identity, WorkingFact
from rules.engines.matching.places import Place, TokenPlace, identities, identities_in_fact
from rules.language.errors import RuleError

Facts = tuple[WorkingFact, ...]


class Token:
    """A row of facts; `fact` is the one it adds to its parent's, if any; `owner` is the memory that made it."""

    __slots__ = ("alive", "children", "fact", "facts", "owner", "parent", "state")

    def __init__(self, owner: "Memory", parent: "Token | None", fact: WorkingFact | None, facts: Facts) -> None:
        self.owner = owner
        self.parent = parent
        self.fact = fact
        self.facts = facts
        self.children: dict[Token, None] | None = None
        self.state: Any = None
        self.alive = True
        if parent is not None:
            if parent.children is None:
                parent.children = {self: None}
            else:
                parent.children[self] = None
        if fact is not None:
            fact.tokens[self] = None


class Successor(Protocol):
    """What takes tokens from a memory."""

    def take(self, token: Token) -> None:
        """Work on a token that has come into the memory."""


_NOTHING: dict[Any, None] = {}


class Index:
    """Tokens, or facts, by a key."""

    __slots__ = ("buckets", "key")

    def __init__(self, key: Callable[[Any], Identity]) -> None:
        self.key = key
        self.buckets: dict[Identity, dict[Any, None]] = {}

    def add(self, item: Any, keyed: Any) -> None:
        key = self.key(keyed)
        bucket = self.buckets.get(key)
        if bucket is None:
            self.buckets[key] = {item: None}
        else:
            bucket[item] = None

    def remove(self, item: Any, keyed: Any) -> None:
        key = self.key(keyed)
        bucket = self.buckets[key]
        del bucket[item]
        if not bucket:
            del self.buckets[key]

    def found(self, key: Identity) -> Iterable[Any]:
        """Return what has this key, the first to come first."""
        return self.buckets.get(key, ())

    def newest(self, key: Identity) -> Iterable[Any]:
        """Return what has this key, the last to come first."""
        latest_first: Iterable[Any] = reversed(self.buckets.get(key, _NOTHING))
        return latest_first


class Memory:
    """Where the tokens of a row of conditions stand, and what takes them further."""

    def __init__(self) -> None:
        self.indexes: dict[tuple[TokenPlace, ...], Index] = {}
        self.successors: list[Successor] = []

    def index(self, places: tuple[TokenPlace, ...]) -> Index:
        """Return the index by the values at these places, making it where there is none; before any token has come."""
        if places not in self.indexes:
            self.indexes[places] = Index(identities(places))
        return self.indexes[places]

    def put(self, token: Token) -> None:
        """Add a token and pass it on."""
        for index in self.indexes.values():
            index.add(token, token.facts)
        for successor in self.successors:
            successor.take(token)

    def forget(self, token: Token) -> None:
        """Drop a token whose life ends."""
        for index in self.indexes.values():
            index.remove(token, token.facts)

    def clear(self) -> None:
        """Drop all tokens at once."""
        for index in self.indexes.values():
            index.buckets.clear()


class RightSide(Protocol):
    """What joins the facts of an alpha memory to tokens."""

    def meet(self, fact: WorkingFact) -> None:
        """Work on a fact that has come into the alpha memory."""


class AlphaMemory:
    """The facts that match one pattern by themselves."""

    def __init__(
        self,
        checks: list[Callable[[WorkingFact], bool]],
        order: tuple[int, ...],
        note: Callable[[RuleError], None],
    ) -> None:
        self.checks = checks
        self.note = note
        self.order = order  # which of the memories a fact enters first
        self.indexes: dict[tuple[Place, ...], Index] = {}
        self.joins: list[RightSide] = []  # the latest made first: what stands below another must meet a fact before it

    def index(self, places: tuple[Place, ...]) -> Index:
        """Return the index by the values at these places, making it where there is none; before any fact has come."""
        if places not in self.indexes:
            self.indexes[places] = Index(identities_in_fact(places))
        return self.indexes[places]

    def fits(self, fact: WorkingFact) -> bool:
        """Say whether a fact matches by itself; where that cannot be evaluated, it does not, and that is noted."""
        try:
            return all(check(fact) for check in self.checks)
        except RuleError as fault:
            self.note(fault)
            return False

    def put(self, fact: WorkingFact) -> None:
        for index in self.indexes.values():
            index.add(fact, fact)
        fact.memories.append(self)
        for join in self.joins:
            join.meet(fact)

    def forget(self, fact: WorkingFact) -> None:
        for index in self.indexes.values():
            index.remove(fact, fact)

    def clear(self) -> None:
        for index in self.indexes.values():
            index.buckets.clear()


def drop(token: Token) -> None:
    """End the life of a token and of all that was made from it."""
    parent = token.parent
    if parent is not None and parent.children is not None:
        del parent.children[token]
    _end(token)


def drop_children(token: Token) -> None:
    """End the life of what was made from a token, not its own."""
    children, token.children = token.children, None
    for child in children or ():
        _end(child)


def _end(token: Token) -> None:
    token.alive = False
    drop_children(token)
    token.owner.forget(token)
    if token.fact is not None:
        del token.fact.tokens[token]


def ancestors(token: Token) -> Iterator[Token]:
    """Yield the tokens that a token was made from, the nearest first."""
    at = token.parent
    while at is not None:
        yield at
        at = at.parent
