"""Why a rule does not fire: its conditions are tried in order on the facts, and the first that nothing gets past is told."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from rules.explaining.matching import Bindings, Matcher, rounded, test_text
from rules.language.alternatives import alternatives
from rules.language.syntax import Condition, Exists, Match, Not, Pattern, Position, Program, Rule, Test
from rules.language.values import FactValue, Value
from rules.language.writing import condition_text

NEAREST_SHOWN = 3
FARTHER = 1  # a fact with more differences than the nearest has, and this, says nothing more
BRIEF_LETTERS = 120
MOST_STEPS = 500_000  # facts looked at: a join that big is cut off, and that is told


@dataclass(frozen=True, slots=True)
class Way:
    """Facts that match a rule's conditions so far, by their indices (None: no one fact), and what the variables are."""

    facts: tuple[int | None, ...] = ()
    bindings: Mapping[str, Value] = field(default_factory=dict)


NO_WAY = Way()


@dataclass(frozen=True, slots=True)
class Obstacle:
    """The condition that keeps a rule from firing, the `number`-th of `total` as they write out, and the reasons in words.

    `ways` ways through the conditions before it lead there; `best` is the first of them.
    """

    condition: Condition
    number: int
    total: int
    verdict: str
    reasons: tuple[str, ...]
    ways: int
    best: Way

    @property
    def text(self) -> str:
        """The condition as it is written."""
        return condition_text(self.condition)

    @property
    def position(self) -> Position:
        """Where it stands."""
        return self.condition.pattern.position if isinstance(self.condition, Match) else self.condition.position

    @property
    def pattern(self) -> Pattern | None:
        """The pattern of the facts that it asks for, or that must not stand; None for a test."""
        condition = self.condition
        while not isinstance(condition, Match | Test):
            condition = condition.condition if isinstance(condition, Not) else condition.conditions[0]
        return condition.pattern if isinstance(condition, Match) else None


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a rule's conditions hold: all `ways` in which they do, else the obstacle on the way that leads farthest."""

    rule: Rule
    ways: tuple[Way, ...] = ()
    obstacle: Obstacle | None = None
    cut_off: bool = False


def why_not(program: Program, rule: Rule, facts: Mapping[int, FactValue]) -> Verdict:
    """Return whether the rule's conditions hold for these facts, and if not, why."""
    search = _Search(Matcher(program), facts)
    ways: list[Way] = []
    obstacles: list[Obstacle] = []
    for row in alternatives(rule.conditions):
        found, obstacle = search.through(row)
        ways += found
        if obstacle is not None:
            obstacles.append(obstacle)
    cut_off = search.steps > MOST_STEPS
    if ways or not obstacles:
        return Verdict(rule, tuple(ways), cut_off=cut_off)
    return Verdict(rule, obstacle=max(obstacles, key=lambda obstacle: obstacle.number), cut_off=cut_off)


