"""A plain matcher for explanations: one pattern against one fact, and what differs. Engines have faster ones of their own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rules.language.errors import RuleError
from rules.language.evaluation import Compiled, Evaluator, evaluate
from rules.language.syntax import (
    Atom,
    Constant,
    Constraint,
    Expression,
    Pattern,
    Predicate,
    Program,
    Returned,
    VariableUse,
    Wildcard,
)
from rules.language.values import FactValue, Value, is_true, same, written
from rules.language.writing import constraint_text, expression_text

Bindings = Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Difference:
    """Where a fact is not as a pattern wants it: in a slot (or a field, "field 2"), what it holds and what is wanted."""

    place: str
    found: str
    wanted: str

    def __str__(self) -> str:
        return f"{self.place} is {self.found}, wanted {self.wanted}"


class Matcher:
    """Matches patterns of one program, with its functions and the values that its globals begin with."""

    def __init__(self, program: Program) -> None:
        functions = {function.name: function for function in program.functions}
        self._evaluator = Evaluator(functions)
        self.globals: dict[str, Value] = {}
        for one in program.globals:
            self.globals[one.name] = evaluate(one.value, {}, self.globals, functions)
        self._compiled: dict[Expression, Compiled] = {}

    def match(self, pattern: Pattern, fact: FactValue, bindings: Bindings) -> dict[str, Value] | None:
        """Return the bindings with those that the pattern adds; None where the fact does not match."""
        fields = _paired(pattern, fact)
        if fields is None:
            return None
        bound = dict(bindings)
        for _, constraint, value in fields:
            if not self._holds(constraint, value, bound):
                return None
        return bound

    def differences(self, pattern: Pattern, fact: FactValue, bindings: Bindings) -> list[Difference]:
        """Return all that keeps a fact of the pattern's relation from matching."""
        fields = _paired(pattern, fact)
        if fields is None:
            wanted, held = len(pattern.constraints), len(fact.fields)
            return [Difference("the fact", f"{held} fields long", str(wanted))]
        bound, found = dict(bindings), list[Difference]()
        for place, constraint, value in fields:
            if not self._holds(constraint, value, bound):
                found.append(Difference(place, _shown(value), self._wanted(constraint, bindings)))
        return found

    def value(self, expression: Expression, bindings: Bindings) -> Value:
        """Return what an expression is worth. Raises RuleError where it has no value."""
        if expression not in self._compiled:
            self._compiled[expression] = self._evaluator.compiled(expression)
        return self._compiled[expression](bindings, self.globals)

    def true(self, expression: Expression, bindings: Bindings) -> bool:
        """Say whether an expression holds; one that has no value (letters compared with a number) does not."""
        try:
            return is_true(self.value(expression, bindings))
        except RuleError:
            return False

    def _holds(self, constraint: Constraint, value: Value, bound: dict[str, Value]) -> bool:
        """Say whether a field is as it must be; a variable that nothing has bound yet is bound to it."""
        variable = constraint.binds or _alone(constraint)
        if variable is not None:
            if variable.name in bound:
                if not same(bound[variable.name], value):
                    return False
            else:
                bound[variable.name] = value
            if constraint.binds is None:
                return True
        return any(all(self._atom(atom, value, bound) for atom in atoms) for atoms in constraint.alternatives)

    def _atom(self, atom: Atom, value: Value, bound: dict[str, Value]) -> bool:
        return self._term(atom, value, bound) is not atom.negated

    def _term(self, atom: Atom, value: Value, bound: dict[str, Value]) -> bool:
        term = atom.term
        if isinstance(term, Wildcard):
            return True
        if isinstance(term, Constant):
            return same(term.value, value)
        if isinstance(term, VariableUse):
            return term.name in bound and same(bound[term.name], value)
        if isinstance(term, Predicate):
            return self.true(term.expression, bound)
        assert isinstance(term, Returned)
        try:
            return same(self.value(term.expression, bound), value)
        except RuleError:
            return False

    def _wanted(self, constraint: Constraint, bindings: Bindings) -> str:
        """Return what a field must be, with the values of what is known already."""
        text = constraint_text(constraint)
        known = [
            f"?{name} is {_shown(bindings[name])}" for name in variables_of(constraint) if name in bindings
        ] + self._globals_in(text)
        return f"{text} (where {', '.join(known)})" if known else text

    def _globals_in(self, text: str) -> list[str]:
        return [f"?*{name}* is {written(value)}" for name, value in self.globals.items() if f"?*{name}*" in text]


