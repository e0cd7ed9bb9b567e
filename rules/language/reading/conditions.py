"""The left-hand side of rules: patterns, test, not, exists, and, or."""

from collections.abc import Sequence

from rules.language.errors import RuleError
from rules.language.reading.constraints import is_multi, read_constraints
from rules.language.reading.expressions import read_call
from rules.language.reading.facts import no_template, relation_of
from rules.language.reading.forms import Form, Node, word
from rules.language.reading.slots import check_single, slots_of
from rules.language.reading.surroundings import Place, Surroundings
from rules.language.reading.tokens import Token, TokenKind
from rules.language.syntax import (
    All,
    AnyOf,
    Condition,
    Constraint,
    Exists,
    Match,
    Not,
    Pattern,
    Template,
    Test,
)

REFUSED = {
    "forall": "write (not (and (pattern) (not ...)))",
    "logical": "retract in a rule of its own what no longer holds",
    "object": "there are no objects: use deftemplate",
}


def read_conditions(nodes: Sequence[Node], known: Surroundings) -> tuple[Condition, ...]:
    """Return the conditions in order; a faulty one is told and left out."""
    conditions: list[Condition] = []
    rest = list(nodes)
    while rest:
        with known.collecting():
            conditions.append(_next_condition(rest, known))
    return tuple(conditions)


def _next_condition(rest: list[Node], known: Surroundings) -> Condition:
    node = rest.pop(0)
    if isinstance(node, Form):
        return _read_condition(node, known)
    if node.kind is TokenKind.VARIABLE and rest and isinstance(rest[0], Token) and rest[0].text == "<-":
        rest.pop(0)
        if not rest or not isinstance(rest[0], Form):
            raise RuleError(f"?{node.text} <- must be followed by a pattern", node.position)
        form = rest.pop(0)
        assert isinstance(form, Form)
        if form.head in (*REFUSED, "and", "or", "not", "exists", "test"):
            raise RuleError(f"?{node.text} <- stands before one pattern, not before ({form.head} ...)", node.position)
        return Match(_read_pattern(form, known), node.text)
    raise RuleError(f"'{node.text}' is no condition: conditions stand in brackets", node.position)


def _read_condition(form: Form, known: Surroundings) -> Condition:
    head, inner = form.head, form.items[1:]
    if head in REFUSED:
        raise RuleError(f"({head} ...) is not in the language: {REFUSED[head]}", form.position)
    if head == "declare":
        raise RuleError("(declare ...) stands before the first condition", form.position)
    if head == "test":
        if len(inner) != 1 or not isinstance(inner[0], Form):
            raise RuleError("(test ...) takes one expression in brackets: (test (> ?x 3))", form.position)
        return Test(read_call(inner[0], Place.CONDITION, known), form.position)
    if head == "not":
        if len(inner) != 1:
            raise RuleError("(not ...) takes one condition; put several into (and ...)", form.position)
        return Not(_next_condition(list(inner), known), form.position)
    if head in ("exists", "and", "or"):
        if not inner:
            raise RuleError(f"({head} ...) takes at least one condition", form.position)
        conditions = read_conditions(inner, known)
        several: dict[str, type[Exists | All | AnyOf]] = {"exists": Exists, "and": All, "or": AnyOf}
        return several[head](conditions, form.position)
    return Match(_read_pattern(form, known))


def _read_pattern(form: Form, known: Surroundings) -> Pattern:
    relation = relation_of(form, known)
    template = known.templates.get(relation)
    if template is not None:
        return _template_pattern(form, template, known)
    for item in form.items[1:]:
        if isinstance(item, Form) and word(item.items[0] if item.items else item) and not _follows_sign(item, form):
            raise RuleError(no_template(relation, item, known), item.position)
    return Pattern(relation, read_constraints(form.items[1:], known), form.position)


def _follows_sign(item: Form, form: Form) -> bool:
    before = form.items[form.items.index(item) - 1]
    return isinstance(before, Token) and before.text in (":", "=")


def _template_pattern(form: Form, template: Template, known: Surroundings) -> Pattern:
    names: list[str] = []
    constraints: list[Constraint] = []
    for slot, item in slots_of(form.items[1:], template, known):
        read = read_constraints(item.items[1:], known)
        check_single(slot, len(read), item.position)
        if not read:
            raise RuleError(f"write ({slot.name} $?x&:(= (length$ ?x) 0)) for an empty multislot", item.position)
        _refuse_multi(slot.multi, slot.name, read)
        names += [slot.name] * len(read)
        constraints += read
    return Pattern(template.name, tuple(constraints), form.position, tuple(names))


def _refuse_multi(multi: bool, slot: str, constraints: Sequence[Constraint]) -> None:
    for constraint in constraints:
        if is_multi(constraint) and not multi:
            raise RuleError(f"the slot '{slot}' holds one value: write ? in place of $?", constraint.position)
