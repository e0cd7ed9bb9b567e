"""Runs the right-hand sides of rules against a working memory that an engine provides."""

from collections.abc import Callable, Mapping, MutableMapping
from typing import Protocol

from rules.language.errors import RuleError
from rules.language.evaluation import Compiled, Evaluator, External, Values
from rules.language.functions import printed
from rules.language.library.multifields import flattened
from rules.language.syntax import (
    Action,
    Assert,
    Bind,
    Call,
    Constant,
    FactForm,
    GlobalUse,
    If,
    Modify,
    Position,
    Program,
    Retract,
    Template,
    VariableUse,
)
from rules.language.values import NIL, FactAddress, FactValue, Symbol, Value, is_true

BREAKS = {"crlf": "\n", "tab": "\t", "vtab": "\v", "ff": "\f"}


class WorkingMemory(Protocol):
    """What actions need of an engine. Indices are those that `?f <-` binds."""

    @property
    def globals_(self) -> MutableMapping[str, Value]: ...
    def assert_fact(self, fact: FactValue) -> object: ...
    def retract(self, index: int) -> None: ...
    def modify(self, index: int, fact: FactValue) -> None: ...
    def fact(self, index: int) -> FactValue | None: ...
    def print(self, text: str) -> None: ...
    def halt(self) -> None: ...


Step = Callable[[dict[str, Value], WorkingMemory], None]
MakeFact = Callable[[Values, Values], FactValue]


class ActionCompiler:
    """Compiles the actions of one program; RuleError when they run and cannot be done."""

    def __init__(self, program: Program, externals: Mapping[str, External]) -> None:
        self.templates = {template.name: template for template in program.templates}
        self.evaluator = Evaluator({function.name: function for function in program.functions}, externals)

    def actions(self, actions: tuple[Action, ...]) -> Step:
        """Return the actions as one function of the variables' values (which `bind` changes) and the working memory."""
        steps = [self._step(action) for action in actions]

        def run(variables: dict[str, Value], memory: WorkingMemory) -> None:
            for step in steps:
                step(variables, memory)

        return run

    def _step(self, action: Action) -> Step:
        if isinstance(action, Assert):
            return self._assert(action)
        if isinstance(action, Retract):
            return self._retract(action)
        if isinstance(action, Modify):
            return self._modify(action)
        if isinstance(action, Bind):
            return self._bind(action)
        if isinstance(action, If):
            return self._if(action)
        if isinstance(action, Call) and action.function == "halt":
            return lambda variables, memory: memory.halt()
        if isinstance(action, Call) and action.function == "printout":
            return self._print(action)
        return self._value(action)

    def _value(self, action: Constant | VariableUse | GlobalUse | Call) -> Step:
        value = self.evaluator.compiled(action)

        def run(variables: dict[str, Value], memory: WorkingMemory) -> None:
            value(variables, memory.globals_)

        return run

    def _assert(self, action: Assert) -> Step:
        facts = [self.fact(form) for form in action.facts]

        def run(variables: dict[str, Value], memory: WorkingMemory) -> None:
            for fact in facts:
                memory.assert_fact(fact(variables, memory.globals_))

        return run

    def _retract(self, action: Retract) -> Step:
        facts = [self.evaluator.compiled(fact) for fact in action.facts]

        def run(variables: dict[str, Value], memory: WorkingMemory) -> None:
            for fact in facts:
                index = _index(fact(variables, memory.globals_), action.position)
                if memory.fact(index) is not None:  # retracting what is gone already does nothing, as in CLIPS
                    memory.retract(index)

        return run

    def _modify(self, action: Modify) -> Step:
        address = self.evaluator.compiled(action.fact)
        changes = [(name, self.evaluator.together(values)) for name, values in action.slots]

        def run(variables: dict[str, Value], memory: WorkingMemory) -> None:
            index = _index(address(variables, memory.globals_), action.position)
            old = memory.fact(index)
            if old is None:
                return  # retracted in the meantime: nothing to do, as in CLIPS
            template = self.templates[old.relation]
            new = {name: value(variables, memory.globals_) for name, value in changes}
            fields = [
                fitted(new[slot.name], slot.name, slot.multi, action.position)
                if slot.name in new
                else old.slot(slot.name)
                for slot in template.slots
            ]
            fact = FactValue(old.relation, tuple(fields), old.slots)
            if fact.key != old.key:  # a modify that changes nothing does nothing, as in CLIPS
                memory.modify(index, fact)

        return run

    def _bind(self, action: Bind) -> Step:
        value, name = self.evaluator.together(action.values), action.name

        def run(variables: dict[str, Value], memory: WorkingMemory) -> None:
            target = memory.globals_ if action.is_global else variables
            target[name] = value(variables, memory.globals_)

        return run

    def _if(self, action: If) -> Step:
        condition = self.evaluator.compiled(action.condition)
        then, otherwise = self.actions(action.then), self.actions(action.otherwise)

        def run(variables: dict[str, Value], memory: WorkingMemory) -> None:
            (then if is_true(condition(variables, memory.globals_)) else otherwise)(variables, memory)

        return run

    def _print(self, action: Call) -> Step:
        values = [self.evaluator.compiled(argument) for argument in action.arguments[1:]]

        def run(variables: dict[str, Value], memory: WorkingMemory) -> None:
            memory.print("".join(_shown(value(variables, memory.globals_)) for value in values))

        return run

    def fact(self, form: FactForm) -> MakeFact:
        """Return a function that makes the fact of a form; a slot that is not written has its default."""
        fields = [self.evaluator.compiled(field) for field in form.fields]
        template = self.templates.get(form.relation)
        if template is None or form.slots is None:
            return lambda variables, globals_: FactValue(
                form.relation, flattened(f(variables, globals_) for f in fields)
            )
        return _template_fact(form, template, fields)


def _template_fact(form: FactForm, template: Template, fields: list[Compiled]) -> MakeFact:
    names = tuple(slot.name for slot in template.slots)
    written: dict[str, list[Compiled]] = {}
    for name, field in zip(form.slots or (), fields, strict=True):
        written.setdefault(name, []).append(field)
    defaults = {slot.name: default_of(slot.multi, slot.default) for slot in template.slots}

    def make(variables: Values, globals_: Values) -> FactValue:
        values = []
        for slot in template.slots:
            if slot.name not in written:
                values.append(defaults[slot.name])
                continue
            given = [field(variables, globals_) for field in written[slot.name]]
            value = given[0] if len(given) == 1 else flattened(given)
            values.append(fitted(value, slot.name, slot.multi, form.position))
        return FactValue(template.name, tuple(values), names)

    return make


def default_of(multi: bool, default: Value | None) -> Value:
    """Return what a slot holds that nothing is written for."""
    if default is not None:
        return default
    return () if multi else NIL


def fitted(value: Value, slot: str, multi: bool, position: Position | None) -> Value:
    """Return the value as a slot holds it; RuleError where it is a multifield and the slot holds one value."""
    if multi:
        return value if isinstance(value, tuple) else (value,)
    if isinstance(value, tuple):
        raise RuleError(f"the slot '{slot}' holds one value, not the multifield {printed(value)}", position)
    return value


def _index(value: Value, position: Position) -> int:
    if not isinstance(value, FactAddress):
        raise RuleError(f"{printed(value)} is no fact", position)
    return value.index


def _shown(value: Value) -> str:
    return BREAKS.get(value.name, value.name) if isinstance(value, Symbol) else printed(value)
