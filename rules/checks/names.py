"""What rules ask of the board: behaviours, levels, knowledge sources and kinds that exist, with parameters that fit."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from blackboard.component import Parts
from blackboard.errors import did_you_mean
from rules.checks.finding import Finding
from rules.language.errors import RuleError
from rules.language.syntax import Call, Constant, Expression, Pattern, Position, Program
from rules.language.templates import KindTemplate, kind_templates
from rules.language.values import FALSE, TRUE, Symbol, Value, written
from rules.language.walk import calls_of, patterns_in

LIMITS = {"set-gain": 100.0, "set-threshold": 1000.0}  # those of blackboard.messages.motion.Switch
OF_BEHAVIOURS = ("behaviour", "motivation")  # templates whose ids are the names of behaviours


@dataclass(frozen=True)
class Board:
    """What there is to ask for. `certain` where it is one mission's, so that what is not there is an error."""

    parts: Parts
    certain: bool = True

    @cached_property
    def templates(self) -> Mapping[str, KindTemplate]:
        """The kinds' templates by their names."""
        return {made.template.name: made for made in kind_templates(self.parts.vocabulary).values()}


def name_findings(program: Program, board: Board) -> Iterator[Finding]:
    """Yield what is wrong with the board actions of a program's rules, as far as their arguments are constants."""
    checker = _Names(board)
    for rule in program.rules:
        for call in calls_of(rule):
            yield from checker.call(call)
        for pattern in patterns_in(rule.conditions):
            yield from checker.pattern(pattern)


class _Names:
    def __init__(self, board: Board) -> None:
        self.parts, self.certain, self.templates = board.parts, board.certain, board.templates
        self.where = "this mission" if board.certain else "the shipped missions"
        behaviours, sources = self.parts.behaviours, self.parts.sources
        self.known: dict[str, tuple[str, Iterable[str]]] = {
            "behaviour-select": ("behaviour", behaviours),
            "motivate": ("behaviour", behaviours),
            "set-gain": ("behaviour or level", [*behaviours, *self.parts.levels]),
            "set-threshold": ("behaviour or level", [*behaviours, *self.parts.levels]),
            "focus": ("knowledge source", sources),
        }

    def call(self, call: Call) -> Iterator[Finding]:
        if call.function == "post":
            yield from self._post(call)
        if call.function not in self.known:
            return
        what, names = self.known[call.function]
        name = _constant(call.arguments[0])
        if name is not None:
            missing = self._missing(name, what, names)
            if missing is not None:
                yield Finding(f"{call.function}: {missing}", call.arguments[0].position, self.certain)
                return
        yield from self._arguments(call, None if name is None else str(name).replace("-", "_"))

    def _missing(self, name: Value, what: str, names: Iterable[str]) -> str | None:
        if not isinstance(name, Symbol | str):
            return f"{written(name)} must be the name of a {what}"
        if str(name).replace("-", "_") in [known.replace("-", "_") for known in names]:
            return None
        return f"{self.where} has no {what} '{name}'{did_you_mean(str(name).replace('-', '_'), names)}".replace(
            "missions has", "missions have"
        )

    def _arguments(self, call: Call, name: str | None) -> Iterator[Finding]:
        if call.function in ("behaviour-select", "motivate"):
            yield from self._select(call, name)
            return
        value = _constant(call.arguments[1])
        if value is None:
            return
        is_number = isinstance(value, int | float)
        if call.function == "focus":
            if not is_number and not _is_switch(value):
                yield Finding(f"focus: {written(value)} must be a rating (a number), on or off", _at(call, 1), True)
        elif not isinstance(value, int | float) or not 0 <= value <= LIMITS[call.function]:
            text = f"{call.function}: {written(value)} must be a number in [0, {LIMITS[call.function]:g}]"
            yield Finding(text, _at(call, 1), True)

    def _select(self, call: Call, name: str | None) -> Iterator[Finding]:
        first = 1
        if call.function == "behaviour-select":
            state = _constant(call.arguments[1])
            if state is not None and not _is_switch(state):
                yield Finding(f"behaviour-select: {written(state)} must be on or off", _at(call, 1), True)
                return
            if state is None or str(state).lower() in ("off", "false") or len(call.arguments) == 2:
                return  # without parameters those count that `motivate` gave
            first = 2
        if name is None or name not in self.parts.behaviours:
            return
        names, optional = self.parts.behaviours[name]
        number = len(call.arguments) - first
        if not len(names) - optional <= number <= len(names):
            takes = " ".join(names) or "no parameters"
            yield Finding(f"behaviour '{name}' takes {takes}; not {number}", call.position, self.certain)

    def _post(self, call: Call) -> Iterator[Finding]:
        kind = str(_constant(call.arguments[0]))
        template = self.templates.get(kind)
        if template is None:
            yield Finding(
                f"post: no kind has the template '{kind}'{did_you_mean(kind, self.templates)}", _at(call, 0), True
            )
            return
        slots = {
            str(_constant(slot)): value for slot, value in zip(call.arguments[1::2], call.arguments[2::2], strict=True)
        }
        if template.kind.collection != ("id" in slots):
            need = "needs (id ...)" if template.kind.collection else "takes no id: there is only one"
            yield Finding(f"post: '{kind}' {need}", call.position, True)
            return
        given = {slot: _constant(value) for slot, value in slots.items() if slot != "id"}
        try:  # slots that exist, and values that fit where all of them are constants
            template.value({slot: value for slot, value in given.items() if value is not None})
        except RuleError as error:
            if None not in given.values() or "has no slot" in str(error):
                yield Finding(str(error), call.position, True)

    def pattern(self, pattern: Pattern) -> Iterator[Finding]:
        if pattern.relation not in OF_BEHAVIOURS or not self.certain or pattern.slots is None:
            return
        for slot, constraint in zip(pattern.slots, pattern.constraints, strict=True):
            if slot != "id" or constraint.binds is not None or len(constraint.alternatives) > 1:
                continue
            for atom in constraint.alternatives[0]:
                if isinstance(atom.term, Constant) and not atom.negated:
                    missing = self._missing_exactly(atom.term.value)
                    if missing is not None:
                        yield Finding(missing, atom.term.position)

    def _missing_exactly(self, name: Value) -> str | None:
        if not isinstance(name, Symbol) or name.name in self.parts.behaviours:
            return None
        near = did_you_mean(name.name.replace("-", "_"), self.parts.behaviours)
        return f"{self.where} has no behaviour '{name}', so this never matches{near}"


def _constant(expression: Expression) -> Value | None:
    return expression.value if isinstance(expression, Constant) else None


def _at(call: Call, argument: int) -> Position:
    return call.arguments[argument].position


def _is_switch(value: Value) -> bool:
    return value in (TRUE, FALSE) or (isinstance(value, Symbol | str) and str(value).lower() in ("on", "off"))
