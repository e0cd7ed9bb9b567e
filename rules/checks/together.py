"""Whether the conditions of two rules can hold at once, as far as that shows from the text.

Two patterns speak of the same fact where only one such fact can stand: a slot of the board, a member of a collection by its id,
a relation of which every rule that asserts a fact retracts one. What they say of it must agree then.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, TypeVar

from rules.checks.bounds import Variables
from rules.checks.facts import admits, bound_relations, is_several
from rules.language.alternatives import alternatives
from rules.language.syntax import (
    Assert,
    Call,
    Condition,
    Constant,
    Constraint,
    Exists,
    Expression,
    Match,
    Not,
    Pattern,
    Predicate,
    Program,
    Retract,
    Rule,
    Test,
    VariableUse,
    Wildcard,
)
from rules.language.values import Value
from rules.language.walk import actions_of
from rules.language.writing import constraint_text, expression_text

OPPOSITES = {"<": ">=", ">=": "<", ">": "<=", "<=": ">", "=": "<>", "<>": "=", "eq": "neq", "neq": "eq"}
R = TypeVar("R")


@dataclass(frozen=True)
class Singles:
    """What there is one of at most: relations, and entries of the board by id."""

    relations: frozenset[str]
    with_ids: frozenset[str]

    def same_fact(self, a: Pattern, b: Pattern) -> bool:
        """Say whether two patterns can only match the same fact."""
        if a.relation != b.relation:
            return False
        if a.relation in self.relations:
            return True
        if a.relation not in self.with_ids:
            return False
        one, other = field_of(a, "id"), field_of(b, "id")
        return (
            one is not None and other is not None and is_plain(one) and constraint_text(one) == constraint_text(other)
        )


def singles(program: Program) -> Singles:
    """Return what of a program's facts there can only be one of."""
    of_board = [template for template in program.templates if template.position is None]
    with_ids = {template.name for template in of_board if any(slot.name == "id" for slot in template.slots)}
    stand: dict[str, int] = {}
    for deffacts in program.deffacts:
        for fact in deffacts.facts:
            stand[fact.relation] = stand.get(fact.relation, 0) + 1
    found = {relation for relation, number in stand.items() if number == 1}
    for rule in program.rules:
        relations = bound_relations(rule)
        taken: list[str] = []
        made: list[str] = []
        for action in actions_of(rule.actions):
            if isinstance(action, Retract):
                taken += [relations.get(fact.name, "") for fact in action.facts if isinstance(fact, VariableUse)]
            elif isinstance(action, Assert):
                made += [fact.relation for fact in action.facts]
        found -= {relation for relation in made if made.count(relation) > min(taken.count(relation), 1)}
    return Singles(frozenset(found | {template.name for template in of_board} - with_ids), frozenset(with_ids))


def field_of(pattern: Pattern, key: str | int) -> Constraint | None:
    """Return the constraint on a slot, or on a place of an ordered pattern."""
    if pattern.slots is None:
        return pattern.constraints[key] if isinstance(key, int) and key < len(pattern.constraints) else None
    return next((c for slot, c in zip(pattern.slots, pattern.constraints, strict=True) if slot == key), None)


def keys_of(pattern: Pattern) -> list[str | int]:
    """Return the slots or places that a pattern speaks of, up to the first $?."""
    keys: list[str | int] = []
    for index, constraint in enumerate(pattern.constraints):
        if is_several(constraint):
            break
        keys.append(index if pattern.slots is None else pattern.slots[index])
    return keys


def is_plain(constraint: Constraint) -> bool:
    """Say whether a constraint is one constant or one variable."""
    only = constraint.alternatives[0]
    plain = len(constraint.alternatives) == 1 and len(only) == 1 and not only[0].negated and constraint.binds is None
    return plain and isinstance(only[0].term, Constant | VariableUse)


def variable_of(constraint: Constraint) -> str | None:
    """Return the variable that holds the field, if there is one."""
    if constraint.binds is not None:
        return constraint.binds.name
    term = constraint.alternatives[0][0].term
    return term.name if is_plain(constraint) and isinstance(term, VariableUse) else None


def constants_of(constraint: Constraint) -> list[Value] | None:
    """Return the constants that the field can be; None where it can be other things too."""
    found: list[Value] = []
    for atoms in constraint.alternatives:
        values = [atom.term.value for atom in atoms if isinstance(atom.term, Constant) and not atom.negated]
        if not values:
            return None
        found.append(values[0])
    return found


def renamed(record: R, names: Mapping[str, str]) -> R:
    """Return a record with other names for its variables; what has none gets a mark."""

    def change(value: Any) -> Any:
        if isinstance(value, VariableUse):
            return replace(value, name=names.get(value.name, f"{value.name}'"))
        if is_dataclass(value) and not isinstance(value, type):
            return replace(value, **{f.name: change(getattr(value, f.name)) for f in fields(value)})
        return tuple(map(change, value)) if isinstance(value, tuple) else value

    return change(record)  # type: ignore[no-any-return]


def positive(row: Iterable[Condition]) -> Iterator[Pattern]:
    """Yield the patterns of a row that some fact must match."""
    for condition in row:
        if isinstance(condition, Match):
            yield condition.pattern


