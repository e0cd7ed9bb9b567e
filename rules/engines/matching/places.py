"""Where a variable's value stands: in which fact of a token, in which field, and where in that field."""

from collections.abc import Callable
from dataclasses import dataclass

from rules.engines.matching.facts import Identity, WorkingFact
from rules.language.values import FactAddress, Value

Part = int | tuple[int, int | None]  # an index, from the end where negative; or from and to, of `$?x`


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a fact: a field, a stretch of fields, or with `inside` a part of a multislot; the fact itself with no field."""

    field: Part | None
    inside: Part | None = None

    def value(self) -> Callable[[WorkingFact], Value]:
        """Return what reads the value here from a fact."""
        if self.field is None:
            return lambda fact: FactAddress(fact.index)
        if self.inside is not None:
            field, inside = _only(self.field), _key(self.inside)
            return lambda fact: fact.fields[field][inside]  # type: ignore[index]
        key = _key(self.field)
        return lambda fact: fact.fields[key]

    def identity(self) -> Callable[[WorkingFact], Identity]:
        """Return what reads the identity of the value here from a fact."""
        if self.field is None:
            return lambda fact: (FactAddress, fact.index)
        if self.inside is not None:
            field, inside = _only(self.field), _key(self.inside)
            return lambda fact: fact.identities[field][inside]
        key = _key(self.field)
        return lambda fact: fact.identities[key]


@dataclass(frozen=True, slots=True)
class TokenPlace:
    """A place in one of a token's facts, which are numbered in the order of the rule's patterns."""

    level: int
    place: Place

    def identity(self) -> Callable[[tuple[WorkingFact, ...]], Identity]:
        """Return what reads the identity of the value here from a token's facts."""
        level, read = self.level, self.place.identity()
        return lambda facts: read(facts[level])


def identities(places: tuple[TokenPlace, ...]) -> Callable[[tuple[WorkingFact, ...]], Identity]:
    """Return what reads the identities at some places of a token's facts, as one key."""
    if len(places) == 1:
        return places[0].identity()
    reads = tuple(place.identity() for place in places)
    return lambda facts: tuple([read(facts) for read in reads])


def identities_in_fact(places: tuple[Place, ...]) -> Callable[[WorkingFact], Identity]:
    """Return what reads the identities at some places of one fact, as one key."""
    if len(places) == 1:
        return places[0].identity()
    reads = tuple(place.identity() for place in places)
    return lambda fact: tuple([read(fact) for read in reads])


def _key(part: Part) -> int | slice:
    return slice(*part) if isinstance(part, tuple) else part


def _only(part: Part) -> int:
    if isinstance(part, tuple):
        raise TypeError(f"no part inside a stretch of fields: {part}")
    return part
