"""Expressions in patterns and tests, compiled to read their variables from a token's facts and the fact in question."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from rules.engines.matching.facts import Identity, WorkingFact, identity
from rules.engines.matching.places import Place, TokenPlace
from rules.language.errors import RuleError
from rules.language.evaluation import Compiled
from rules.language.syntax import Call, Expression, VariableUse
from rules.language.values import FALSE, Value

Facts = tuple[WorkingFact, ...]
Evaluate = Callable[[Facts, Any], Value]
Check = Callable[[Facts, Any], bool]  # of a token's facts and the fact in question, if any
Scope = Mapping[str, Place | TokenPlace]  # a Place is one in the fact in question

MOST_FAULTS = 100


def variables(expression: Expression) -> Iterator[str]:
    """Yield the names of the variables in an expression, each as often as it stands there."""
    if isinstance(expression, VariableUse):
        yield expression.name
    elif isinstance(expression, Call):
        for argument in expression.arguments:
            yield from variables(argument)


@dataclass(frozen=True, slots=True)
class Compiler:
    """What compiles expressions, and the globals' values, which may change."""

    compiled: Callable[[Expression], Compiled]
    globals_: Mapping[str, Value]
    faults: dict[str, RuleError] = field(
        default_factory=dict
    )  # what could not be evaluated, each once, until it is told

    def note(self, fault: RuleError) -> None:
        """Keep a fault of a condition, to be told."""
        if len(self.faults) < MOST_FAULTS:
            self.faults.setdefault(str(fault), fault)


def evaluation(expression: Expression, scope: Scope, compiler: Compiler) -> Evaluate:
    """Return what evaluates an expression for a token and a fact; a variable that nothing binds is a RuleError."""
    run, globals_ = compiler.compiled(expression), compiler.globals_
    own: list[tuple[str, Callable[[WorkingFact], Value]]] = []
    outer: list[tuple[str, int, Callable[[WorkingFact], Value]]] = []
    for name in dict.fromkeys(variables(expression)):
        where = scope.get(name)
        if where is None:
            raise RuleError(f"?{name} is not bound here", expression.position)
        if isinstance(where, Place):
            own.append((name, where.value()))
        else:
            outer.append((name, where.level, where.place.value()))

    def evaluate(facts: Facts, fact: Any) -> Value:
        bindings = {}
        for name, level, read in outer:
            bindings[name] = read(facts[level])
        for name, read in own:
            bindings[name] = read(fact)
        return run(bindings, globals_)

    return evaluate


def truth(evaluate: Evaluate, negated: bool) -> Check:
    """Return what says whether the value is not FALSE, or is where `negated`."""

    def check(facts: Facts, fact: Any) -> bool:
        value = evaluate(facts, fact)
        return (value is not FALSE and value != FALSE) is not negated

    return check


def equality(evaluate: Evaluate, read: Callable[[WorkingFact], Identity], negated: bool) -> Check:
    """Return what says whether the field that `read` reads is the value, or is not where `negated`."""

    def check(facts: Facts, fact: Any) -> bool:
        return bool(read(fact) == identity(evaluate(facts, fact))) is not negated

    return check


def guarded(checks: Sequence[Check], on_error: bool, note: Callable[[RuleError], None]) -> Check | None:
    """Return all the checks as one, or None if there are none; what cannot be evaluated is `on_error`, and noted.

    CLIPS has it so: a test that fails with an error does not match, but what it keeps from matching under `not` counts as matched.
    """
    if not checks:
        return None

    def check(facts: Facts, fact: Any) -> bool:
        try:
            for one in checks:  # not all(...), which takes three times as long
                if not one(facts, fact):
                    return False
        except RuleError as fault:
            note(fault)
            return on_error
        return True

    return check
