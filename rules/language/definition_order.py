"""Globals and functions, each after what it uses: CLIPS reads a text from its beginning and knows nothing of what comes later."""

from collections.abc import Iterator
from dataclasses import dataclass

from rules.language.syntax import Action, Bind, Call, Expression, Function, Global, GlobalUse, If, Program


@dataclass(frozen=True, slots=True)
class Declared:
    """A function that must be known before its body can be read, since it and another call each other."""

    function: Function


def in_order(program: Program) -> list[Global | Function | Declared]:
    """Return the globals and functions of a program, each after those that it uses."""
    return _Ordering(program).run()


class _Ordering:
    def __init__(self, program: Program) -> None:
        self.program = program
        self.functions = {function.name: function for function in program.functions}
        self.globals = {one.name: one for one in program.globals}
        self.begun: set[tuple[type, str]] = set()
        self.done: set[tuple[type, str]] = set()
        self.declared: set[str] = set()
        self.ordered: list[Global | Function | Declared] = []

    def run(self) -> list[Global | Function | Declared]:
        for one in self.program.globals:
            self._visit(one)
        for function in self.program.functions:
            self._visit(function)
        return self.ordered

    def _visit(self, definition: Global | Function) -> None:
        key = (type(definition), definition.name)
        if key in self.done:
            return
        if key in self.begun:
            if isinstance(definition, Function) and definition.name not in self.declared:
                self.declared.add(definition.name)
                self.ordered.append(Declared(definition))
            return
        self.begun.add(key)
        for used in self._uses(definition):
            if used is not definition:  # CLIPS knows a function within itself
                self._visit(used)
        self.done.add(key)
        self.ordered.append(definition)

    def _uses(self, definition: Global | Function) -> Iterator[Global | Function]:
        body = (definition.value,) if isinstance(definition, Global) else definition.body
        for action in body:
            for expression in _expressions(action):
                yield from self._used(expression)

    def _used(self, expression: Expression) -> Iterator[Global | Function]:
        if isinstance(expression, GlobalUse) and expression.name in self.globals:
            yield self.globals[expression.name]
        if isinstance(expression, Call):
            if expression.function in self.functions:
                yield self.functions[expression.function]
            for argument in expression.arguments:
                yield from self._used(argument)


def _expressions(action: Action) -> Iterator[Expression]:
    if isinstance(action, Bind):
        yield from action.values
    elif isinstance(action, If):
        yield action.condition
        for inner in (*action.then, *action.otherwise):
            yield from _expressions(inner)
    elif isinstance(action, Call | GlobalUse):
        yield action
