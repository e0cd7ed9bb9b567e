"""The control module: which knowledge source runs next (Bou-Ghannam 1992, section 4.4).

When a trigger's condition holds, an activation record goes on the agenda. Each cycle the control module runs the records of
highest rating, oldest first among equals, until the cycle's budget of work is spent; the rest waits. In lock-step the budget is
declared work units, so that the same posts give the same order of activations everywhere.

Reads  control/focus/<name>    another rating, or that the source is to rest: set by rules
Posts  control/agenda             what waits, when that changes
       control/activation/<name>  the newest activation of each source
       control/activation_time/<name>  measured seconds, not recorded
       status/component/<name>    running, or failed with its trigger and error
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any, TypeVar

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import KnowledgeSource, Trigger
from blackboard.condition import Condition
from blackboard.entry import Entry
from blackboard.errors import ComponentFailed, SkiError
from blackboard.kinds import ACTIVATION, ACTIVATION_TIME, AGENDA, COMPONENT, FOCUS, Kind
from blackboard.messages.base import Message
from blackboard.messages.control import Activation, ActivationTime, Agenda, ComponentStatus, Focus, Waiting
from blackboard.parameters import require
from blackboard.resumption import NOTHING, resume, state_of

M = TypeVar("M", bound=Message)
CONTROL = "control"  # the name under which the control module posts


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlParams:
    """How much knowledge work a cycle may do, and how long the agenda may grow."""

    work_per_cycle: int = 100  # declared units; every shipped source counts a scan as 1 and a batch of 500 points as 10
    agenda_limit: int = 1000  # records of one source that may wait; past it the oldest is dropped and counted

    def __post_init__(self) -> None:
        require(self.work_per_cycle >= 1, "work_per_cycle", self.work_per_cycle, "1 and more")
        require(self.agenda_limit >= 1, "agenda_limit", self.agenda_limit, "1 and more")


class _Source:
    """A knowledge source under control: its records, its access, its standing."""

    def __init__(self, source: KnowledgeSource[Any], board: Board) -> None:
        self.source = source
        self.triggers = as_triggers(source)
        self.conditions = [Condition(trigger) for trigger in self.triggers]
        kinds = [trigger.kind for trigger in self.triggers]
        self.access = Access(board, source.name, [*kinds, *source.reads], source.posts)
        self.records: deque[tuple[int, Entry[Any]]] = deque()  # (order of arrival, trigger)
        self.enabled = True
        self.rating = source.rating
        self.resting = False
        self.activations = 0
        self.seconds = 0.0
        self.longest_s = 0.0


def as_triggers(source: KnowledgeSource[Any]) -> tuple[Trigger[Any], ...]:
    """Return a source's triggers, a bare kind standing for every entry of it."""
    return tuple(Trigger(kind=t) if isinstance(t, Kind) else t for t in source.triggers)


