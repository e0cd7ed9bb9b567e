"""The engine that is CLIPS itself, through clipspy: the same rule files, faster.

clipspy 1.0.6 prints a Python function's exception and goes on, and its `load` keeps the good part of a bad file: here external
functions and `halt` are caught on their way, and each program gets an environment of its own. One engine is for one thread.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import clips
from clips.routers import Router

from rules.engines.clips_calls import COPY_FUNCTION, copying
from rules.engines.clips_facts import ClipsFacts
from rules.engines.clips_limits import refuse_crashing
from rules.engines.clips_values import check_readable, from_clips, to_clips
from rules.engines.engine import Activation, Engine, External, Firing, told
from rules.engines.matching.disjuncts import Part, disjuncts
from rules.language.actions import ActionCompiler
from rules.language.errors import RuleError
from rules.language.syntax import Assert, Match, Modify, Program, Retract, Rule, Test
from rules.language.values import FactAddress, FactValue, Value
from rules.language.walk import actions_of
from rules.language.writing import written_constructs

HALT = "halt"
PREFIX = "ski-external-"
NO_FAULTS = (
    "[DRIVE1]",  # a condition could not be evaluated: it does not match
    "[FACTMCH1]",
    "[PRNTUTIL11]",  # a fact was retracted already: nothing is done
)


class _Output(Router):  # type: ignore[misc]
    """Keeps what CLIPS writes, apart for the user and for faults."""

    def __init__(self) -> None:
        super().__init__("ski-output", 50)  # above clipspy's own router, which would print faults
        self.written = {"stdout": "", "stderr": "", "stdwrn": ""}

    def query(self, name: str) -> bool:
        return name in self.written

    def write(self, name: str, message: str) -> None:
        self.written[name] += message

    def taken(self, name: str) -> str:
        """Return what was written there since the last time."""
        text, self.written[name] = self.written[name], ""
        return text


class ClipsEngine(Engine):
    """Runs a program on CLIPS."""

    def __init__(self, program: Program, externals: Mapping[str, External] | None = None) -> None:
        super().__init__(program, externals)
        refuse_crashing(program)
        self._halted = False
        self._raised: Exception | None = None
        self._output = _Output()
        self._clips: Any = clips.Environment()
        self._clips.add_router(self._output)
        names = {name: f"python-function {PREFIX}{name}" for name in (*self.externals, HALT)}
        for name, function in self.externals.items():
            self._clips.define_function(self._guarded(function), PREFIX + name)
        self._clips.define_function(self._halt, PREFIX + HALT)
        self._clips.build(COPY_FUNCTION)
        for text, position in written_constructs(copying(program, self.externals), names):
            try:
                self._clips.build(text)
            except clips.CLIPSError:
                raise RuleError(f"CLIPS refuses this: {self._fault()}", position) from None
        slots = {template.name: tuple(slot.name for slot in template.slots) for template in program.templates}
        self._facts = ClipsFacts(self._clips, slots)
        self._shapes = {rule.name: [_shape(row) for row in disjuncts(rule.conditions)] for rule in program.rules}
        self._changing = {
            rule.name
            for rule in program.rules
            if any(isinstance(one, Assert | Retract | Modify) for one in actions_of(rule.actions))
        }

    def _halt(self) -> clips.Symbol:
        self._halted = True
        return clips.Symbol("TRUE")

    def _guarded(self, function: External) -> Any:
        def call(*arguments: Any) -> Any:
            try:
                return to_clips(function(*map(from_clips, arguments)))
            except Exception as error:
                self._raised = error
                raise

        return call

    def _fault(self) -> str:
        """Return what CLIPS has written about the last fault, in one line."""
        return " ".join(self._output.taken("stderr").split()) or "it does not say why"

    def reset(self) -> None:
        self._clips.reset()
        self._halted = False
        self._facts.read_all()

    def assert_fact(self, fact: FactValue) -> int | None:
        check_readable(fact)
        index, is_new = self._facts.assert_fact(str(fact))
        if index is None:
            raise RuleError(f"{fact}: CLIPS refuses this fact: {self._fault()}")
        return index if is_new else None

    def retract(self, index: int) -> None:
        self._facts.retract(index)

    def facts(self) -> Mapping[int, FactValue]:
        return dict(self._facts.values)

    def agenda(self) -> Sequence[Activation]:
        return [self._activation(waiting) for waiting in self._clips.activations()]

    def fact(self, index: int) -> FactValue | None:
        return self._facts.values.get(index)

    def waiting(self) -> Activation | None:
        first = next(iter(self._clips.activations()), None)
        return None if first is None else self._activation(first)

    def drop(self, activation: Activation) -> None:
        waiting = next(self._wanted(activation), None)
        if waiting is None:
            raise KeyError(activation)
        waiting.delete()

    def initial_facts(self) -> Sequence[FactValue]:
        compiler = ActionCompiler(self.program, self.externals)
        globals_ = self.globals()
        forms = [form for deffacts in self.program.deffacts for form in deffacts.facts]
        return [compiler.fact(form)({}, globals_) for form in forms]

    def fire(self, activation: Activation | None = None) -> Firing | None:
        waiting = None if self._halted else next(self._wanted(activation), None)
        if waiting is None:
            return None
        fired = self._activation(waiting)
        if activation is not None:
            waiting.salience = 10_000
            self._clips.reorder()
        self._output.taken("stdout"), self._output.taken("stderr")
        self._raised = None
        named = self._named(fired) if fired.rule in self._changing else ()
        self._clips.run(1)
        fault = self._output.taken("stderr")
        self._clips.clear_error_state()
        error = None
        if self._raised is not None:
            error = told(self._raised)
        elif fault and ("[PRCCODE4]" in fault or not any(code in fault for code in NO_FAULTS)):
            error = " ".join(fault.partition("[PRCCODE4]")[0].split())
        changes = self._facts.look(named) if fired.rule in self._changing else ()
        return Firing(fired, changes, self._output.taken("stdout"), error)

    def _wanted(self, activation: Activation | None) -> Any:
        return (one for one in self._clips.activations() if activation is None or self._activation(one) == activation)

    def _activation(self, waiting: Any) -> Activation:
        """Read an activation as CLIPS prints it: `10 rule: f-1,*,f-3`.

        CLIPS puts `*` for some tests too and for what it makes of `or` and `exists`: what is in question are our conditions.
        """
        salience, _, rest = str(waiting).partition(" ")
        written = rest[len(waiting.name) + 1 :].split(",")
        indices = [int(one.strip()[2:]) for one in written if one.strip().startswith("f-")]
        relations = [self._facts.values[index].relation for index in indices]
        shapes = self._shapes[waiting.name]
        shape = next(one for one in shapes if [relation for relation in one if relation is not None] == relations)
        matched = iter(indices)
        facts = tuple(None if relation is None else next(matched) for relation in shape)
        return Activation(waiting.name, facts, int(salience))

    def _named(self, fired: Activation) -> list[int]:
        """Return the indices of the facts that the actions of a rule can name."""
        matched = [index for index in fired.facts if index is not None]
        held = [value for index in matched for value in self._facts.values[index].fields] + list(
            self.globals().values()
        )
        return matched + [value.index for value in held if isinstance(value, FactAddress)]

    @property
    def halted(self) -> bool:
        return self._halted

    def resume(self) -> None:
        self._halted = False

    def globals(self) -> Mapping[str, Value]:
        return {one.name: from_clips(one.value) for one in self._clips.globals()}

    def set_global(self, name: str, value: Value) -> None:
        if all(one.name != name for one in self.program.globals):
            raise KeyError(name)
        self._clips.find_global(name).value = to_clips(value)

    def close(self) -> None:
        self._facts.environment = None
        self._clips = None


def _shape(row: Sequence[Part]) -> list[str | None]:
    """Return the relation that each condition matches; None for those that match no one fact."""
    return [part.pattern.relation if isinstance(part, Match) else None for part in row if not isinstance(part, Test)]


def _changes_facts(rule: Rule) -> bool:
    return any(isinstance(action, Assert | Retract | Modify) for action in actions_of(rule.actions))
