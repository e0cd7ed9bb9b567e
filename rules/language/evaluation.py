"""What expressions are worth: each is compiled once to nested functions of the variables' and the globals' values."""

import operator
from collections.abc import Callable, Mapping

from rules.language.errors import RuleError
from rules.language.functions import FUNCTIONS, FunctionFault
from rules.language.library.multifields import flattened
from rules.language.syntax import (
    Action,
    Bind,
    Call,
    Constant,
    Expression,
    Function,
    GlobalUse,
    If,
    Position,
    VariableUse,
)
from rules.language.values import FALSE, NIL, TRUE, Value, as_symbol, is_true

Values = Mapping[str, Value]
Compiled = Callable[[Values, Values], Value]  # of the variables' values and the globals' values, both by name
External = Callable[..., Value | None]

OF_TWO_FLOATS: dict[
    str, Callable[[float, float], Value]
] = {  # what joins ask most, without a look at the arguments' kinds
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "<": lambda a, b: TRUE if a < b else FALSE,
    ">": lambda a, b: TRUE if a > b else FALSE,
    "<=": lambda a, b: TRUE if a <= b else FALSE,
    ">=": lambda a, b: TRUE if a >= b else FALSE,
}

DEEPEST_CALL = 100  # deffunctions within deffunctions: Python's own stack ends at about ten times that


class Evaluator:
    """Compiles the expressions of one program; `externals` are the functions that come from outside, such as `now`."""

    def __init__(self, functions: Mapping[str, Function], externals: Mapping[str, External] | None = None) -> None:
        self.functions = functions
        self.externals = externals if externals is not None else {}
        self._bodies: dict[str, Callable[[dict[str, Value], Values], Value]] = {}
        self._depth = 0

    def compiled(self, expression: Expression) -> Compiled:
        """Return the expression as a function; RuleError when that is called and the expression has no value."""
        if isinstance(expression, Constant):
            value = expression.value
            return lambda variables, globals_: value
        if isinstance(expression, VariableUse):
            return _variable(expression)
        if isinstance(expression, GlobalUse):
            return _global(expression)
        if expression.function in ("and", "or"):
            return self._early(expression)
        arguments = [self.compiled(argument) for argument in expression.arguments]
        if expression.function in self.functions:
            return self._of_program(self.functions[expression.function], arguments, expression.position)
        if expression.function in FUNCTIONS:
            return _of_library(expression, arguments)
        return self._external(expression, arguments)

    def _early(self, call: Call) -> Compiled:
        """`and` and `or`: the first argument that decides ends them."""
        arguments = [self.compiled(argument) for argument in call.arguments]
        decisive = call.function == "or"

        def run(variables: Values, globals_: Values) -> Value:
            for argument in arguments:
                if is_true(argument(variables, globals_)) is decisive:
                    return as_symbol(decisive)
            return as_symbol(not decisive)

        return run

    def _external(self, call: Call, arguments: list[Compiled]) -> Compiled:
        name, position = call.function, call.position

        def run(variables: Values, globals_: Values) -> Value:
            external = self.externals.get(name)
            if external is None:
                raise RuleError(f"({name} ...) is not to be had here", position)
            value = external(*[argument(variables, globals_) for argument in arguments])
            return NIL if value is None else value

        return run

    def _of_program(self, function: Function, arguments: list[Compiled], position: Position) -> Compiled:
        name, parameters, rest = function.name, function.parameters, function.rest

        def run(variables: Values, globals_: Values) -> Value:
            given = [argument(variables, globals_) for argument in arguments]
            inner: dict[str, Value] = dict(zip(parameters, given, strict=False))
            if rest is not None:
                inner[rest] = flattened(given[len(parameters) :])
            if self._depth >= DEEPEST_CALL:
                raise RuleError(f"({name} ...) calls itself more than {DEEPEST_CALL} times over", position)
            self._depth += 1
            try:
                return self._body(function)(inner, globals_)
            except RecursionError:
                raise RuleError(f"({name} ...) calls itself too deeply", position) from None
            finally:
                self._depth -= 1

        return run

    def _body(self, function: Function) -> Callable[[dict[str, Value], Values], Value]:
        if function.name not in self._bodies:
            self._bodies[function.name] = self._sequence(function.body)
        return self._bodies[function.name]

    def _sequence(self, actions: tuple[Action, ...]) -> Callable[[dict[str, Value], Values], Value]:
        steps = [self._step(action) for action in actions]
        if len(steps) == 1:
            return steps[0]

        def run(variables: dict[str, Value], globals_: Values) -> Value:
            value: Value = FALSE
            for step in steps:
                value = step(variables, globals_)
            return value

        return run

    def _step(self, action: Action) -> Callable[[dict[str, Value], Values], Value]:
        if isinstance(action, Bind):
            return self._bind(action)
        if isinstance(action, If):
            return self._if(action)
        assert isinstance(
            action, Constant | VariableUse | GlobalUse | Call
        )  # the reader lets nothing else into a deffunction
        return self.compiled(action)

    def _bind(self, bind: Bind) -> Callable[[dict[str, Value], Values], Value]:
        value, name = self.together(bind.values), bind.name

        def run(variables: dict[str, Value], globals_: Values) -> Value:
            variables[name] = bound = value(variables, globals_)
            return bound

        return run

    def _if(self, branch: If) -> Callable[[dict[str, Value], Values], Value]:
        condition = self.compiled(branch.condition)
        then, otherwise = self._sequence(branch.then), self._sequence(branch.otherwise)

        def run(variables: dict[str, Value], globals_: Values) -> Value:
            return (then if is_true(condition(variables, globals_)) else otherwise)(variables, globals_)

        return run

    def together(self, expressions: tuple[Expression, ...]) -> Compiled:
        """Return one value as it is, several as one multifield: what `bind` binds."""
        if len(expressions) == 1:
            return self.compiled(expressions[0])
        several = [self.compiled(expression) for expression in expressions]
        return lambda variables, globals_: flattened(one(variables, globals_) for one in several)


