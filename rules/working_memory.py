"""Entries of the board as facts in an engine's working memory: only what the rules look at, and only when that changes.

A fact follows from an entry's newest revision. It is asserted anew when a slot that some rule mentions has changed; until then it
stands with the revision that it was asserted with. A fact that a rule retracts stays away until its entry changes again.
"""

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from blackboard.entry import Entry, Support
from blackboard.errors import BoardError
from blackboard.kinds import Kind
from blackboard.vocabulary import Vocabulary
from rules.engines.engine import Engine, FactChange
from rules.language.errors import RuleError
from rules.language.syntax import Program, Slot, Template
from rules.language.templates import KindTemplate, kind_templates
from rules.language.values import NIL, FactValue, Value, same
from rules.language.walk import patterns_in

CLOCK = "clock"  # the template of the mission's clock: (clock (time-s 12.0))


def slots_looked_at(program: Program) -> dict[str, frozenset[str]]:
    """Return, by relation, the slots that the program's patterns mention."""
    found: dict[str, set[str]] = {}
    for rule in program.rules:
        for pattern in patterns_in(rule.conditions):
            found.setdefault(pattern.relation, set()).update(pattern.slots or ())
    return {relation: frozenset(slots) for relation, slots in found.items()}


@dataclass(frozen=True, slots=True)
class _Watched:
    """A kind whose entries become facts."""

    template: KindTemplate
    looked_at: tuple[int, ...]  # places of the slots that rules mention


@dataclass(slots=True)
class _Held:
    entry: Entry[Any]
    fact: FactValue
    index: int | None  # None once a rule has retracted it


@dataclass(frozen=True, slots=True, kw_only=True)
class MemoryRecord:
    """A working memory, frozen: `held` are entry, fact and index by key."""

    facts: Mapping[int, FactValue]
    held: Mapping[str, tuple[Entry[Any], FactValue, int | None]]
    behind: Mapping[int, Support]
    clock: int | None


def fitted(fact: FactValue, templates: Mapping[str, Template]) -> FactValue:
    """Return a fact in the form of its relation's template now; raise RuleError where it does not fit."""
    template = templates.get(fact.relation)
    if template is None or fact.slots is None:
        if (template is None) != (fact.slots is None):
            raise RuleError(
                f"the fact {fact} stands, but '{fact.relation}' is {'no' if template is None else 'a'} template now"
            )
        return fact
    known = {slot.name: slot for slot in template.slots}
    lost = [name for name in fact.slots if name not in known]
    if lost:
        raise RuleError(f"the fact {fact} stands, but '{fact.relation}' has no slot '{lost[0]}' any more")
    given = dict(zip(fact.slots, fact.fields, strict=True))
    fields = tuple(given.get(name, nothing(slot)) for name, slot in known.items())
    return FactValue(fact.relation, fields, tuple(known))


def nothing(slot: Slot) -> Value:
    """Return what stands in a slot that was not given."""
    if slot.default is not None:
        return slot.default
    return () if slot.multi else NIL


