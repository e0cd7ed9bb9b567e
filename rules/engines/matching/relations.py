"""Which alpha memories a fact may belong to: found by its relation and by one constant of the pattern."""

from collections.abc import Callable, Iterator

from rules.engines.matching.facts import Identity, WorkingFact
from rules.engines.matching.memories import AlphaMemory
from rules.engines.matching.patterns import Matching
from rules.engines.matching.places import Place


class Relation:
    """The alpha memories of one relation."""

    def __init__(self) -> None:
        self.tables: dict[int, dict[Identity, list[AlphaMemory]]] = {}  # by field, then by what must stand there
        self.rest: list[AlphaMemory] = []

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
    """All alpha memories; equal patterns share one."""

    def __init__(self) -> None:
        self.relations: dict[tuple[str, bool], Relation] = {}
        self.memories: dict[object, AlphaMemory] = {}

    def memory(self, made: Matching) -> AlphaMemory:
        """Return the memory of the facts that match a pattern by themselves."""
        constants = tuple(made.constants.items())
        spec = (made.relation, made.ordered, constants, tuple(made.spec))
        if spec not in self.memories:
            chosen = next((place for place in made.constants if _direct(place)), None)
            checks = made.checks + [_constant(place, wanted) for place, wanted in constants if place != chosen]
            memory = self.memories[spec] = AlphaMemory(checks)
            relation = self.relations.setdefault((made.relation, made.ordered), Relation())
            field = chosen.field if chosen is not None else None
            assert not isinstance(field, tuple)
            relation.add(memory, field, made.constants.get(chosen) if chosen is not None else None)
        return self.memories[spec]

    def put(self, fact: WorkingFact) -> None:
        """Pass a fact to every memory that it belongs to."""
        relation = self.relations.get((fact.value.relation, fact.value.slots is None))
        if relation is not None:
            for memory in relation.candidates(fact):
                if memory.fits(fact):
                    memory.put(fact)


def _direct(place: Place) -> bool:
    return isinstance(place.field, int) and place.field >= 0 and place.inside is None


def _constant(place: Place, wanted: Identity) -> Callable[[WorkingFact], bool]:
    read = place.identity()
    return lambda fact: bool(read(fact) == wanted)
