"""The fields of patterns: `?x&~red|blue` and the like, `~` binding tighter than `&`, `&` tighter than `|`."""

from collections.abc import Sequence

from rules.language.argument_kinds import ROW, kinds_of
from rules.language.errors import RuleError
from rules.language.reading.expressions import read_call
from rules.language.reading.forms import Form, Node
from rules.language.reading.surroundings import Place, Surroundings
from rules.language.reading.tokens import Token, TokenKind
from rules.language.syntax import Atom, Constant, Constraint, Predicate, Returned, Term, VariableUse, Wildcard
from rules.language.values import same, written

WILDCARDS = (TokenKind.WILDCARD, TokenKind.MULTI_WILDCARD)
MULTI = (TokenKind.MULTI_VARIABLE, TokenKind.MULTI_WILDCARD)


def read_constraints(items: Sequence[Node], known: Surroundings) -> tuple[Constraint, ...]:
    """Return one constraint for each field that the items speak of."""
    constraints: list[Constraint] = []
    rest = list(items)
    while rest:
        constraints.append(_read_constraint(rest, known))
    several = [c for c in constraints if is_multi(c)]
    if len(several) > 1:
        raise RuleError(
            "a second $? in one pattern: only one may stand there; test with member$ or subseq$ instead",
            several[1].position,
        )
    return tuple(constraints)


def is_multi(constraint: Constraint) -> bool:
    """Say whether the constraint is on any number of fields."""
    term = constraint.binds or constraint.alternatives[0][0].term
    return isinstance(term, VariableUse | Wildcard) and term.multi


def _read_constraint(rest: list[Node], known: Surroundings) -> Constraint:
    """Take the nodes of one constraint from the front of `rest`."""
    start = rest[0].position
    alternatives: list[list[Atom]] = [[_read_atom(rest, known)]]
    signs: list[str] = []
    while rest and isinstance(rest[0], Token) and rest[0].kind is TokenKind.SIGN and rest[0].text in "&|":
        sign = rest.pop(0)
        if not rest:
            raise RuleError(f"'{sign.text}' must be followed by a constraint", sign.position)  # type: ignore[union-attr]
        signs.append(sign.text)  # type: ignore[union-attr]
        atom = _read_atom(rest, known)
        _refuse_wildcard(atom)
        if signs[-1] == "|":
            alternatives.append([atom])
        else:
            alternatives[-1].append(atom)
    first = alternatives[0][0]
    if signs and not (signs[0] == "&" and isinstance(first.term, VariableUse) and not first.negated):
        _refuse_wildcard(first)
    binds: VariableUse | None = None
    if signs and signs[0] == "&" and isinstance(first.term, VariableUse) and not first.negated:
        binds = first.term
        alternatives[0].pop(0)
    if len(alternatives) == 1:
        _refuse_contradiction(alternatives[0])
    return Constraint(tuple(map(tuple, alternatives)), start, binds)


def _refuse_contradiction(atoms: Sequence[Atom]) -> None:
    """One value cannot be two constants, nor one that it must not be; CLIPS refuses this too."""
    constants = [(atom.term, atom.negated) for atom in atoms if isinstance(atom.term, Constant)]
    for wanted in [term for term, negated in constants if not negated]:
        for other, negated in constants:
            if same(wanted.value, other.value) is negated:
                no = "not " if negated else ""
                what = f"{written(wanted.value)} and {no}{written(other.value)}"
                raise RuleError(f"no value is {what}: this can never match", other.position)


def _refuse_wildcard(atom: Atom) -> None:
    term = atom.term
    if isinstance(term, Wildcard):
        raise RuleError("? joined to a constraint says nothing: leave it out, or name it: ?x", term.position)
    if isinstance(term, VariableUse) and term.multi:
        raise RuleError(f"$?{term.name} may stand first in its field only", term.position)


def _read_atom(rest: list[Node], known: Surroundings) -> Atom:
    node = rest.pop(0)
    if not _is_sign(node, "~"):
        return Atom(_read_term(node, rest, known))
    if not rest or _is_sign(rest[0], "~"):
        raise RuleError("'~' must be followed by one constraint", node.position)
    atom = Atom(_read_term(rest.pop(0), rest, known), negated=True)
    _refuse_wildcard(atom)
    return atom


def _is_sign(node: Node, sign: str) -> bool:
    return isinstance(node, Token) and node.kind is TokenKind.SIGN and node.text == sign


def _read_term(node: Node, rest: list[Node], known: Surroundings) -> Term:
    if isinstance(node, Form):
        raise RuleError(
            "a bracket within a pattern: write :(...) for a test, =(...) for a value, or is it a template's slot?",
            node.position,
        )
    if node.kind in WILDCARDS:
        return Wildcard(node.position, node.kind in MULTI)
    if node.kind in (TokenKind.VARIABLE, TokenKind.MULTI_VARIABLE):
        return VariableUse(node.text, node.position, node.kind in MULTI)
    if node.kind is TokenKind.GLOBAL:
        raise RuleError(
            f"?*{node.text}* may not stand here: write ?x&:(eq ?x ?*{node.text}*), or use = for numbers", node.position
        )
    if node.kind is TokenKind.SIGN:
        raise RuleError(f"'{node.text}' needs a constraint before it", node.position)
    if node.text in (":", "="):
        if not rest or not isinstance(rest[0], Form):
            raise RuleError(
                f"'{node.text}' must be followed by an expression in brackets: {node.text}(...)", node.position
            )
        expression = read_call(rest.pop(0), Place.CONDITION, known)  # type: ignore[arg-type]
        if node.text == ":":
            return Predicate(expression, node.position)
        if kinds_of(expression) == ROW:
            raise RuleError(f"one field is never what ({expression.function} ...) returns: a multifield", node.position)
        return Returned(expression, node.position)
    if node.text[0] in ":=" and node.text[1] == "?":
        raise RuleError(f"'{node.text}' would be a symbol: write {node.text[0]}(...)", node.position)
    if node.value is None:
        raise RuleError(f"'{node.text}' has no place in a pattern", node.position)
    return Constant(node.value, node.position)