class Control:
    """Holds the agenda and runs knowledge sources from it. With `strict`, a source that raises ends the run (ComponentFailed)."""

    def __init__(
        self,
        board: Board,
        sources: Sequence[KnowledgeSource[Any]],
        params: ControlParams | None = None,
        *,
        strict: bool = False,
    ) -> None:
        self.params = params or ControlParams()
        self._board = board
        self._strict = strict
        self._sources = [_Source(source, board) for source in sources]
        self._arrivals = 0
        self._dropped = 0
        self._shown: Agenda | None = None
        self._by_name: dict[str, _Source] = {}
        board.subscribe(f"ski/{board.robot}/{FOCUS.path}/*", self._focus)
        for held in self._sources:
            self._by_name[held.source.name] = held
            for trigger, condition in zip(held.triggers, held.conditions, strict=True):
                expression = f"ski/{board.robot}/{trigger.kind.path}" + ("/*" if trigger.kind.collection else "")
                board.subscribe(expression, self._noting(held, condition))

    def states(self) -> dict[str, object]:
        """Return what has to outlive the process, by component, to be pickled at once: of the sources, and its own."""
        own = {
            held.source.name: ([condition.state for condition in held.conditions], list(held.records))
            for held in self._sources
        }
        return {**{held.source.name: state_of(held.source) for held in self._sources}, CONTROL: own}

    def resume(self, states: Mapping[str, object] = NOTHING) -> None:
        """Go on after a restart, on the board as it stands: each source from its state, with what waited and rules' focus."""
        own = states.get(CONTROL)
        for held in self._sources:
            went_on = resume(held.source, states, held.access, self._board)
            if went_on and isinstance(own, dict) and held.source.name in own:
                conditions, records = own[held.source.name]
                for condition, seen in zip(held.conditions, conditions, strict=True):
                    condition.state = seen
                held.records.extend(records)
                self._arrivals = max([self._arrivals, *(order for order, _ in records)])
        for entry in self._board.entries(FOCUS):
            self._focus(entry)
        agenda = self._board.newest(AGENDA)
        if agenda is not None:
            self._shown, self._dropped = agenda.value, agenda.value.dropped

    @property
    def waiting(self) -> int:
        """The number of activation records on the agenda."""
        return sum(len(held.records) for held in self._sources)

    def run_cycle(self) -> int:
        """Run activation records within one cycle's budget; return the work done. The first record always runs."""
        done = self._run(self.params.work_per_cycle)
        self._show_agenda()
        return done

    def finish(self) -> None:
        """Run all that waits, let every source post what it holds back, and run what that triggers."""
        self._drain()
        for held in self._sources:
            if held.enabled:
                self._guard(held, None, lambda held=held: held.source.finish(held.access))  # type: ignore[misc]
                self._drain()
        self._show_agenda()
        for held in self._sources:
            self._post_times(held)

    def _drain(self) -> None:
        for _ in range(self.params.agenda_limit * max(1, len(self._sources))):  # bounded, whatever a source posts
            if not self.waiting:
                return
            self._run(self.params.work_per_cycle)

    def _focus(self, entry: Entry[Focus]) -> None:
        """Do what a rule says of a source's rating; one that rests forgets what waited for it."""
        held = self._by_name.get(entry.id or "")
        if held is None or entry.event == "retracted":
            return
        held.rating = entry.value.rating
        held.resting = not entry.value.enabled
        if held.resting:
            held.records.clear()

    def _noting(self, held: _Source, condition: Condition[Any]) -> Callable[[Entry[Any]], None]:
        def note(entry: Entry[Any]) -> None:
            if held.enabled and not held.resting and entry.event != "retracted" and self._holds(held, condition, entry):
                self._arrivals += 1
                held.records.append((self._arrivals, entry))
                if len(held.records) > self.params.agenda_limit:
                    held.records.popleft()
                    self._dropped += 1

        return note

    def _holds(self, held: _Source, condition: Condition[Any], entry: Entry[Any]) -> bool:
        if not condition.trigger.conditional:
            return True
        verdict: list[bool] = []
        self._guard(held, entry, lambda: verdict.append(condition.holds(entry, self._board.now_s)))
        return bool(verdict and verdict[0])

    def _run(self, budget: int) -> int:
        spent = 0
        while True:
            held = self._next()
            if held is None or (spent and spent + held.source.work > budget):
                return spent
            _, trigger = held.records.popleft()
            spent += held.source.work
            self._activate(held, trigger)

    def _next(self) -> _Source | None:
        best: _Source | None = None
        for held in self._sources:
            if held.records and (best is None or self._precedes(held, best)):
                best = held
        return best

    @staticmethod
    def _precedes(a: _Source, b: _Source) -> bool:
        if a.rating != b.rating:
            return a.rating > b.rating
        return a.records[0][0] < b.records[0][0]

    def _activate(self, held: _Source, trigger: Entry[Any]) -> None:
        started = perf_counter()
        ok = self._guard(held, trigger, lambda: held.source.activate(trigger, held.access))
        took = perf_counter() - started
        held.activations += 1
        held.seconds += took
        held.longest_s = max(held.longest_s, took)
        source = held.source
        record = Activation(
            source=source.name,
            trigger_key=trigger.key,
            trigger_revision=trigger.revision,
            rating=held.rating,
            work=source.work,
            outcome="done" if ok else "failed",
        )
        self._board.post(ACTIVATION, record, id=source.name, source=CONTROL, supports=(trigger.as_support(),))
        if held.activations & (held.activations - 1) == 0 or held.activations % 100 == 0:
            self._post_times(held)

    def _guard(self, held: _Source, trigger: Entry[Any] | None, call: Callable[[], object]) -> bool:
        """Run a source's code; where it raises, name it, show its trigger, and go on without it."""
        try:
            call()
        except Exception as error:
            held.enabled = False
            held.records.clear()
            report_failure(self._board, held.source.name, error, trigger, strict=self._strict)
            return False
        return True

    def _post_times(self, held: _Source) -> None:
        times = ActivationTime(activations=held.activations, total_s=held.seconds, longest_s=held.longest_s)
        self._board.post(ACTIVATION_TIME, times, id=held.source.name, source=CONTROL)

    def _show_agenda(self) -> None:
        waiting = [held for held in self._sources if held.records]
        if not waiting and self._shown is not None and not self._shown.waiting and self._shown.dropped == self._dropped:
            return
        waiting.sort(key=lambda held: (-held.rating, held.records[0][0]))
        agenda = Agenda(
            waiting=tuple(
                Waiting(
                    source=held.source.name,
                    rating=held.rating,
                    records=len(held.records),
                    trigger_key=held.records[0][1].key,
                )
                for held in waiting
            ),
            dropped=self._dropped,
        )
        if agenda != self._shown:
            self._shown = agenda
            self._board.post(AGENDA, agenda, source=CONTROL)


def report_failure(board: Board, name: str, error: Exception, trigger: Entry[Any] | None, *, strict: bool) -> None:
    """Mark a component failed on the board, with what it was working on; under `strict`, raise ComponentFailed instead."""
    text = str(error) if isinstance(error, SkiError) else f"{type(error).__name__}: {error}"
    shown = f" on {trigger.key} revision {trigger.revision}" if trigger is not None else ""
    status = ComponentStatus(
        state="failed",
        error=text[:4000],
        trigger_key=trigger.key if trigger is not None else "",
        trigger_revision=trigger.revision if trigger is not None else 0,
    )
    supports = (trigger.as_support(),) if trigger is not None else ()
    board.post(COMPONENT, status, id=name, source=name, supports=supports)
    if strict:
        raise ComponentFailed(f"{name} failed{shown}: {text}") from error