def _variable(use: VariableUse) -> Compiled:
    name, position = use.name, use.position

    def run(variables: Values, globals_: Values) -> Value:
        try:
            return variables[name]
        except KeyError:
            raise RuleError(f"?{name} has no value", position) from None

    return run


def _global(use: GlobalUse) -> Compiled:
    name, position = use.name, use.position

    def run(variables: Values, globals_: Values) -> Value:
        try:
            return globals_[name]
        except KeyError:
            raise RuleError(f"?*{name}* has no value", position) from None

    return run


def _of_library(call: Call, arguments: list[Compiled]) -> Compiled:
    function = FUNCTIONS[call.function].call

    def run(variables: Values, globals_: Values) -> Value:
        try:
            return function(*[argument(variables, globals_) for argument in arguments])
        except FunctionFault as fault:
            raise RuleError(f"({call.function} ...) {fault}", call.position) from None

    def run_one(variables: Values, globals_: Values) -> Value:
        try:
            return function(only(variables, globals_))
        except FunctionFault as fault:
            raise RuleError(f"({call.function} ...) {fault}", call.position) from None

    def run_two(variables: Values, globals_: Values) -> Value:
        a, b = first(variables, globals_), second(variables, globals_)
        if of_floats is not None and type(a) is float and type(b) is float:
            return of_floats(a, b)
        try:
            return function(a, b)
        except FunctionFault as fault:
            raise RuleError(f"({call.function} ...) {fault}", call.position) from None

    if len(arguments) == 1:  # one or two, most calls: one frame less on the stack, and faster
        (only,) = arguments
        return run_one
    if len(arguments) == 2:
        first, second = arguments
        of_floats = OF_TWO_FLOATS.get(call.function)
        return run_two
    return run


def evaluate(
    expression: Expression,
    variables: Values,
    globals_: Values,
    functions: Mapping[str, Function] | None = None,
    externals: Mapping[str, External] | None = None,
) -> Value:
    """Return the value of an expression."""
    return Evaluator(functions or {}, externals).compiled(expression)(variables, globals_)
