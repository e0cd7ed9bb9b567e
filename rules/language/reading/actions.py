"""What the right-hand side of a rule does, and the body of a deffunction."""

from collections.abc import Sequence

from rules.language.errors import RuleError
from rules.language.reading.expressions import read_call, read_expression, read_global
from rules.language.reading.facts import empty, read_fact, read_values
from rules.language.reading.forms import Form, Node, word
from rules.language.reading.surroundings import Place, Surroundings
from rules.language.reading.tokens import Token, TokenKind
from rules.language.syntax import Action, Assert, Bind, If, Modify, Retract, VariableUse


def read_actions(nodes: Sequence[Node], place: Place, known: Surroundings) -> tuple[Action, ...]:
    """Return the actions in order; a faulty one is told and left out."""
    actions: list[Action] = []
    for node in nodes:
        with known.collecting():
            actions.append(read_action(node, place, known))
    return tuple(actions)


def read_action(node: Node, place: Place, known: Surroundings) -> Action:
    """Return one action."""
    if not isinstance(node, Form):
        return read_expression(node, place, known)
    head = node.head
    if head in ("assert", "retract", "modify") and place is Place.FUNCTION:
        raise RuleError(f"({head} ...) has no place in a deffunction: functions change nothing", node.position)
    if head == "assert":
        if len(node.items) == 1:
            raise RuleError("(assert ...) takes at least one fact", node.position)
        return Assert(tuple(read_fact(item, place, known) for item in node.items[1:]), node.position)
    if head == "retract":
        return Retract(_facts(node), node.position)
    if head == "modify":
        return _read_modify(node, place, known)
    if head == "bind":
        return _read_bind(node, place, known)
    if head == "if":
        return _read_if(node, place, known)
    return read_call(node, place, known, statement=True)


def _facts(form: Form) -> tuple[VariableUse, ...]:
    if len(form.items) == 1:
        raise RuleError("(retract ...) takes at least one ?fact", form.position)
    return tuple(_fact(item, form) for item in form.items[1:])


def _fact(item: Node | None, form: Form) -> VariableUse:
    if not isinstance(item, Token) or item.kind is not TokenKind.VARIABLE:
        where = form.position if item is None else item.position
        raise RuleError(f"({form.head} ...) takes what ?fact <- (pattern) has bound", where)
    return VariableUse(item.text, item.position)


def _read_modify(form: Form, place: Place, known: Surroundings) -> Modify:
    fact = _fact(form.items[1] if len(form.items) > 1 else None, form)
    slots: dict[str, tuple[str, tuple[object, ...]]] = {}
    changes = []
    for item in form.items[2:]:
        if not isinstance(item, Form) or not item.items or not word(item.items[0]):
            raise RuleError("write (modify ?fact (slot value) ...)", item.position)
        if item.head in slots:
            raise RuleError(f"the slot '{item.head}' stands there twice", item.position)
        slots[item.head] = (item.head, ())
        values = read_values(item, place, known)
        changes.append((item.head, values or (empty(item.position),)))
    if not changes:
        raise RuleError("(modify ?fact ...) names no slot", form.position)
    return Modify(fact, tuple(changes), form.position)


def _read_bind(form: Form, place: Place, known: Surroundings) -> Bind:
    target = form.items[1] if len(form.items) > 1 else None
    if not isinstance(target, Token) or target.kind not in (TokenKind.VARIABLE, TokenKind.GLOBAL):
        raise RuleError("(bind ...) takes a ?variable or a ?*global*, then the value", form.position)
    values = tuple(read_expression(value, place, known) for value in form.items[2:])
    if not values:
        raise RuleError(f"(bind ?{target.text}) has no value to bind", form.position)
    is_global = target.kind is TokenKind.GLOBAL
    if is_global:
        if place is Place.FUNCTION:
            raise RuleError("a deffunction sets no globals: functions change nothing", form.position)
        read_global(target, known)
    return Bind(target.text, values, form.position, is_global)


def _read_if(form: Form, place: Place, known: Surroundings) -> If:
    words = [word(item) for item in form.items]
    if len(form.items) < 3 or words[2] != "then":
        raise RuleError("write (if condition then action ... else action ...)", form.position)
    condition = read_expression(form.items[1], place, known)
    end = words.index("else", 3) if "else" in words[3:] else len(words)
    then = read_actions(form.items[3:end], place, known)
    return If(condition, then, read_actions(form.items[end + 1 :], place, known), form.position)
