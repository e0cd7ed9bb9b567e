"""Patterns compiled: what a fact must be by itself, what it must share with the facts before it, and what it binds.

What looks at the fact alone is tested once, when the fact arrives (`constants`, `checks`); equalities with variables bound before
become the keys of the hash index that joins (`keys`); the rest is tested for each pair that the index brings together (`tests`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from rules.engines.matching.expressions import Check, Compiler, Scope, equality, evaluation, truth, variables
from rules.engines.matching.facts import Identity, WorkingFact, identity
from rules.engines.matching.places import Part, Place, TokenPlace
from rules.language.errors import RuleError
from rules.language.syntax import (
    Atom,
    Call,
    Constant,
    Constraint,
    Expression,
    Pattern,
    Predicate,
    Returned,
    Template,
    VariableUse,
    Wildcard,
)

Templates = Mapping[str, Template]
AlphaCheck = Callable[[WorkingFact], bool]


@dataclass(slots=True)
class Matching:
    """A compiled pattern. `specs` and `test_specs` say the same as `checks` and `tests`, comparably, so that nodes can be shared.

    `specs` are by place, in the order of the fields or slots.
    """

    relation: str
    ordered: bool
    constants: dict[Place, Identity] = field(default_factory=dict)
    checks: list[AlphaCheck] = field(default_factory=list)
    specs: dict[Place, list[object]] = field(default_factory=dict)
    keys: list[tuple[Place, TokenPlace]] = field(default_factory=list)
    tests: list[Check] = field(default_factory=list)
    test_specs: list[object] = field(default_factory=list)
    binds: dict[str, Place] = field(default_factory=dict)


def matching(pattern: Pattern, bound: Mapping[str, TokenPlace], templates: Templates, compiler: Compiler) -> Matching:
    """Compile a pattern, of whose variables some are `bound` by the patterns before it."""
    made = Matching(pattern.relation, pattern.slots is None)
    placed = _places(pattern, templates, made)
    for place, _ in sorted(placed, key=lambda one: _rank(one[0])):
        made.specs.setdefault(place, [])
    for place, constraint in placed:
        _constrain(made, place, constraint, bound, compiler)
    return made


def _places(pattern: Pattern, templates: Templates, made: Matching) -> list[tuple[Place, Constraint]]:
    """Return where each constraint stands, and add the checks of how many fields there are."""
    if pattern.slots is None:
        parts = _parts(pattern.constraints)
        _check_length(made, None, parts)
        return [(Place(part), one) for part, one in zip(parts, pattern.constraints, strict=True)]
    template = templates.get(pattern.relation)
    if template is None:
        raise RuleError(f"there is no template '{pattern.relation}'", pattern.position)
    names = [slot.name for slot in template.slots]
    by_slot: dict[str, list[Constraint]] = {}
    for name, constraint in zip(pattern.slots, pattern.constraints, strict=True):
        if name not in names:
            raise RuleError(f"template '{template.name}' has no slot '{name}'", constraint.position)
        by_slot.setdefault(name, []).append(constraint)
    found: list[tuple[Place, Constraint]] = []
    for name, constraints in by_slot.items():
        index = names.index(name)
        if not template.slots[index].multi:
            found += [(Place(index), constraint) for constraint in constraints]
            continue
        parts = _parts(constraints)
        if len(parts) == 1 and isinstance(parts[0], tuple):  # `$?x` alone is the whole slot
            found.append((Place(index), constraints[0]))
            continue
        _check_length(made, index, parts)
        found += [(Place(index, part), one) for part, one in zip(parts, constraints, strict=True)]
    return found


def _rank(place: Place) -> tuple[bool, int, bool, int]:
    """Return what sorts places as the fields stand: those counted from the end come last."""
    field, inside = (part[0] if isinstance(part, tuple) else part or 0 for part in (place.field, place.inside))
    return field < 0, field, inside < 0, inside


def _parts(constraints: tuple[Constraint, ...] | list[Constraint]) -> list[Part]:
    """Return the indices of some fields in a row; those after a `$?` count from the end."""
    stretches = [i for i, constraint in enumerate(constraints) if _is_stretch(constraint)]
    if not stretches:
        return list(range(len(constraints)))
    if len(stretches) > 1:
        raise RuleError("more than one $? in a row of fields", constraints[stretches[1]].position)
    at, after = stretches[0], len(constraints) - stretches[0] - 1
    return [*range(at), (at, -after or None), *range(-after, 0)]


def _is_stretch(constraint: Constraint) -> bool:
    if constraint.binds is not None:
        return constraint.binds.multi
    terms = (atom.term for row in constraint.alternatives for atom in row)
    return any(isinstance(term, VariableUse | Wildcard) and term.multi for term in terms)


def _check_length(made: Matching, index: int | None, parts: list[Part]) -> None:
    """Ask for as many fields, or values in a multislot, as there are parts; for that many or more with a `$?` among them."""
    stretches = sum(isinstance(part, tuple) for part in parts)
    least = len(parts) - stretches
    made.specs.setdefault(Place(index if index is not None else 0), []).append(("length", least, stretches))

    def check(fact: WorkingFact) -> bool:
        length = len(fact.identities if index is None else fact.identities[index])
        return length >= least if stretches else length == least

    made.checks.append(check)


def _constrain(
    made: Matching, place: Place, constraint: Constraint, bound: Mapping[str, TokenPlace], compiler: Compiler
) -> None:
    if constraint.binds is not None:
        _bind(made, place, constraint.binds.name, bound)
    if not constraint.alternatives:
        return
    if len(constraint.alternatives) == 1:
        for atom in constraint.alternatives[0]:
            _require(made, place, atom, bound, compiler)
        return
    rows = [[_checked(made, place, atom, bound, compiler) for atom in row] for row in constraint.alternatives]
    checks = [[check for check, _, _ in row] for row in rows]
    spec = ("any", place, tuple(tuple(what for _, what, _ in row) for row in rows))

    def check(facts: tuple[WorkingFact, ...], fact: WorkingFact) -> bool:
        return any(all(one(facts, fact) for one in row) for row in checks)

    _add(made, place, check, spec, all(alone for row in rows for _, _, alone in row))


def _bind(made: Matching, place: Place, name: str, bound: Mapping[str, TokenPlace]) -> None:
    """Bind a variable here, or ask for the value that it has."""
    if name in made.binds:
        first, second = made.binds[name].identity(), place.identity()
        made.specs[place].append(("same", made.binds[name]))
        made.checks.append(lambda fact: first(fact) == second(fact))
    elif name in bound:
        made.keys.append((place, bound[name]))
    else:
        made.binds[name] = place


def _require(made: Matching, place: Place, atom: Atom, bound: Mapping[str, TokenPlace], compiler: Compiler) -> None:
    term = atom.term
    if isinstance(term, Wildcard) and not atom.negated:
        return
    if isinstance(term, VariableUse) and not atom.negated:
        _bind(made, place, term.name, bound)
    elif (
        isinstance(term, Constant)
        and not atom.negated
        and made.constants.setdefault(place, identity(term.value)) == identity(term.value)
    ):
        return
    else:
        _add(made, place, *_checked(made, place, atom, bound, compiler))


def _checked(
    made: Matching, place: Place, atom: Atom, bound: Mapping[str, TokenPlace], compiler: Compiler
) -> tuple[Check, object, bool]:
    """Return the check of one atom, what it is, and whether it looks at the fact alone."""
    term, negated, read = atom.term, atom.negated, place.identity()
    if isinstance(term, Wildcard):
        return (lambda facts, fact: not negated), ("anything", negated), True
    if isinstance(term, Constant):
        wanted = identity(term.value)
        return (lambda facts, fact: (read(fact) == wanted) is not negated), ("constant", wanted, place, negated), True
    if isinstance(term, VariableUse):
        if term.name in made.binds:
            mine = made.binds[term.name]
            other = mine.identity()
            return (
                (lambda facts, fact: (read(fact) == other(fact)) is not negated),
                ("same", mine, place, negated),
                True,
            )
        if term.name not in bound:
            raise RuleError(f"?{term.name} is not bound here", term.position)
        theirs = bound[term.name].identity()
        spec = ("as", bound[term.name], place, negated)
        return (lambda facts, fact: (read(fact) == theirs(facts)) is not negated), spec, False
    scope: Scope = {**bound, **made.binds}
    evaluate = evaluation(term.expression, scope, compiler)
    spec_of = described(term.expression, scope)
    alone = all(name in made.binds for name in variables(term.expression))
    if isinstance(term, Predicate):
        return truth(evaluate, negated), ("predicate", spec_of, negated), alone
    assert isinstance(term, Returned)
    return equality(evaluate, read, negated), ("returned", spec_of, place, negated), alone


def _add(made: Matching, place: Place, check: Check, spec: object, alone: bool) -> None:
    if alone:
        made.specs[place].append(spec)
        made.checks.append(lambda fact: check((), fact))
    else:
        made.test_specs.append(spec)
        made.tests.append(check)


def described(expression: Expression, scope: Scope) -> object:
    """Return what is equal for expressions that evaluate alike: places instead of names, no positions."""
    if isinstance(expression, Constant):
        return ("constant", identity(expression.value))
    if isinstance(expression, VariableUse):
        return scope[expression.name]
    if isinstance(expression, Call):
        return (expression.function, *(described(one, scope) for one in expression.arguments))
    return ("global", expression.name)