def variables_of(constraint: Constraint) -> list[str]:
    """Return the names of the variables that a constraint speaks of, each once, in order."""
    names = [constraint.binds.name] if constraint.binds is not None else []
    for atoms in constraint.alternatives:
        for atom in atoms:
            if isinstance(atom.term, VariableUse):
                names.append(atom.term.name)
            elif isinstance(atom.term, Predicate | Returned):
                names += variables_in(atom.term.expression)
    return list(dict.fromkeys(names))


def variables_in(expression: Expression) -> list[str]:
    """Return the names of the variables in an expression, each once, in order."""
    if isinstance(expression, VariableUse):
        return [expression.name]
    arguments: Sequence[Expression] = getattr(expression, "arguments", ())
    return list(dict.fromkeys(name for argument in arguments for name in variables_in(argument)))


def test_text(expression: Expression, bindings: Bindings) -> str:
    """Return an expression with the values of its variables."""
    values = [f"?{name} = {_shown(bindings[name])}" for name in variables_in(expression) if name in bindings]
    return expression_text(expression) + (f" with {', '.join(values)}" if values else "")


def _alone(constraint: Constraint) -> VariableUse | None:
    """Return the variable that is all of a constraint."""
    if len(constraint.alternatives) != 1 or len(constraint.alternatives[0]) != 1:
        return None
    atom = constraint.alternatives[0][0]
    return atom.term if isinstance(atom.term, VariableUse) and not atom.negated else None


def _multi(constraint: Constraint) -> bool:
    term = constraint.binds or constraint.alternatives[0][0].term
    return isinstance(term, VariableUse | Wildcard) and term.multi


def _paired(pattern: Pattern, fact: FactValue) -> list[tuple[str, Constraint, Value]] | None:
    """Return each constraint with its place and what the fact holds there; None where the numbers of fields differ."""
    if (fact.slots is None) is not (pattern.slots is None):
        return None
    if pattern.slots is None or fact.slots is None:
        row = _row(pattern.constraints, fact.fields)
        return None if row is None else [(f"field {i}", c, v) for i, (c, v) in enumerate(row, 1)]
    paired: list[tuple[str, Constraint, Value]] = []
    for slot in dict.fromkeys(pattern.slots):
        constraints = [c for c, name in zip(pattern.constraints, pattern.slots, strict=True) if name == slot]
        value = fact.slot(slot)
        if isinstance(value, tuple):
            row = _row(constraints, value)
            if row is None:
                return None
            paired += [(slot, c, v) for c, v in row]
        else:
            paired.append((slot, constraints[0], value))
    return paired


def _row(constraints: Sequence[Constraint], fields: Sequence[Value]) -> list[tuple[Constraint, Value]] | None:
    """Return the constraints with their fields, one of which may be `$?` and takes what the others leave."""
    several = next((i for i, constraint in enumerate(constraints) if _multi(constraint)), None)
    if several is None:
        return list(zip(constraints, fields, strict=True)) if len(constraints) == len(fields) else None
    after = len(constraints) - several - 1
    if len(fields) < several + after:
        return None
    middle = tuple(fields[several : len(fields) - after])
    values = [*fields[:several], middle, *fields[len(fields) - after :]]
    return list(zip(constraints, values, strict=True))


def rounded(value: Value) -> Value:
    """Return a value as it is shown: numbers to six digits."""
    if isinstance(value, tuple):
        return tuple(map(rounded, value))
    return float(f"{value:.6g}") if isinstance(value, float) else value


def _shown(value: Value) -> str:
    return "empty" if value == () else written(rounded(value))
