"""The engine that runs on experta: no more than Python is needed.

experta's engine, rules, facts, agenda, with a matcher and a strategy of our own that have CLIPS's semantics (see `matching`).
"""

from collections.abc import Callable, Mapping, MutableMapping, Sequence

from rules.engines.compilation import Act, experta_rules
from rules.engines.engine import Activation, Engine, External, FactChange, Firing, told
from rules.engines.knowledge_base import KnowledgeBase
from rules.engines.matching.network import Network
from rules.engines.strategy import RuleActivation
from rules.language.actions import ActionCompiler
from rules.language.errors import RuleError
from rules.language.syntax import Program, Rule
from rules.language.values import FactValue, Value


class ExpertaEngine(Engine):
    """Runs a program on experta."""

    def __init__(self, program: Program, externals: Mapping[str, External] | None = None) -> None:
        super().__init__(program, externals)
        self._globals: dict[str, Value] = {}
        self._compiler = ActionCompiler(program, self.externals)
        self._changes: list[FactChange] = []
        self._printed: list[str] = []
        self._halted = False
        templates = {template.name: template for template in program.templates}
        network = Network(templates, self._compiler.evaluator.compiled, self._globals)
        self._faults = network.compiler.faults
        acts = [self._act(rule) for rule in program.rules]
        self._base = KnowledgeBase(experta_rules(program.rules, acts), network)
        self._memory = _Memory(self._base, self._globals, self._changes, self._printed, self._halt)

    def _act(self, rule: Rule) -> Act:
        step = self._compiler.actions(rule.actions)

        def act(bindings: dict[str, Value]) -> None:
            step(bindings, self._memory)

        return act

    def _halt(self) -> None:
        self._halted = True

    def reset(self) -> None:
        self._halted = False
        self._globals.clear()
        for one in self.program.globals:
            self._globals[one.name] = self._compiler.evaluator.compiled(one.value)({}, self._globals)
        self._base.reset()
        for fact in self.initial_facts():
            self._base.declare(fact)

    def assert_fact(self, fact: FactValue) -> int | None:
        return self._base.declare(fact)

    def retract(self, index: int) -> None:
        self._base.retract(index)

    def facts(self) -> Mapping[int, FactValue]:
        return {index: fact.value for index, fact in self._base.facts.items()}

    def agenda(self) -> Sequence[Activation]:
        return [_shown(waiting) for waiting in reversed(self._base.agenda.activations)]

    def fact(self, index: int) -> FactValue | None:
        return self._memory.fact(index)

    def waiting(self) -> Activation | None:
        activations = self._base.agenda.activations
        return _shown(activations[-1]) if activations else None

    def drop(self, activation: Activation) -> None:
        if self._base.take(_is(activation)) is None:
            raise KeyError(activation)

    def initial_facts(self) -> Sequence[FactValue]:
        forms = [form for deffacts in self.program.deffacts for form in deffacts.facts]
        return [self._compiler.fact(form)({}, self._globals) for form in forms]

    def fire(self, activation: Activation | None = None) -> Firing | None:
        waiting = None if self._halted else self._base.take(None if activation is None else _is(activation))
        if waiting is None:
            return None
        self._changes.clear()
        self._printed.clear()
        error = None
        try:
            waiting.rule(bindings=waiting.context)
        except Exception as fault:  # also of an external function: the other rules go on
            error = told(fault)
        return Firing(_shown(waiting), _net(self._changes), "".join(self._printed), error)

    @property
    def halted(self) -> bool:
        return self._halted

    def resume(self) -> None:
        self._halted = False

    def globals(self) -> Mapping[str, Value]:
        return dict(self._globals)

    def set_global(self, name: str, value: Value) -> None:
        if name not in self._globals:
            raise KeyError(name)
        self._globals[name] = value

    def take_faults(self) -> Sequence[RuleError]:
        faults = tuple(self._faults.values())
        self._faults.clear()
        return faults

    def close(self) -> None:
        self._base.clear()


class _Memory:
    """Working memory as the actions of rules see it; keeps what they change."""

    def __init__(
        self,
        base: KnowledgeBase,
        globals_: dict[str, Value],
        changes: list[FactChange],
        printed: list[str],
        halt: Callable[[], None],
    ) -> None:
        self._base = base
        self._globals = globals_
        self._changes = changes
        self._printed = printed
        self.halt = halt

    @property
    def globals_(self) -> MutableMapping[str, Value]:
        return self._globals

    def assert_fact(self, fact: FactValue) -> int | None:
        index = self._base.declare(fact)
        if index is not None:
            self._changes.append(FactChange(index, fact, True))
        return index

    def retract(self, index: int) -> None:
        self._changes.append(FactChange(index, self._base.retract(index), False))

    def modify(self, index: int, fact: FactValue) -> None:
        old, stands = self._base.replace(index, fact)
        self._changes.append(FactChange(index, old, False))
        if stands:
            self._changes.append(FactChange(index, fact, True))

    def fact(self, index: int) -> FactValue | None:
        found = self._base.facts.get(index)
        return None if found is None else found.value

    def print(self, text: str) -> None:
        self._printed.append(text)


def _shown(waiting: RuleActivation) -> Activation:
    return Activation(waiting.rule.__name__, waiting.row.indices(waiting.facts), waiting.rule.salience)


def _net(changes: Sequence[FactChange]) -> tuple[FactChange, ...]:
    """Return what has gone and what has come in the end, each by index."""
    first: dict[int, FactChange] = {}
    last: dict[int, FactChange] = {}
    for change in changes:
        first.setdefault(change.index, change)
        last[change.index] = change
    gone = {index: change for index, change in first.items() if not change.asserted}
    come = {index: change for index, change in last.items() if change.asserted}
    same = {index for index in gone.keys() & come.keys() if gone[index].fact.key == come[index].fact.key}
    return tuple(found[index] for found in (gone, come) for index in sorted(found) if index not in same)


def _is(activation: Activation) -> Callable[[RuleActivation], bool]:
    return lambda waiting: waiting.rule.__name__ == activation.rule and _shown(waiting) == activation
