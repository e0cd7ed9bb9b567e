"""Equal salience where the order of firing decides: rules that can match at once and take the same fact, or set the same thing."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rules.checks.bounds import constant_globals
from rules.checks.finding import Finding
from rules.checks.together import Singles, can_hold_together, rows_of, singles
from rules.language.syntax import Call, Condition, Constant, Match, Modify, Pattern, Program, Retract, Rule, VariableUse
from rules.language.values import Value
from rules.language.walk import actions_of, calls_of
from rules.language.writing import action_text, expression_text

SETTING = ("behaviour-select", "motivate", "set-gain", "set-threshold", "focus")
VARIABLE = re.compile(r"\?[^\s()?]+")
Row = Sequence[Condition]


@dataclass(frozen=True)
class _Taking:
    """A fact that a rule retracts or modifies; `slots` are those that it changes, None where the fact is gone."""

    binding: str
    slots: frozenset[str] | None


def order_findings(program: Program) -> Iterator[Finding]:
    """Yield a warning for each rule whose order with earlier ones is left to chance."""
    single, constants = singles(program), constant_globals(program)
    taken = {rule.name: _taken(rule) for rule in program.rules}
    set_by = {rule.name: _settings(rule) for rule in program.rules}
    for index, other in enumerate(program.rules):
        rivals: dict[str, list[str]] = {}
        for one in program.rules[:index]:
            if one.salience != other.salience or _does(one) == _does(other):
                continue
            what = _contested(one, other, taken, single, constants) or _set_by_both(
                one, other, set_by, single, constants
            )
            if what is not None:
                rivals.setdefault(what, []).append(f"'{one.name}'")
        for what, names in rivals.items():
            whom = names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
            text = f"'{other.name}' and {whom} can match at once with the same salience and {what}"
            yield Finding(f"{text}: the order is left to chance; (declare (salience ...)) settles it", other.position)


def _does(rule: Rule) -> list[str]:
    """Return what a rule does, its variables by number: rules that do the same need no order."""
    names: dict[str, str] = {}
    return sorted(
        VARIABLE.sub(lambda use: names.setdefault(use[0], f"?{len(names)}"), action_text(a)) for a in rule.actions
    )


def _taken(rule: Rule) -> list[_Taking]:
    found = []
    for action in actions_of(rule.actions):
        if isinstance(action, Retract):
            found += [_Taking(fact.name, None) for fact in action.facts if isinstance(fact, VariableUse)]
        elif isinstance(action, Modify) and isinstance(action.fact, VariableUse):
            found.append(_Taking(action.fact.name, frozenset(slot for slot, _ in action.slots)))
    return found


def _contested(
    one: Rule, other: Rule, taken: Mapping[str, list[_Taking]], single: Singles, constants: Mapping[str, Value]
) -> str | None:
    """Say which facts both take, where they can match at once. Facts of one relation that both take are taken for the same."""
    for a in rows_of(one):
        for b in rows_of(other):
            shared: dict[str, tuple[Pattern, Pattern]] = {}
            for mine in taken[one.name]:
                for theirs in taken[other.name]:
                    first, second = _pattern(a, mine.binding), _pattern(b, theirs.binding)
                    if first is None or second is None or first.relation != second.relation:
                        continue
                    if _disturb(mine, second, theirs, first):
                        shared.setdefault(first.relation, (first, second))
            if shared and can_hold_together(a, b, single, constants, list(shared.values())):
                return f"take the same {' and '.join(f'({relation} ...)' for relation in shared)}"
    return None


def _pattern(row: Row, binding: str) -> Pattern | None:
    return next((c.pattern for c in row if isinstance(c, Match) and c.binding == binding), None)


def _disturb(mine: _Taking, second: Pattern, theirs: _Taking, first: Pattern) -> bool:
    """Say whether one change keeps the other from being made; two that modify different slots do not disturb each other."""
    if mine.slots is None or theirs.slots is None:
        return True
    looked_at = {*(first.slots or ()), *(second.slots or ())}
    return bool(mine.slots & theirs.slots or (mine.slots | theirs.slots) & looked_at)


def _settings(rule: Rule) -> dict[tuple[str, str], Call]:
    """Return what a rule sets by constants' names, by action and name."""
    found: dict[tuple[str, str], Call] = {}
    for call in calls_of(rule):
        if call.function in SETTING and isinstance(call.arguments[0], Constant):
            found[(call.function, str(call.arguments[0].value).replace("-", "_"))] = call
    return found


def _set_by_both(
    one: Rule,
    other: Rule,
    set_by: Mapping[str, Mapping[tuple[str, str], Call]],
    single: Singles,
    constants: Mapping[str, Value],
) -> str | None:
    for key, mine in set_by[one.name].items():
        theirs = set_by[other.name].get(key)
        if theirs is None or _said(mine) == _said(theirs):
            continue
        if any(can_hold_together(a, b, single, constants) for a in rows_of(one) for b in rows_of(other)):
            return f"say different things by ({key[0]} {key[1]} ...)"
    return None


def _said(call: Call) -> list[str]:
    return [expression_text(argument) for argument in call.arguments[1:]]
