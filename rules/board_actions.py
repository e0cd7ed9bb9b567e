"""What rules can do on the board: each action is checked when a rule calls it, and done once the rule has fired.

behaviour-select NAME on|off [PARAMETER ...]   selects a behaviour with these parameters (or with those that `motivate` gave), or
                                               takes it back; without an acknowledgement in time there is a communication-error
motivate NAME PARAMETER ...                    sets the motivation state of a behaviour; it stays selected or not as it was
post TEMPLATE [id ID] SLOT VALUE ...           posts or revises an entry; in rule files (post (template (slot value) ...))
retract-entry FACT|KEY                         takes an entry off the board that a rule has posted
set-gain NAME GAIN, set-threshold NAME VALUE   a switch of the arbitration network: of a behaviour or a competence level
focus SOURCE RATING|on|off                     the rating of a knowledge source, or whether it works

Bou-Ghannam 1992, sections 4.3 and 5.1 (the behavior selector).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from msgspec.structs import replace

from blackboard.access import Access
from blackboard.component import Parts
from blackboard.entry import Entry
from blackboard.errors import did_you_mean
from blackboard.kinds import BEHAVIOUR, COMMUNICATION_ERROR, FOCUS, MOTIVATION, SWITCH, Kind
from blackboard.messages.control import Focus
from blackboard.messages.motion import BehaviourStatus, Motivation
from rules.language.errors import RuleError
from rules.language.templates import kind_template, kind_templates
from rules.language.values import FALSE, TRUE, FactAddress, Symbol, Value, written

Step = Callable[[Access, Sequence[Entry[Any]]], None]  # does one thing on the board, on these supports


@dataclass(frozen=True, slots=True)
class Deed:
    """One action that a rule called: in words, and how it is done."""

    words: str
    step: Step


@dataclass(frozen=True, slots=True, kw_only=True)
class ActionsState:
    """What of the board actions outlives their process."""

    numbers: Mapping[str, int]
    states: Mapping[str, tuple[float | str, ...]]
    on: Mapping[str, bool]


class BoardActions:
    """The board actions of one planning module, for an engine to call. `deeds` gathers them until they are done."""

    def __init__(self, parts: Parts, posts: Sequence[Kind[Any]], acknowledge_s: float) -> None:
        self._parts = parts
        self._templates = {path: made for path, made in kind_templates(parts.vocabulary).items() if made.kind in posts}
        self._acknowledge_s = acknowledge_s
        self._deeds: list[Deed] = []
        self._numbers: dict[str, int] = {}
        self._states: dict[str, tuple[float | str, ...]] = {}  # motivation states by behaviour
        self._on: dict[str, bool] = {}  # as asked for, or else as its status says
        self._posted: set[str] = set()
        self.waiting: dict[str, tuple[int, float]] = {}  # by behaviour: the number asked for, and when
        self._late: set[str] = set()
        self.entry_of: Callable[[int], Entry[Any] | None] = lambda _: None
        self.now_s = 0.0

    def externals(self) -> dict[str, Callable[..., Value | None]]:
        """Return the functions that rules may call, by name."""
        return {
            "behaviour-select": self.behaviour_select,
            "behavior-select": self.behaviour_select,  # the thesis's spelling
            "motivate": self.motivate,
            "post": self.post,
            "retract-entry": self.retract_entry,
            "set-gain": lambda name, value: self._switch(name, "gain", value),
            "set-threshold": lambda name, value: self._switch(name, "threshold", value),
            "focus": self.focus,
            "now": lambda: self.now_s,
        }

    def state(self) -> ActionsState:
        """Return what outlives the process."""
        return ActionsState(numbers=dict(self._numbers), states=dict(self._states), on=dict(self._on))

    def resume(self, state: ActionsState | None, board: Access) -> None:
        """Go on after a restart: motivations are numbered on above those that stand, and whoever owes an acknowledgement has time
        for it once more.
        """
        if state is not None:
            self._numbers, self._states, self._on = dict(state.numbers), dict(state.states), dict(state.on)
        statuses = {str(entry.id): entry.value for entry in board.entries(BEHAVIOUR)}
        for behaviour, status in statuses.items():
            self._on.setdefault(behaviour, status.selected)
            self._numbers[behaviour] = max(self._numbers.get(behaviour, 0), status.acknowledged)
        for entry in board.entries(MOTIVATION):
            behaviour, number = str(entry.id), entry.value.number
            if number >= self._numbers.get(behaviour, 0):
                self._numbers[behaviour], self._on[behaviour] = number, entry.value.on
            if behaviour not in statuses or statuses[behaviour].acknowledged < number:
                self.waiting[behaviour] = (number, self.now_s)
        self._late = {str(entry.id) for entry in board.entries(COMMUNICATION_ERROR)} & self.waiting.keys()
        kinds = {made.kind.path: made.kind for made in self._templates.values()}
        self._posted = {entry.key for kind in kinds.values() for entry in board.own(kind)}

    def take(self) -> list[Deed]:
        """Return what was called since the last time, in order."""
        deeds, self._deeds = self._deeds, []
        return deeds

    def acknowledged(self, behaviour: str, status: BehaviourStatus) -> None:
        """Take note of where a behaviour stands: it may have taken up a motivation, or have been selected from the start."""
        self._on.setdefault(behaviour, status.selected)
        if behaviour in self.waiting and status.acknowledged >= self.waiting[behaviour][0]:
            del self.waiting[behaviour]
            self._late.discard(behaviour)

    def late(self) -> dict[str, tuple[int, float]]:
        """Return who has just become late with an acknowledgement: of which number, and for how long it was waited."""
        late = {
            behaviour: (number, self.now_s - asked_s)
            for behaviour, (number, asked_s) in self.waiting.items()
            if behaviour not in self._late and self.now_s - asked_s >= self._acknowledge_s
        }
        self._late.update(late)
        return late

    def is_late(self, behaviour: str) -> bool:
        """Say whether a behaviour still owes an acknowledgement."""
        return behaviour in self._late

    def behaviour_select(self, name: Value, state: Value, *parameters: Value) -> None:
        behaviour = self._behaviour(name)
        on = _on_or_off("behaviour-select", state)
        if on and not parameters and behaviour in self._states:
            given = self._states[behaviour]
        else:
            given = self._checked(behaviour, parameters) if on else ()
        self._on[behaviour] = on
        number = self._next(behaviour)
        self.waiting[behaviour] = (number, self.now_s)
        self._motivation(behaviour, Motivation(on=on, number=number, parameters=given))

    def motivate(self, name: Value, *parameters: Value) -> None:
        behaviour = self._behaviour(name)
        given = self._states[behaviour] = self._checked(behaviour, parameters)
        if self._on.get(behaviour, False):
            self._motivation(behaviour, Motivation(on=True, number=self._next(behaviour), parameters=given))
        else:
            self._do(f"motivate {behaviour} with {_list(given)}", lambda board, supports: None)

    def post(self, name: Value, *slots: Value) -> None:
        template = kind_template(_word("post", name), self._templates)
        kind = template.kind
        given = dict(zip(map(str, slots[::2]), slots[1::2], strict=True))
        member = given.pop("id", None)
        if kind.collection != (member is not None):
            need = "needs (id ...)" if kind.collection else "takes no id, there is only one"
            raise RuleError(f"post: '{name}' {need}")
        value = template.value(given)
        entry_id = None if member is None else _word("post", member)

        def step(board: Access, supports: Sequence[Entry[Any]]) -> None:
            self._posted.add(board.post(kind, value, id=entry_id, supports=supports).key)

        words = " ".join(f"{slot} {written(slot_value)}" for slot, slot_value in given.items())
        self._do(f"post {name}{f' {entry_id}' if entry_id else ''}: {words}", step)

    def retract_entry(self, what: Value) -> None:
        if isinstance(what, FactAddress):
            entry = self.entry_of(what.index)
            if entry is None:
                raise RuleError("retract-entry: no entry of the board stands behind this fact; use retract")
            key = entry.key
        else:
            key = _word("retract-entry", what)
        if key not in self._posted:
            raise RuleError(f"retract-entry: no rule has posted '{key}'; only its owner may retract an entry")
        _, kind, member = self._parts.vocabulary.parse_key(key)
        self._posted.discard(key)
        self._do(f"retract {key}", lambda board, supports: board.retract(kind, member))

    def focus(self, name: Value, how: Value) -> None:
        source = _underscored(_word("focus", name))
        if source not in self._parts.sources:
            known = self._parts.sources
            raise RuleError(f"focus: this mission has no knowledge source '{name}'{did_you_mean(source, known)}")
        number = _number(how)
        enabled = number is not None or _on_or_off("focus", how)

        def step(board: Access, supports: Sequence[Entry[Any]]) -> None:
            before = board.newest(FOCUS, source)
            rating = before.value.rating if before is not None else self._parts.sources[source]
            value = Focus(rating=rating if number is None else number, enabled=enabled)
            board.post(FOCUS, value, id=source, supports=supports)

        self._do(f"focus on {source}: {written(how)}", step)

    def _switch(self, name: Value, what: str, value: Value) -> None:
        action = f"set-{what}"
        switch = _underscored(_word(action, name))
        known = [*self._parts.behaviours, *self._parts.levels]
        if switch not in known:
            raise RuleError(f"{action}: there is no behaviour or level '{name}'{did_you_mean(switch, known)}")
        number = _number(value)
        limit = 100.0 if what == "gain" else 1000.0
        if number is None or not 0.0 <= number <= limit:
            raise RuleError(f"{action} {name}: {written(value)} must be a number in [0, {limit:g}]")

        def step(board: Access, supports: Sequence[Entry[Any]]) -> None:
            before = board.newest(SWITCH, switch)
            if before is None:
                raise RuleError(
                    f"{action}: this mission's coordinator has no switches; use behaviours.arbitration_network"
                )
            board.post(SWITCH, replace(before.value, **{what: number}), id=switch, supports=supports)

        self._do(f"{action} {switch} to {number:g}", step)

    def _behaviour(self, name: Value) -> str:
        behaviour = _underscored(_word("behaviour-select", name))
        if behaviour not in self._parts.behaviours:
            raise RuleError(f"this mission has no behaviour '{name}'{did_you_mean(behaviour, self._parts.behaviours)}")
        return behaviour

    def _checked(self, behaviour: str, parameters: Sequence[Value]) -> tuple[float | str, ...]:
        names, optional = self._parts.behaviours[behaviour]
        if not len(names) - optional <= len(parameters) <= len(names):
            takes = " ".join(names) or "no parameters"
            raise RuleError(f"behaviour '{behaviour}' takes {takes}; {len(parameters)} were given")
        given: list[float | str] = []
        for name, value in zip(names, parameters, strict=False):
            number = _number(value)
            if number is None and not isinstance(value, Symbol | str):
                raise RuleError(f"behaviour '{behaviour}': {name} = {written(value)} must be a number or a word")
            given.append(number if number is not None else str(value))
        return tuple(given)

    def _motivation(self, behaviour: str, motivation: Motivation) -> None:
        how = f"on with {_list(motivation.parameters)}" if motivation.parameters else "on"
        words = f"select {behaviour} {how if motivation.on else 'off'}"

        def step(board: Access, supports: Sequence[Entry[Any]]) -> None:
            board.post(MOTIVATION, motivation, id=behaviour, supports=supports)

        self._do(words, step)

    def _next(self, behaviour: str) -> int:
        self._numbers[behaviour] = self._numbers.get(behaviour, 0) + 1
        return self._numbers[behaviour]

    def _do(self, words: str, step: Step) -> None:
        self._deeds.append(Deed(words, step))


def _underscored(name: str) -> str:
    return name.replace("-", "_")


def _word(action: str, value: Value) -> str:
    if not isinstance(value, Symbol | str | int):  # an id that is all digits is an integer
        raise RuleError(f"{action}: {written(value)} must be a name")
    return str(value)


def _number(value: Value) -> float | None:
    return float(value) if isinstance(value, int | float) else None


def _on_or_off(action: str, value: Value) -> bool:
    word = str(value).lower() if isinstance(value, Symbol | str) else ""
    if value in (TRUE, FALSE):
        return value == TRUE
    if word not in ("on", "off"):
        raise RuleError(f"{action}: {written(value)} must be on or off")
    return word == "on"


def _list(parameters: Iterable[float | str]) -> str:
    return ", ".join(f"{p:g}" if isinstance(p, float) else p for p in parameters)
