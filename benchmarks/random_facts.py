"""Random facts for a program that is given: of the relations that its rules look at, with the values that they look for.

Values stand where they fit: a place is for numbers where a rule calculates with what it binds there, or writes a number there; what
one variable joins is alike.
"""

from collections.abc import Iterable, Iterator
from random import Random

from rules.language.syntax import (
    All,
    AnyOf,
    Call,
    Condition,
    Constant,
    Exists,
    Expression,
    FactForm,
    Match,
    Not,
    Pattern,
    Predicate,
    Program,
    Returned,
    Rule,
    Test,
    VariableUse,
)
from rules.language.values import FactValue, Symbol, Value
from rules.language.walk import asserted, patterns_in

Place = tuple[str, str | int]  # a relation, and its slot or the position of the field
ALIKE = ("eq", "neq", "str-cat", "sym-cat", "post", "printout", "not", "and", "or")  # say nothing about kinds
NAMES = tuple(map(Symbol, ("one", "two", "three")))
NUMBERS = (0.0, 0.1, 0.6, 1.0, 2.5, 45.0, 1, 2, 3)


class FactMaker:
    """Makes facts for one program."""

    def __init__(self, program: Program, random: Random) -> None:
        self.random = random
        self.rules = program.rules
        self.templates = {template.name: template for template in program.templates}
        self.shapes: dict[str, list[str | int]] = {}
        self.constants: dict[Place, list[Value]] = {}
        self.numeric: dict[Place, bool] = {}
        self._joined: list[list[Place]] = []
        for rule in program.rules:
            self._look_at(rule)
        for deffacts in program.deffacts:
            for form in deffacts.facts:
                self._form(form, {})
        changed = True
        while changed:
            changed = False
            for places in self._joined:
                if any(place in self.numeric for place in places) and not all(
                    place in self.numeric for place in places
                ):
                    self.numeric |= dict.fromkeys(places, True)
                    changed = True

    def fact(self, relation: str | None = None) -> FactValue:
        """Return a fact, of this relation where one is named."""
        relation = relation or self.random.choice(sorted(self.shapes))
        template = self.templates.get(relation)
        if template is None:
            return FactValue(relation, tuple(self._value((relation, at)) for at in self.shapes[relation]))
        values: list[Value] = []
        for slot in template.slots:
            value = self._value((relation, slot.name))
            values.append((value,) if slot.multi else value)
        return FactValue(relation, tuple(values), tuple(slot.name for slot in template.slots))

    def facts(self) -> Iterator[FactValue]:
        """Yield facts: now one at random, now those that a rule asks for together."""
        rules = [list(_wanted(rule.conditions)) for rule in self.rules]
        while True:
            yield self.fact()
            if rules and self.random.random() < 0.5:
                bound: dict[str, Value] = {}
                for pattern in self.random.choice(rules):
                    yield self._fitting(pattern, bound)

    def _fitting(self, pattern: Pattern, bound: dict[str, Value]) -> FactValue:
        """Return a fact with the constants of a pattern and the values of its variables; those not bound yet are drawn."""
        fact = self.fact(pattern.relation)
        values = list(fact.fields)
        for (_, at), constraint in zip(self._places(pattern), pattern.constraints, strict=True):
            where = at if isinstance(at, int) else (fact.slots or ()).index(at)
            if where >= len(values) or isinstance(values[where], tuple):
                continue
            name = constraint.binds.name if constraint.binds is not None else None
            for atom in constraint.alternatives[0] if constraint.alternatives else ():
                if isinstance(atom.term, Constant) and not atom.negated:
                    values[where] = atom.term.value
                elif isinstance(atom.term, VariableUse) and not atom.negated:
                    name = atom.term.name
            if name is not None:
                values[where] = bound.setdefault(name, values[where])
        return FactValue(fact.relation, tuple(values), fact.slots)

    def _value(self, place: Place) -> Value:
        if place in self.numeric:
            return self.random.choice(NUMBERS)
        known = self.constants.get(place, [])
        return self.random.choice([*known, *known, *NAMES])

    def _look_at(self, rule: Rule) -> None:
        bound: dict[str, list[Place]] = {}
        for pattern in patterns_in(rule.conditions):
            for at, constraint in zip(self._places(pattern), pattern.constraints, strict=True):
                for term in (constraint.binds, *(atom.term for row in constraint.alternatives for atom in row)):
                    if isinstance(term, VariableUse):
                        bound.setdefault(term.name, []).append(at)
                    elif isinstance(term, Constant):
                        self._constant(at, term.value)
                    elif isinstance(term, Returned):
                        self.numeric[at] = True
        self._joined += bound.values()
        for expression in _expressions(rule):
            self._calculated(expression, bound)
        for form in asserted(rule):
            self._form(form, bound)

    def _places(self, pattern: Pattern | FactForm) -> list[Place]:
        fields = pattern.constraints if isinstance(pattern, Pattern) else pattern.fields
        places: list[str | int] = [*pattern.slots] if pattern.slots is not None else [*range(len(fields))]
        if len(places) >= len(self.shapes.get(pattern.relation, [])):
            self.shapes[pattern.relation] = list(places)
        return [(pattern.relation, place) for place in places]

    def _constant(self, at: Place, value: Value) -> None:
        self.constants.setdefault(at, []).append(value)
        if isinstance(value, int | float):
            self.numeric[at] = True

    def _form(self, form: FactForm, bound: dict[str, list[Place]]) -> None:
        for at, field in zip(self._places(form), form.fields, strict=True):
            if isinstance(field, Constant):
                self._constant(at, field.value)
            elif isinstance(field, VariableUse):
                self._joined.append([at, *bound.get(field.name, [])])
            elif not isinstance(field, Call) or field.function not in ALIKE:
                self.numeric[at] = True

    def _calculated(self, expression: Expression, bound: dict[str, list[Place]]) -> None:
        if isinstance(expression, Call):
            for argument in expression.arguments:
                if isinstance(argument, VariableUse) and expression.function not in ALIKE:
                    self.numeric |= dict.fromkeys(bound.get(argument.name, []), True)
                self._calculated(argument, bound)


def _wanted(conditions: Iterable[Condition]) -> Iterator[Pattern]:
    """Yield the patterns for which there must be facts, all ways through an `or` among them."""
    for condition in conditions:
        if isinstance(condition, Match):
            yield condition.pattern
        elif isinstance(condition, Exists | All | AnyOf):
            yield from _wanted(condition.conditions)


def _tests(conditions: Iterable[Condition]) -> Iterator[Expression]:
    for condition in conditions:
        if isinstance(condition, Test):
            yield condition.expression
        elif isinstance(condition, Not):
            yield from _tests((condition.condition,))
        elif isinstance(condition, Exists | All | AnyOf):
            yield from _tests(condition.conditions)


def _expressions(rule: Rule) -> Iterator[Expression]:
    """Yield what a rule's conditions calculate."""
    yield from _tests(rule.conditions)
    for pattern in patterns_in(rule.conditions):
        for constraint in pattern.constraints:
            for row in constraint.alternatives:
                yield from (atom.term.expression for atom in row if isinstance(atom.term, Predicate | Returned))
    for form in asserted(rule):
        yield from form.fields
