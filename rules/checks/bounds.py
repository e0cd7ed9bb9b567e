"""Rules whose conditions contradict each other: a variable that would have to be two constants, or above 5 and below 3."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import inf

from rules.checks.finding import Finding
from rules.language.alternatives import alternatives
from rules.language.errors import RuleError
from rules.language.evaluation import evaluate
from rules.language.syntax import (
    Atom,
    Bind,
    Call,
    Condition,
    Constant,
    Constraint,
    Expression,
    GlobalUse,
    Match,
    Position,
    Predicate,
    Program,
    Test,
    VariableUse,
)
from rules.language.values import Value, same, written
from rules.language.walk import actions_of

MIRRORED = {"<": ">", ">": "<", "<=": ">=", ">=": "<=", "=": "="}


@dataclass(frozen=True, slots=True)
class Range:
    """What is left for a number."""

    low: float = -inf
    high: float = inf
    without_low: bool = False
    without_high: bool = False

    def cut(self, relation: str, limit: float) -> "Range":
        """Return what is left when the number also stands in this relation to a limit."""
        left = self
        if relation in (">", ">=", "=") and (limit > left.low or (limit == left.low and relation == ">")):
            left = replace(left, low=limit, without_low=relation == ">")
        if relation in ("<", "<=", "=") and (limit < left.high or (limit == left.high and relation == "<")):
            left = replace(left, high=limit, without_high=relation == "<")
        return left

    def holds(self, number: float) -> bool:
        """Say whether a number lies in the range."""
        above = number > self.low or (number == self.low and not self.without_low)
        return above and (number < self.high or (number == self.high and not self.without_high))

    @property
    def empty(self) -> bool:
        return self.low > self.high or (self.low == self.high and (self.without_low or self.without_high))


@dataclass
class Variables:
    """What the conditions of a row leave for each variable. `contradiction` is the place where nothing is left."""

    constants: Mapping[str, Value]  # of globals that no rule sets
    ranges: dict[str, Range] = field(default_factory=dict)
    words: dict[str, list[Value]] = field(default_factory=dict)
    contradiction: tuple[str, Position] | None = None

    def take(self, condition: Condition) -> None:
        """Take in what one condition says."""
        if isinstance(condition, Match):
            for constraint in condition.pattern.constraints:
                self._constraint(constraint)
        elif isinstance(condition, Test):
            self._expression(condition.expression)

    def _constraint(self, constraint: Constraint) -> None:
        only = constraint.alternatives[0]
        if constraint.binds is not None:
            allowed = [_constants(atoms) for atoms in constraint.alternatives]
            if all(allowed):
                self.one_of(constraint.binds.name, [values[0] for values in allowed], constraint.position)
        if len(constraint.alternatives) == 1:
            for atom in only:
                if isinstance(atom.term, Predicate) and not atom.negated:
                    self._expression(atom.term.expression)

    def one_of(self, variable: str, values: list[Value], position: Position) -> None:
        """Take in that a variable is one of these values."""
        before = self.words.get(variable)
        left = values if before is None else [value for value in before if any(same(value, v) for v in values)]
        self.words[variable] = left
        if not left and before is not None:
            earlier = " or ".join(map(written, before))
            self._contradicts(f"?{variable} is {earlier} already", position)
        self._compare(variable, position)

    def _expression(self, expression: Expression) -> None:
        if not isinstance(expression, Call):
            return
        if expression.function == "and":
            for argument in expression.arguments:
                self._expression(argument)
        elif expression.function in MIRRORED and len(expression.arguments) == 2:
            left, right = expression.arguments
            if isinstance(left, VariableUse):
                self._cut(left.name, expression.function, self._number(right), expression.position)
            elif isinstance(right, VariableUse):
                self._cut(right.name, MIRRORED[expression.function], self._number(left), expression.position)

    def _number(self, expression: Expression) -> float | None:
        value: Value | None = None
        if isinstance(expression, Constant):
            value = expression.value
        elif isinstance(expression, GlobalUse):
            value = self.constants.get(expression.name)
        return float(value) if isinstance(value, int | float) else None

    def _cut(self, variable: str, relation: str, limit: float | None, position: Position) -> None:
        if limit is not None:
            self.ranges[variable] = self.ranges.get(variable, Range()).cut(relation, limit)
            self._compare(variable, position)

    def _compare(self, variable: str, position: Position) -> None:
        left = self.ranges.get(variable)
        if left is None:
            return
        if left.empty:
            self._contradicts(f"no number is left for ?{variable} beside what was asked of it before", position)
        values = self.words.get(variable)
        if values and not any(isinstance(value, int | float) and left.holds(float(value)) for value in values):
            self._contradicts(f"?{variable} is {' or '.join(map(written, values))} already", position)

    def _contradicts(self, text: str, position: Position) -> None:
        self.contradiction = self.contradiction or (text, position)


def _constants(atoms: tuple[Atom, ...]) -> list[Value]:
    return [atom.term.value for atom in atoms if isinstance(atom.term, Constant) and not atom.negated]


def bound_findings(program: Program) -> Iterator[Finding]:
    """Yield the rules whose conditions can never hold together."""
    constants = constant_globals(program)
    for rule in program.rules:
        contradictions = []
        rows = alternatives(rule.conditions)
        for row in rows:
            variables = Variables(constants)
            for condition in row:
                variables.take(condition)
            if variables.contradiction is not None:
                contradictions.append(variables.contradiction)
        if contradictions and len(contradictions) == len(rows):
            text, position = contradictions[0]
            yield Finding(f"{text}, so the rule '{rule.name}' cannot fire", position)


def constant_globals(program: Program) -> dict[str, Value]:
    """Return the values of the globals that no rule changes."""
    changed = {a.name for r in program.rules for a in actions_of(r.actions) if isinstance(a, Bind) and a.is_global}
    functions = {function.name: function for function in program.functions}
    values: dict[str, Value] = {}
    for one in program.globals:
        if one.name not in changed:
            try:
                values[one.name] = evaluate(one.value, {}, values, functions)
            except RuleError:
                continue  # it hangs on one that changes
    return values
