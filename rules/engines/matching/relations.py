"""Which alpha memories a fact may belong to: found by its relation and by one constant of the pattern.

A fact enters its memories in CLIPS's order, so that what it brings to match is born in the same order: CLIPS keeps the tests of
patterns as a tree, field by field, and goes into the branch that was made last first.
"""

from collections.abc import Callable, Iterator
from operator import attrgetter

from rules.engines.matching.facts import Identity, WorkingFact
from rules.engines.matching.memories import AlphaMemory
from rules.engines.matching.patterns import Matching
from rules.engines.matching.places import Place
from rules.language.errors import RuleError

_order = attrgetter("order")


class Relation:
    """The alpha memories of one relation."""

    def __init__(self) -> None:
        self.tables: dict[int, dict[Identity, list[AlphaMemory]]] = {}  # by field, then by what must stand there
        self.rest: list[AlphaMemory] = []
        self.branches: dict[tuple[object, ...], int] = {}  # how many there are below a path of tests
        self.ranks: dict[tuple[object, ...], int] = {}  # of a path: how many were there before it

    def order(self, path: tuple[object, ...]) -> tuple[int, ...]:
        """Return what sorts memories, from the tests on the way to one."""
        ranks = []
        for length in range(1, len(path) + 1):
            before, here = path[: length - 1], path[:length]
            if here not in self.ranks:
                self.ranks[here] = self.branches[before] = self.branches.get(before, 0) + 1
            ranks.append(-self.ranks[here])
        return tuple(ranks)

    def add(self, memory: AlphaMemory, field: int | None, constant: Identity) -> None:
        if field is None:
            self.rest.append(memory)
        else:
            self.tables.setdefault(field, {}).setdefault(constant, []).append(memory)

    def candidates(self, fact: WorkingFact) -> Iterator[AlphaMemory]:
        """Yield the memories whose constant the fact has, and those without one."""
        for field, table in self.tables.items():
            if field < len(fact.identities):
                yield from table.get(fact.identities[field], ())
        yield from self.rest


class Relations:
    """All alpha memories; equal patterns share one. `note` hears of what a pattern's tests could not evaluate."""

    def __init__(self, note: Callable[[RuleError], None]) -> None:
        self._note = note
        self.relations: dict[tuple[str, bool], Relation] = {}
        self.memories: dict[object, AlphaMemory] = {}

    def memory(self, made: Matching) -> AlphaMemory:
        """Return the memory of the facts that match a pattern by themselves."""
        constants = tuple(made.constants.items())
        path = _path(made)
        spec = (made.relation, made.ordered, *path)
        if spec not in self.memories:
            chosen = next((place for place in made.constants if _direct(place)), None)
            checks = made.checks + [_constant(place, wanted) for place, wanted in constants if place != chosen]
            relation = self.relations.setdefault((made.relation, made.ordered), Relation())
            memory = self.memories[spec] = AlphaMemory(checks, relation.order(path), self._note)
            field = chosen.field if chosen is not None else None
            assert not isinstance(field, tuple)
            relation.add(memory, field, made.constants.get(chosen) if chosen is not None else None)
        return self.memories[spec]

    def put(self, fact: WorkingFact) -> None:
        """Pass a fact to every memory that it belongs to."""
        relation = self.relations.get((fact.value.relation, fact.value.slots is None))
        if relation is not None:
            memories = [memory for memory in relation.candidates(fact) if memory.fits(fact)]
            if len(memories) > 1:
                memories.sort(key=_order)
            for memory in memories:
                memory.put(fact)


def _path(made: Matching) -> tuple[object, ...]:
    """Return the tests on the way to a pattern's memory; CLIPS looks for a constant below a node of its own."""
    path: list[object] = []
    for place, specs in made.specs.items():
        if place in made.constants:
            path.append(("constant", place))
        if specs or made.ordered or place in made.constants:
            path.append((place, made.constants.get(place), *specs))
    return (*path, tuple(here for here, _ in made.keys))


def _direct(place: Place) -> bool:
    return isinstance(place.field, int) and place.field >= 0 and place.inside is None


def _constant(place: Place, wanted: Identity) -> Callable[[WorkingFact], bool]:
    read = place.identity()
    return lambda fact: bool(read(fact) == wanted)