def can_hold_together(
    a: Sequence[Condition],
    b: Sequence[Condition],
    single: Singles,
    constants: Mapping[str, Value],
    shared: Sequence[tuple[Pattern, Pattern]] = (),
) -> bool:
    """Say whether two rows of conditions can hold at once; `shared` are pairs of patterns that are to match the same fact."""
    names: dict[str, str] = {}
    pairs = list(shared)
    for _ in range(len(b) + 1):  # what one pair says of ids may show that others are of one fact too
        for one, other in pairs:
            for key in keys_of(other):
                mine, theirs = field_of(one, key), field_of(other, key)
                if mine is not None and theirs is not None and variable_of(mine) and variable_of(theirs):
                    names.setdefault(str(variable_of(theirs)), str(variable_of(mine)))
        found = [
            (one, other)
            for one in positive(a)
            for other in positive(b)
            if (one, other) not in pairs and single.same_fact(one, renamed(other, names))
        ]
        if not found:
            break
        pairs += found
    theirs_all = [renamed(condition, names) for condition in b]
    variables = Variables(constants)
    for condition in (*a, *theirs_all):
        variables.take(condition)
    for one, other in pairs:
        if not _agree(one, renamed(other, names), variables):
            return False
    return (
        variables.contradiction is None
        and not _denies(a, theirs_all)
        and not _denies(theirs_all, a)
        and not _opposed(a, theirs_all)
    )


def _agree(one: Pattern, other: Pattern, variables: Variables) -> bool:
    """Say whether one fact can match both patterns."""
    counted = one.slots is None and not any(map(is_several, (*one.constraints, *other.constraints)))
    if counted and len(one.constraints) != len(other.constraints):
        return False
    for key in keys_of(other):
        mine, theirs = field_of(one, key), field_of(other, key)
        if mine is None or theirs is None or is_several(mine):
            continue
        for first, second in ((mine, theirs), (theirs, mine)):
            values = constants_of(second)
            if values is None:
                continue
            left = [value for value in values if admits(first, value)]
            name = variable_of(first)
            if not left:
                return False
            if name is not None:
                variables.one_of(name, left, second.position)
    return True


def _denies(a: Sequence[Condition], b: Sequence[Condition]) -> bool:
    """Say whether a (not ...) of `a` rules out what `b` needs."""
    bound = {name for pattern in positive(a) for c in pattern.constraints if (name := variable_of(c))}
    needed = [*positive(b)]
    for condition in b:
        if isinstance(condition, Exists):
            rows = alternatives(condition.conditions)
            if len(rows) == 1 and len(rows[0]) == 1:
                needed += positive(rows[0])
    return any(
        implies(pattern, condition.condition.pattern, bound)
        for condition in a
        if isinstance(condition, Not) and isinstance(condition.condition, Match)
        for pattern in needed
    )


def implies(have: Pattern, wanted: Pattern, bound: Iterable[str]) -> bool:
    """Say whether every fact that matches `have` matches `wanted`; `bound` are the variables that `wanted` does not bind itself."""
    if have.relation != wanted.relation or len(keys_of(wanted)) < len(wanted.constraints):
        return False
    if wanted.slots is None and (
        len(have.constraints) != len(wanted.constraints) or len(keys_of(have)) < len(have.constraints)
    ):
        return False
    free: list[str] = []
    for key in keys_of(wanted):
        constraint = field_of(wanted, key)
        there = field_of(have, key)
        assert constraint is not None
        term = constraint.alternatives[0][0].term
        if isinstance(term, Wildcard):
            continue
        name = variable_of(constraint)
        if name is not None and is_plain(constraint) and name not in bound and name not in free:
            free.append(name)
            continue
        if there is None or not _within(there, constraint):
            return False
    return True


def _within(have: Constraint, wanted: Constraint) -> bool:
    """Say whether what meets one constraint meets the other."""
    if constraint_text(have) == constraint_text(wanted):
        return True
    name = variable_of(wanted)
    if name is not None:
        return is_plain(wanted) and variable_of(have) == name
    values = constants_of(have)
    plain = all(isinstance(atom.term, Constant) for atoms in wanted.alternatives for atom in atoms)
    return plain and values is not None and all(admits(wanted, value) for value in values)


def asked(row: Iterable[Condition]) -> Iterator[Call]:
    """Yield the calls that must hold: those of tests and of predicates that stand alone, parts of (and ...) one by one."""
    for condition in row:
        if isinstance(condition, Test):
            yield from _parts(condition.expression)
        elif isinstance(condition, Match):
            for constraint in condition.pattern.constraints:
                if len(constraint.alternatives) == 1:
                    for atom in constraint.alternatives[0]:
                        if isinstance(atom.term, Predicate) and not atom.negated:
                            yield from _parts(atom.term.expression)


def _parts(expression: Expression) -> Iterator[Call]:
    if isinstance(expression, Call) and expression.function == "and":
        for argument in expression.arguments:
            yield from _parts(argument)
    elif isinstance(expression, Call):
        yield expression


def _opposed(a: Iterable[Condition], b: Iterable[Condition]) -> bool:
    """Say whether one asks for the opposite of what the other asks."""
    theirs = {expression_text(call) for call in asked(b)}
    for call in asked(a):
        opposites = [f"(not {expression_text(call)})"]
        if call.function == "not":
            opposites = [expression_text(call.arguments[0])]
        elif call.function in OPPOSITES and len(call.arguments) == 2:
            opposites.append(expression_text(replace(call, function=OPPOSITES[call.function])))
        if any(text in theirs for text in opposites):
            return True
    return False


def rows_of(rule: Rule) -> list[tuple[Condition, ...]]:
    """Return the ways through the `or`s of a rule."""
    return alternatives(rule.conditions)
