"""Whole constructs: deftemplate, deffacts, defglobal, deffunction, defrule."""

from collections.abc import Mapping, Sequence

from rules.language.errors import RuleError
from rules.language.evaluation import evaluate
from rules.language.reading.actions import read_actions
from rules.language.reading.conditions import read_conditions
from rules.language.reading.expressions import read_expression
from rules.language.reading.facts import read_fact
from rules.language.reading.forms import Form, Node, name_of, word
from rules.language.reading.surroundings import Place, Surroundings
from rules.language.reading.tokens import Token, TokenKind
from rules.language.syntax import Deffacts, Function, Global, Position, Rule, Slot, Template
from rules.language.values import Value

SALIENCES = (-10_000, 10_000)  # those that CLIPS takes
SLOT_HINT = "values are not checked against types here: leave it out"


def named(form: Form) -> tuple[str, str, list[Node]]:
    """Return a construct's name, its documentation, and the rest."""
    name = name_of(form.items[1] if len(form.items) > 1 else None, f"the name of the {form.head}", form.position)
    rest = form.items[2:]
    if rest and isinstance(rest[0], Token) and isinstance(rest[0].value, str):
        return name, rest[0].value, rest[1:]
    return name, "", rest


def read_template(form: Form, known: Surroundings) -> Template:
    """`(deftemplate name [doc] (slot name [(default value)]) ...)`."""
    name, doc, rest = named(form)
    slots: list[Slot] = []
    for item in rest:
        with known.collecting():
            slot = _read_slot(item, known)
            if any(slot.name == other.name for other in slots):
                raise RuleError(f"the slot '{slot.name}' stands there twice", item.position)
            slots.append(slot)
    return Template(name, tuple(slots), doc, form.position)


def _read_slot(item: Node, known: Surroundings) -> Slot:
    if not isinstance(item, Form) or item.head not in ("slot", "multislot"):
        raise RuleError("a template holds (slot name) and (multislot name)", item.position)
    name = name_of(item.items[1] if len(item.items) > 1 else None, "the name of the slot", item.position)
    default: Value | None = None
    for attribute in item.items[2:]:
        if not isinstance(attribute, Form) or attribute.head != "default":
            what = f"({attribute.head} ...)" if isinstance(attribute, Form) else "this"
            raise RuleError(f"{what} is not in the language; {SLOT_HINT}", attribute.position)
        default = _read_default(attribute, item.head == "multislot", known)
    return Slot(name, item.head == "multislot", default)


def _read_default(form: Form, multi: bool, known: Surroundings) -> Value:
    if any(isinstance(item, Token) and item.kind is TokenKind.VARIABLE for item in form.items[1:]):
        raise RuleError(
            "?NONE and ?DERIVE are not in the language: write a value, or leave (default ...) out", form.position
        )
    values = [evaluate(read_expression(item, Place.START, known), {}, {}) for item in form.items[1:]]
    if multi:
        return tuple(part for value in values for part in (value if isinstance(value, tuple) else (value,)))
    if len(values) != 1 or isinstance(values[0], tuple):
        raise RuleError("the default of a slot is one value", form.position)
    return values[0]


def read_deffacts(form: Form, known: Surroundings) -> Deffacts:
    """`(deffacts name [doc] fact ...)`."""
    name, doc, rest = named(form)
    facts = []
    for item in rest:
        with known.collecting():
            facts.append(read_fact(item, Place.START, known))
    return Deffacts(name, tuple(facts), form.position, doc)


def read_globals(form: Form, known: Surroundings) -> list[Global]:
    """`(defglobal ?*name* = value ...)`."""
    rest, found = form.items[1:], []
    while rest:
        target = rest[0]
        if not isinstance(target, Token) or target.kind is not TokenKind.GLOBAL:
            raise RuleError("write (defglobal ?*name* = value ...)", target.position)
        if len(rest) < 3 or word(rest[1]) != "=":
            raise RuleError(f"write ?*{target.text}* = value", target.position)
        with known.collecting():
            found.append(Global(target.text, read_expression(rest[2], Place.START, known), target.position))
        rest = rest[3:]
    return found