class WorkingMemory:
    """Keeps an engine's facts in step with the board, and knows what stands behind each fact."""

    def __init__(self, engine: Engine, vocabulary: Vocabulary) -> None:
        self.engine = engine
        self._vocabulary = vocabulary
        self._watched: dict[str, _Watched] = {}
        looked_at = slots_looked_at(engine.program)
        for path, template in kind_templates(vocabulary).items():
            name = template.template.name
            if name in looked_at:
                names = [slot.name for slot in template.template.slots]
                places = tuple(i for i, slot in enumerate(names) if slot in looked_at[name])
                self._watched[path] = _Watched(template, places)
        self.wants_clock = CLOCK in looked_at
        self._by_key: dict[str, _Watched | None] = {}  # keys seen so far
        self._held: dict[str, _Held] = {}
        self._key_of: dict[int, str] = {}  # by index of a fact that follows from an entry
        self._behind: dict[int, Support] = {}  # by index of a fact
        self._clock: int | None = None

    @property
    def kinds(self) -> list[Kind[Any]]:
        """The kinds that the rules look at."""
        return [self._vocabulary.at(path) for path in self._watched]

    def looks_at(self, key: str) -> bool:
        """Say whether entries at this key become facts."""
        if key not in self._by_key:
            try:
                path = self._vocabulary.parse_key(key)[1].path
            except BoardError:
                path = ""
            self._by_key[key] = self._watched.get(path)
        return self._by_key[key] is not None

    def take(self, entry: Entry[Any]) -> bool:
        """Bring the fact of this entry up to date; return whether working memory changed."""
        if not self.looks_at(entry.key):
            return False
        watched = self._by_key[entry.key]
        held = self._held.get(entry.key)
        if watched is None or (entry.event == "retracted" and held is None):
            return False
        if entry.event == "retracted":
            self._drop(self._held.pop(entry.key))
            return True
        fact = watched.template.fact(entry)
        if held is not None:
            if all(same(held.fact.fields[i], fact.fields[i]) for i in watched.looked_at):
                return False
            self._drop(held)
        self._put(entry, fact)
        return True

    def _put(self, entry: Entry[Any], fact: FactValue) -> None:
        index = self.engine.assert_fact(fact)
        self._held[entry.key] = _Held(entry, fact, index)
        if index is not None:
            self._key_of[index] = entry.key
            self._behind[index] = entry.as_support()

    def _drop(self, held: _Held) -> None:
        if held.index is not None:
            self.engine.retract(held.index)
            self._behind.pop(held.index, None)
            self._key_of.pop(held.index, None)

    def tell_time(self, time_s: float) -> None:
        """Set the clock fact."""
        if self._clock is not None:
            self.engine.retract(self._clock)
        self._clock = self.engine.assert_fact(FactValue(CLOCK, (time_s,), ("time-s",)))

    def support(self, index: int) -> Support | None:
        """Return the revision behind a fact; None for the clock."""
        return self._behind.get(index)

    def put_behind(self, index: int, support: Support) -> None:
        """Say which revision stands behind a fact that follows from no entry."""
        self._behind[index] = support

    def entry_of(self, index: int) -> Entry[Any] | None:
        """Return the entry that a fact follows from; None where it follows from none."""
        key = self._key_of.get(index)
        return None if key is None else self._held[key].entry

    def is_ours(self, index: int) -> bool:
        """Say whether a fact stands by rules' doing: it follows from no entry, and is not the clock."""
        return index not in self._key_of and index != self._clock

    def note_changes(self, changes: Iterable[FactChange], behind: Mapping[int, Support]) -> None:
        """Take note of what a firing did to working memory; `behind` are the entries of the facts that it asserted."""
        for change in changes:
            if change.asserted:
                support = behind.get(change.index)
                if support is not None:
                    self.put_behind(change.index, support)
                continue
            self._behind.pop(change.index, None)
            if change.index == self._clock:
                self._clock = None
            key = self._key_of.pop(change.index, None)
            if key is not None:
                self._held[key].index = None

    def record(self) -> MemoryRecord:
        """Return all facts, and what stands behind them."""
        held = {key: (held.entry, held.fact, held.index) for key, held in self._held.items()}
        return MemoryRecord(facts=self.engine.facts(), held=held, behind=dict(self._behind), clock=self._clock)

    def restore(self, record: MemoryRecord) -> dict[int, int]:
        """Take the facts of another working memory in, this one being empty; return the new index of each by the old one.

        Raises RuleError where a fact does not fit this engine's templates.
        """
        engine = self.engine
        indices: dict[int, int] = {}
        templates = {template.name: template for template in engine.program.templates}
        for old, fact in record.facts.items():
            new = engine.assert_fact(fitted(fact, templates))
            if new is not None:
                indices[old] = new
        for key, (entry, fact, index) in record.held.items():
            if self.looks_at(key):
                there = indices.get(index) if index is not None else None
                self._held[key] = _Held(entry, fact, there)
                if there is not None:
                    self._key_of[there] = key
            elif index is not None and index in indices:  # no rule looks at it any more
                engine.retract(indices.pop(index))
        self._behind = {indices[old]: support for old, support in record.behind.items() if old in indices}
        self._clock = indices.get(record.clock) if record.clock is not None else None
        return indices

    def forget_all_but(self, standing: Container[str]) -> None:
        """Retract the facts of entries that do not stand any more, by their keys."""
        for key in [key for key in self._held if key not in standing]:
            self._drop(self._held.pop(key))
