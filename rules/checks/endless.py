"""Rules that go on for ever: one that makes its own conditions true again, and two that undo each other."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from rules.checks.facts import is_several
from rules.checks.finding import Finding
from rules.checks.together import asked, field_of, implies, is_plain, keys_of, rows_of, variable_of
from rules.language.syntax import (
    Assert,
    Atom,
    Call,
    Condition,
    Constant,
    Constraint,
    Exists,
    Expression,
    FactForm,
    Match,
    Modify,
    Not,
    Pattern,
    Program,
    Retract,
    Rule,
    Test,
    VariableUse,
    Wildcard,
)
from rules.language.walk import patterns_in
from rules.language.writing import condition_text, expression_text

VARIABLE = re.compile(r"\$?\?[^*]")


@dataclass(frozen=True)
class _Way:
    """One way in which a rule matches, and what it surely does then (`if` is not looked into)."""

    row: Sequence[Condition]
    gone: tuple[Pattern, ...]
    made: tuple[FactForm, ...]
    changed: tuple[tuple[Pattern, Modify], ...]
    halts: bool

    @property
    def matches(self) -> list[Pattern]:
        return [condition.pattern for condition in self.row if isinstance(condition, Match)]

    @property
    def negated(self) -> list[Not]:
        return [condition for condition in self.row if isinstance(condition, Not)]

    @property
    def kept(self) -> list[Pattern]:
        """The patterns whose facts still stand after the rule has fired."""
        touched = [*self.gone, *(pattern for pattern, _ in self.changed)]
        return [pattern for pattern in self.matches if pattern not in touched]

    def joined(self) -> set[str]:
        """The variables that more than one place of the conditions speaks of: their values matter."""
        uses: Counter[str] = Counter()
        for condition in self.row:
            uses.update(_variables(condition))
        return {name for name, number in uses.items() if number > 1}


def endless_findings(program: Program) -> Iterator[Finding]:
    """Yield the rules that surely never come to an end once they have begun."""
    ways = {rule.name: [_way(rule, row) for row in rows_of(rule)] for rule in program.rules}
    for rule in program.rules:
        if any(_goes_on(way) for way in ways[rule.name]):
            text = f"'{rule.name}' makes its own conditions true again each time it fires, so it never ends"
            yield Finding(f"{text}: retract what it waits for, or test for an end", rule.position)
    for one, other in combinations(program.rules, 2):
        if any(_undo(a, b) for a in ways[one.name] for b in ways[other.name]):
            text = f"'{other.name}' and '{one.name}' undo each other without end"
            yield Finding(f"{text}: one needs a condition that the other does not leave true", other.position)


def _way(rule: Rule, row: Sequence[Condition]) -> _Way:
    by_name = {c.binding: c.pattern for c in row if isinstance(c, Match) and c.binding is not None}
    gone: list[Pattern] = []
    made: list[FactForm] = []
    changed: list[tuple[Pattern, Modify]] = []
    for action in rule.actions:
        if isinstance(action, Retract):
            gone += [by_name[f.name] for f in action.facts if isinstance(f, VariableUse) and f.name in by_name]
        elif isinstance(action, Assert):
            made += action.facts
        elif isinstance(action, Modify) and isinstance(action.fact, VariableUse) and action.fact.name in by_name:
            changed.append((by_name[action.fact.name], action))
    halts = any(isinstance(action, Call) and action.function == "halt" for action in rule.actions)
    return _Way(row, tuple(gone), tuple(made), tuple(changed), halts)


def _goes_on(way: _Way) -> bool:
    joined = way.joined()
    renewed = [p for p in way.gone if any(_surely(form, p, joined) for form in way.made)]
    fresh = [p for p in way.kept if any(_surely(form, p, joined) and _is_new(form) for form in way.made)]
    changed = [p for p, modify in way.changed if _still(modify, p, joined)]
    if way.halts or len(renewed) < len(way.gone) or len(changed) < len(way.changed):
        return False
    disturbed = {form.relation for form in way.made} | {pattern.relation for pattern, _ in way.changed}
    for condition in way.row:
        if isinstance(condition, Not | Exists) and any(p.relation in disturbed for p in patterns_in((condition,))):
            return False
    return bool(renewed or fresh or changed)


def _still(modify: Modify, pattern: Pattern, joined: set[str]) -> bool:
    """Say whether a modified fact matches as before, and is another each time."""
    is_new = False
    for slot, values in modify.slots:
        constraint = field_of(pattern, slot)
        if constraint is not None and not _admits_surely(constraint, values[0] if len(values) == 1 else None, joined):
            return False
        is_new = is_new or any(isinstance(value, Call) and _variables_in(value) for value in values)
    return is_new


def _is_new(form: FactForm) -> bool:
    """Say whether the fact is another each time: a field is computed from what matched."""
    return any(isinstance(field, Call) and _variables_in(field) for field in form.fields)


def _undo(a: _Way, b: _Way) -> bool:
    if a.halts or b.halts or a.changed or b.changed:
        return False
    if not (_sets_off(a, b) and _sets_off(b, a)):
        return False
    return (_holds_after(a, b) and _holds_again(b, a)) or (_holds_after(b, a) and _holds_again(a, b))


def _sets_off(a: _Way, b: _Way) -> bool:
    """Say whether `a` brings about anew what `b` takes away: a fact, or that there is none."""
    joined = b.joined()
    if any(_surely(form, pattern, joined) for form in a.made for pattern in b.gone):
        return True
    return any(
        isinstance(no.condition, Match)
        and implies(no.condition.pattern, pattern, ())
        and _makes(b, no.condition.pattern)
        for no in b.negated
        for pattern in a.gone
    )


def _makes(way: _Way, pattern: Pattern) -> bool:
    return any(_surely(form, pattern, set()) for form in way.made)


def _holds_again(a: _Way, b: _Way) -> bool:
    """Say whether `b`, which fired before `a`, can fire once more: what it left standing and `a` did not take still stands."""
    taken = [pattern.relation for pattern in a.gone]
    return _holds_after(a, b, [pattern for pattern in b.kept if pattern.relation not in taken])


def _holds_after(a: _Way, b: _Way, standing: Sequence[Pattern] = ()) -> bool:
    """Say whether all conditions of `b` surely hold once `a` has fired, with what else is known to stand."""
    joined = b.joined()
    kept_nots = {condition_text(no) for no in a.negated if not _touches(a, no)}
    tests = {expression_text(call) for call in asked(a.row)}
    for condition in b.row:
        if isinstance(condition, Match):
            pattern = condition.pattern
            made = any(_surely(form, pattern, joined) for form in a.made)
            if not made and not any(implies(kept, pattern, joined) for kept in (*a.kept, *standing)):
                return False
        elif isinstance(condition, Not):
            inner = condition.condition
            gone = isinstance(inner, Match) and any(implies(inner.pattern, pattern, ()) for pattern in a.gone)
            if _touches(a, condition) or not (gone or condition_text(condition) in kept_nots):
                return False
        elif not isinstance(condition, Test):
            return False
    return all(expression_text(call) in tests and not _variables_in(call) for call in asked(b.row))


def _touches(way: _Way, no: Not) -> bool:
    """Say whether a rule asserts what a (not ...) is about."""
    return any(pattern.relation == form.relation for pattern in patterns_in((no,)) for form in way.made)


def _surely(form: FactForm, pattern: Pattern, joined: set[str]) -> bool:
    """Say whether an asserted fact matches a pattern whatever its variables hold."""
    if form.relation != pattern.relation or len(keys_of(pattern)) < len(pattern.constraints):
        return False
    if pattern.slots is None:
        if len(form.fields) != len(pattern.constraints) or form.slots is not None:
            return False
        return all(_admits_surely(c, f, joined) for c, f in zip(pattern.constraints, form.fields, strict=True))
    values = dict(zip(form.slots or (), form.fields, strict=True))
    return all(
        _admits_surely(constraint, values.get(slot), joined)
        for slot, constraint in zip(pattern.slots, pattern.constraints, strict=True)
    )


def _admits_surely(constraint: Constraint, value: Expression | None, joined: set[str]) -> bool:
    term = constraint.alternatives[0][0].term
    if isinstance(term, Wildcard):
        return not is_several(constraint)
    name = variable_of(constraint)
    if name in joined and not (isinstance(value, VariableUse) and value.name == name):
        return False
    if is_plain(constraint) and name is not None:
        return not is_several(constraint)
    return isinstance(value, Constant) and any(
        all(_is(atom, value) for atom in atoms) for atoms in constraint.alternatives
    )


def _is(atom: Atom, value: Constant) -> bool:
    return isinstance(atom.term, Constant) and (atom.term.value == value.value) is not atom.negated


def _variables(condition: Condition) -> list[str]:
    """Return the variables of a condition, as often as they stand there."""
    return [part.partition(" ")[0] for part in _words(condition_text(condition))]


def _words(text: str) -> list[str]:
    spaced = "".join(letter if letter not in "()&|~" else " " for letter in text)
    return [word.removeprefix("$")[1:] for word in spaced.split() if VARIABLE.match(word)]


def _variables_in(expression: Expression) -> list[str]:
    return _words(expression_text(expression))