def global_names(form: Form) -> list[tuple[str, Position]]:
    """Return what a defglobal defines."""
    return [
        (token.text, token.position)
        for token, after in zip(form.items, form.items[1:], strict=False)
        if isinstance(token, Token) and token.kind is TokenKind.GLOBAL and word(after) == "="
    ]


def function_header(form: Form) -> tuple[str, str, tuple[str, ...], str | None, list[Node]]:
    """Return a deffunction's name, documentation, parameters, the one that takes the rest, and the body."""
    name, doc, rest = named(form)
    if not rest or not isinstance(rest[0], Form):
        raise RuleError(f"the parameters of '{name}' are missing: (deffunction {name} (?a ?b) ...)", form.position)
    parameters: list[str] = []
    more: str | None = None
    for item in rest[0].items:
        if not isinstance(item, Token) or item.kind not in (TokenKind.VARIABLE, TokenKind.MULTI_VARIABLE):
            raise RuleError("a parameter is ?name, or $?name for all that remain", item.position)
        if more is not None:
            raise RuleError(f"$?{more} takes all that remains: it must stand last", item.position)
        if item.text in parameters:
            raise RuleError(f"the parameter ?{item.text} stands there twice", item.position)
        if item.kind is TokenKind.VARIABLE:
            parameters.append(item.text)
        else:
            more = item.text
    return name, doc, tuple(parameters), more, rest[1:]


def read_function(form: Form, known: Surroundings) -> Function:
    """`(deffunction name [doc] (?a ... [$?rest]) expression ...)`."""
    name, doc, parameters, more, body = function_header(form)
    return Function(name, parameters, more, read_actions(body, Place.FUNCTION, known), form.position, doc)


def read_rule(form: Form, known: Surroundings, globals_: Mapping[str, Value]) -> Rule:
    """`(defrule name [doc] [(declare (salience n))] condition ... => action ...)`."""
    name, doc, rest = named(form)
    arrows = [index for index, item in enumerate(rest) if word(item) == "=>"]
    if len(arrows) != 1:
        wrong = "the => between conditions and actions is missing" if not arrows else "a second =>"
        raise RuleError(f"the rule '{name}': {wrong}", rest[arrows[1]].position if arrows else form.position)
    conditions, actions = rest[: arrows[0]], rest[arrows[0] + 1 :]
    salience = 0
    if conditions and isinstance(conditions[0], Form) and conditions[0].head == "declare":
        with known.collecting():
            salience = _read_salience(conditions[0], known, globals_)
        conditions = conditions[1:]
    left = read_conditions(conditions, known)
    return Rule(name, left, read_actions(actions, Place.ACTION, known), form.position, salience, doc)


def _read_salience(form: Form, known: Surroundings, globals_: Mapping[str, Value]) -> int:
    inner: Sequence[Node] = form.items[1:]
    if len(inner) != 1 or not isinstance(inner[0], Form) or inner[0].head != "salience" or len(inner[0].items) != 2:
        raise RuleError("write (declare (salience n)); nothing else can be declared", form.position)
    written = inner[0].items[1]
    if not isinstance(written, Token) or written.kind not in (TokenKind.CONSTANT, TokenKind.GLOBAL):
        raise RuleError("a salience is an integer or a ?*global*", written.position)
    value = evaluate(read_expression(written, Place.START, known), {}, globals_)
    if not isinstance(value, int):
        raise RuleError("a salience is an integer or a ?*global* that holds one", written.position)
    if not SALIENCES[0] <= value <= SALIENCES[1]:
        raise RuleError(f"the salience {value} is out of range: {SALIENCES[0]} to {SALIENCES[1]}", written.position)
    return value
