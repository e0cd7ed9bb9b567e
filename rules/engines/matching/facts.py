"""Facts in working memory, and what makes two values the same.

A value's identity is a hashable that is equal for the same values only: 1 and 1.0, a symbol and a string differ. It compares and
hashes in C, where the values' own records would do so in Python for every join.
"""

from typing import Any

from rules.engines.experta_import import Fact
from rules.language.values import FactAddress, FactValue, Symbol, Value

Identity = Any  # str for a symbol, int for an integer, a tuple of identities for a multifield, else (type, ...)


def identity(value: Value) -> Identity:
    """Return a hashable that is equal for the same values only."""
    kind = type(value)
    if kind is Symbol:
        return value.name  # type: ignore[union-attr]
    if kind is int:
        return value
    if kind is tuple:
        return tuple(map(identity, value))  # type: ignore[arg-type]
    return (kind, value.index) if isinstance(value, FactAddress) else (kind, value)


class WorkingFact(Fact):  # type: ignore[misc]
    """A fact in working memory, and where the network holds it. Two of them are equal only if they are one."""

    index: int
    value: FactValue
    fields: tuple[Value, ...]
    identities: tuple[Identity, ...]

    def __init__(self, value: FactValue) -> None:
        dict.__init__(self)
        self.value = value
        self.fields = value.fields
        self.identities = tuple(map(identity, value.fields))
        self.memories: list[Any] = []  # the alpha memories that hold it
        self.tokens: dict[Any, None] = {}  # the tokens whose newest fact it is
        self.blocks: dict[Any, None] = {}  # the tokens of `not` and `exists` that rest on it

    @property
    def key(self) -> tuple[Identity, ...]:
        """What is equal for the same facts only."""
        return (self.value.relation, self.value.slots is None, self.identities)

    __hash__ = object.__hash__
    __eq__ = object.__eq__
