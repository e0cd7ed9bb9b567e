"""Values of the rule language: symbols, strings, numbers, multifields and fact addresses, kept apart as CLIPS keeps them.

Strings are `str`, integers `int`, floats `float`, multifields tuples. TRUE and FALSE are symbols.
"""

from dataclasses import dataclass
from math import copysign


@dataclass(frozen=True, slots=True, order=True)
class Symbol:
    """A word without quotes: not equal to the string of the same letters."""

    name: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class FactAddress:
    """What `?f <-` binds: the index of a fact in working memory."""

    index: int


TRUE, FALSE, NIL = Symbol("TRUE"), Symbol("FALSE"), Symbol("nil")

Value = Symbol | str | int | float | FactAddress | tuple["Value", ...]


def same(a: Value, b: Value) -> bool:
    """Say whether two values are equal as CLIPS's `eq` has it: 1 and 1.0, a symbol and a string, 0.0 and -0.0 are not."""
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if a == 0 and isinstance(a, float) and isinstance(b, float):
        return b == 0 and copysign(1, a) == copysign(1, b)
    return type(a) is type(b) and a == b


def as_symbol(truth: bool) -> Symbol:
    """Return TRUE or FALSE."""
    return TRUE if truth else FALSE


def is_true(value: Value) -> bool:
    """Say whether a value counts as true: all but the symbol FALSE do."""
    return value != FALSE


@dataclass(frozen=True, slots=True)
class FactValue:
    """A fact: `(relation field ...)`, or for a template `(relation (slot value) ...)` with `slots` in the template's order.

    `fields` holds one value for each slot of a template fact (a tuple for a multislot), else the fields in order. Two facts are
    the same where relation, kind and all fields are `same`; use `key` to look one up.
    """

    relation: str
    fields: tuple[Value, ...]
    slots: tuple[str, ...] | None = None

    def slot(self, name: str) -> Value:
        """Return the value of a slot; KeyError where there is none."""
        if self.slots is None or name not in self.slots:
            raise KeyError(name)
        return self.fields[self.slots.index(name)]

    @property
    def key(self) -> tuple[object, ...]:
        """A hashable that is equal for the same facts only."""
        return (self.relation, self.slots is None, _typed(self.fields))

    def __str__(self) -> str:
        if self.slots is None:
            return f"({' '.join([self.relation, *map(written, self.fields)])})"
        parts = [f"({' '.join([s, *_words(v)])})" for s, v in zip(self.slots, self.fields, strict=True)]
        return f"({' '.join([self.relation, *parts])})"


def _typed(value: Value) -> tuple[object, ...]:
    if isinstance(value, tuple):
        return (tuple, *map(_typed, value))
    if value == 0 and isinstance(value, float):
        return (float, value, copysign(1, value))
    return (type(value), value)


def _words(value: Value) -> list[str]:
    return list(map(written, value)) if isinstance(value, tuple) else [written(value)]


def written(value: Value) -> str:
    """Return a value as it is written in a rule file (and as CLIPS prints it)."""
    if isinstance(value, tuple):
        return f"({' '.join(map(written, value))})"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    if isinstance(value, FactAddress):
        return f"<Fact-{value.index}>"
    return repr(value) if isinstance(value, float) else str(value)