class _Search:
    """Looks for facts that match conditions, going back where it does not go on."""

    def __init__(self, matcher: Matcher, facts: Mapping[int, FactValue]) -> None:
        self._matcher = matcher
        self._facts = facts
        self._by_relation: dict[str, list[int]] = {}
        for index, fact in facts.items():
            self._by_relation.setdefault(fact.relation, []).append(index)
        self.steps = 0

    def through(self, conditions: Sequence[Condition], begun: Way = NO_WAY) -> tuple[list[Way], Obstacle | None]:
        """Return every way through all conditions; where there is none, the first condition that stops them all."""
        reached = [begun]
        for number, condition in enumerate(conditions, 1):
            ahead = [way for before in reached for way in self._past(condition, before)]
            if not ahead:
                verdict, reasons = self._reasons(condition, reached)
                return [], Obstacle(condition, number, len(conditions), verdict, reasons, len(reached), reached[0])
            reached = ahead
        return reached, None

    def _past(self, condition: Condition, way: Way) -> Iterator[Way]:
        if isinstance(condition, Match):
            for index, bindings in self._matches(condition.pattern, way.bindings):
                yield Way((*way.facts, index), bindings)
        elif isinstance(condition, Test):
            if self._matcher.true(condition.expression, way.bindings):
                yield Way((*way.facts, None), way.bindings)
        else:
            inner = (condition.condition,) if isinstance(condition, Not) else condition.conditions
            if (self._within(inner, way) is None) is isinstance(condition, Not):
                yield Way((*way.facts, None), way.bindings)

    def _within(self, conditions: Sequence[Condition], way: Way) -> Way | None:
        """Return the first way through conditions within `not` or `exists`, whichever way their `or`s go."""
        rows = alternatives(conditions)
        return next((ahead for row in rows for ahead in self._all_of(row, way)), None)

    def _all_of(self, conditions: Sequence[Condition], way: Way) -> Iterator[Way]:
        if not conditions:
            yield way
            return
        for ahead in self._past(conditions[0], way):
            yield from self._all_of(conditions[1:], ahead)

    def _matches(self, pattern: Pattern, bindings: Bindings) -> Iterator[tuple[int, dict[str, Value]]]:
        for index in self._by_relation.get(pattern.relation, ()):
            self.steps += 1
            if self.steps > MOST_STEPS:
                return
            bound = self._matcher.match(pattern, self._facts[index], bindings)
            if bound is not None:
                yield index, bound

    # In words

    def _reasons(self, condition: Condition, reached: Sequence[Way]) -> tuple[str, tuple[str, ...]]:
        if isinstance(condition, Match):
            return "no fact matches it", tuple(self._nearest(condition.pattern, reached))
        if isinstance(condition, Test):
            shown = [test_text(condition.expression, way.bindings) for way in reached]
            return "it is FALSE", tuple(f"FALSE: {text}" for text in _first(shown))
        if isinstance(condition, Not):
            found = [self._within((condition.condition,), way) for way in reached]
            return "what must not be is so", tuple(
                _first(self._there(w, way) for w, way in zip(found, reached, strict=True))
            )
        assert isinstance(condition, Exists)
        for way in reached:
            for row in alternatives(condition.conditions):
                _, obstacle = self.through(row, way)
                if obstacle is not None:
                    return "nothing like that exists", obstacle.reasons
        return "nothing like that exists", ()

    def _there(self, found: Way | None, way: Way) -> str:
        """Return what stands that must not: the facts on the way through a negated condition."""
        indices = found.facts[len(way.facts) :] if found is not None else ()
        facts = [brief(self._facts[index]) for index in indices if index is not None]
        return f"there is {' '.join(facts)}" if facts else "what it excludes holds"

    def _nearest(self, pattern: Pattern, reached: Sequence[Way]) -> Iterator[str]:
        """Yield the facts that come nearest to a pattern, with what is different in them."""
        indices = self._by_relation.get(pattern.relation, ())
        if not indices:
            yield f"there is no fact ({pattern.relation} ...) at all"
            return
        told: dict[int, tuple[int, str]] = {}
        for way in reached[:50]:
            for index in indices:
                differences = self._matcher.differences(pattern, self._facts[index], way.bindings)
                if index not in told or len(differences) < told[index][0]:
                    told[index] = (len(differences), ", ".join(map(str, differences)))
        nearest = sorted(told.items(), key=lambda item: (item[1][0], -item[0]))
        near = [(index, text) for index, (count, text) in nearest if count <= nearest[0][1][0] + FARTHER][
            :NEAREST_SHOWN
        ]
        for index, text in near:
            yield f"{brief(self._facts[index], pattern.slots)}: {text}"
        if len(nearest) > len(near):
            yield f"and {len(nearest) - len(near)} more that differ as much or more"


def brief(fact: FactValue, asked: Iterable[str] | None = None) -> str:
    """Return a fact by the slots that are asked about (and its id), else without what only tells where it came from."""
    if fact.slots is not None:
        shown = ("id", *asked) if asked is not None else [slot for slot in fact.slots if slot not in ("key", "stamp-s")]
        kept = [i for i, slot in enumerate(fact.slots) if slot in shown]
        slots = tuple(fact.slots[i] for i in kept)
        fact = FactValue(fact.relation, tuple(rounded(fact.fields[i]) for i in kept), slots)
    else:
        fact = FactValue(fact.relation, tuple(map(rounded, fact.fields)))
    text = str(fact)
    return text if len(text) <= BRIEF_LETTERS else f"{text[: BRIEF_LETTERS - 4]}...)"


def _first(texts: Iterable[str]) -> list[str]:
    found = list(dict.fromkeys(texts))
    more = len(found) - NEAREST_SHOWN
    return [*found[:NEAREST_SHOWN], f"and {more} more"] if more > 0 else found
