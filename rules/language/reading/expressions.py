"""Forms to expressions: constants, variables, globals, and calls of functions that exist with as many arguments as they take."""

from blackboard.errors import did_you_mean
from rules.language.argument_kinds import kinds_of, unfit
from rules.language.errors import RuleError
from rules.language.reading.forms import Form, Node, name_of, word
from rules.language.reading.surroundings import Place, Surroundings
from rules.language.reading.tokens import Token, TokenKind
from rules.language.reading.vocabulary import (
    ARITIES,
    BOARD_ACTIONS,
    FACT_ACTIONS,
    OTHER_ACTIONS,
    RIGHT_HAND_ONLY,
    SPELT,
    hint,
)
from rules.language.syntax import Call, Constant, Expression, GlobalUse, Position, VariableUse
from rules.language.values import Symbol

Arity = tuple[int, int | None]


def read_expression(node: Node, place: Place, known: Surroundings) -> Expression:
    """Return the expression that a form or token is."""
    if isinstance(node, Form):
        return read_call(node, place, known)
    if node.kind is TokenKind.CONSTANT and node.value is not None:
        return Constant(node.value, node.position)
    if node.kind in (TokenKind.VARIABLE, TokenKind.MULTI_VARIABLE):
        if place is Place.START:
            raise RuleError(f"?{node.text}: there are no variables in {place.value}", node.position)
        return VariableUse(node.text, node.position, node.kind is TokenKind.MULTI_VARIABLE)
    if node.kind is TokenKind.GLOBAL:
        return read_global(node, known)
    if node.kind in (TokenKind.WILDCARD, TokenKind.MULTI_WILDCARD):
        raise RuleError("a value is needed here; ? and $? stand in patterns only", node.position)
    raise RuleError(
        f"'{node.text}' has no place in {place.value}; it joins constraints within a pattern", node.position
    )


def read_global(token: Token, known: Surroundings) -> GlobalUse:
    """Return the use of a global that some defglobal sets."""
    if token.text not in known.globals:
        near = did_you_mean(token.text, known.globals)
        raise RuleError(f"there is no global ?*{token.text}*{near}", token.position)
    return GlobalUse(token.text, token.position)


def read_call(form: Form, place: Place, known: Surroundings, *, statement: bool = False) -> Call:
    """Return the call that a form is; `statement` where it stands alone, so that its value is not used."""
    name = name_of(form.items[0] if form.items else None, "the name of the function", form.position)
    _check_name(name, form.position, place, known, statement)
    name = SPELT.get(name, name)
    arguments = form.items[1:]
    if name == "post":
        if len(arguments) != 1 or not isinstance(arguments[0], Form):
            raise RuleError("write (post (kind (slot value) ...))", form.position)
        return Call(name, read_posted(arguments[0], place, known), form.position)
    values = tuple(read_expression(item, place, known) for item in arguments)
    arity = known.functions.get(name) or ARITIES[name]
    check_number(f"({name} ...)", len(values), arity, form.position)
    for index, value in enumerate(values):
        wrong = unfit(name, index, value, kinds_of(value))
        if wrong is not None:
            raise RuleError(wrong, value.position)
    if name == "printout":
        _check_printout(values, form.position)
    return Call(name, values, form.position)


def _check_name(name: str, position: Position, place: Place, known: Surroundings, statement: bool) -> None:
    if name in known.functions:
        return
    if name in BOARD_ACTIONS or name in OTHER_ACTIONS or name in RIGHT_HAND_ONLY:
        if place is not Place.ACTION:
            raise RuleError(
                f"({name} ...) may stand on the right-hand side of a rule only, not in {place.value}", position
            )
        if name in OTHER_ACTIONS and not statement:
            raise RuleError(f"({name} ...) has no value: it stands alone", position)
    elif name in FACT_ACTIONS:
        if name == "if":
            raise RuleError(
                "(if ...) may not stand within an expression: put it into a deffunction and call that", position
            )
        raise RuleError(f"({name} ...) may not stand within an expression: it has no value here", position)
    elif name not in ARITIES:
        near = hint(name) or did_you_mean(name, [*ARITIES, *known.functions])
        raise RuleError(f"there is no function '{name}'{near}", position)


def check_number(what: str, number: int, arity: Arity, position: Position) -> None:
    """Refuse too few or too many arguments."""
    least, most = arity
    if number < least or (most is not None and number > most):
        bounds = f"{least}" if least == most else f"at least {least}" if most is None else f"{least} to {most}"
        plural = "" if bounds.endswith(" 1") or bounds == "1" else "s"
        raise RuleError(f"{what} takes {bounds} argument{plural}, not {number}", position)


def _check_printout(values: tuple[Expression, ...], position: Position) -> None:
    first = values[0]
    if not (isinstance(first, Constant) and first.value == Symbol("t")):
        raise RuleError("printout writes to t only: (printout t ... crlf)", position)


def read_posted(form: Form, place: Place, known: Surroundings) -> tuple[Expression, ...]:
    """Return the flat arguments of `post`: the kind, then slot and value by turns."""
    kind = name_of(form.items[0] if form.items else None, "the kind to post", form.position)
    row: list[Expression] = [Constant(Symbol(kind), form.items[0].position)]
    for item in form.items[1:]:
        if not isinstance(item, Form) or not item.items or not word(item.items[0]):
            raise RuleError(f"write (post ({kind} (slot value) ...))", item.position)
        values = tuple(read_expression(value, place, known) for value in item.items[1:])
        row.append(Constant(Symbol(item.head), item.items[0].position))
        row.append(values[0] if len(values) == 1 else Call("create$", values, item.position))
    return tuple(row)
