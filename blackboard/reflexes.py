"""Reflexes: from the newest readings to a wanted velocity, every cycle, whatever becomes of the knowledge sources.

Behaviours answer in the mission's order; one that answers silences those it inhibits; the coordinator turns the answers into a
wanted velocity. A behaviour that raises is left out from then on; without a coordinator nobody commands. What may go to the
wheels of it the safety layer says (`blackboard.safety_watch`).

A behaviour answers while it is selected; a motivation selects and deselects it, and its status acknowledges that.

Reads  motivations/motivation/<behaviour>
Posts  control/switch/..., where the coordinator reads switches
       commands/response/<behaviour>, commands/velocity, status/behaviour/<behaviour>
"""

from collections.abc import Mapping, Sequence
from typing import Any

from msgspec.structs import replace

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import Behaviour, Coordinator, Progress
from blackboard.control import report_failure
from blackboard.entry import Entry, Support
from blackboard.errors import SkiError
from blackboard.kinds import BEHAVIOUR, MOTIVATION, RESPONSE, SWITCH, VELOCITY
from blackboard.messages.motion import BehaviourStatus, Motivation, Response, Velocity
from blackboard.messages.sensing import RobotDescription
from blackboard.mission import Wiring
from blackboard.resumption import NOTHING, resume, show_anew, state_of
from blackboard.switches import Switches

PROGRESS_STEP_M = 0.25  # how far a behaviour has to go is told in such steps: its status is news, not a stream


class _Held:
    """A behaviour with its wiring and its standing."""

    def __init__(self, board: Board, behaviour: Behaviour[Any], wiring: Wiring) -> None:
        self.behaviour = behaviour
        self.access = Access(board, behaviour.name, (MOTIVATION, *behaviour.reads), (RESPONSE,))
        self.inhibits = wiring.inhibits
        self.wiring = wiring
        self.selected = wiring.selected if wiring.selected is not None else not behaviour.motivated
        self.asked: Entry[Motivation] | None = None  # the newest motivation
        self.taken_up = 0
        self.failed = False
        self.answering = False
        self.refused = ""
        self.shown: BehaviourStatus | None = None

    def take_up(self) -> None:
        """Do what the newest motivation says, if it is new."""
        if self.asked is None or self.asked.value.number == self.taken_up:
            return
        motivation = self.asked.value
        self.taken_up, self.refused = motivation.number, ""
        if motivation.on:
            try:
                self.behaviour.select(motivation.parameters)
            except SkiError as error:
                self.refused = str(error)
        elif self.selected:
            self.behaviour.deselect()
        self.selected = motivation.on and not self.refused

    def resume(self, state: object, board: Board) -> None:
        """Go on after a restart as the board says: selected by the same motivation, from the state that was kept while it stood."""
        name = self.behaviour.name
        self.asked = board.newest(MOTIVATION, name)
        self.answering = board.newest(RESPONSE, name) is not None
        standing = board.newest(BEHAVIOUR, name)
        if standing is None:
            return
        self.shown, self.selected = standing.value, standing.value.selected
        self.taken_up = standing.value.acknowledged
        number, kept = state if isinstance(state, tuple) else (None, None)
        if number == self.taken_up:
            self.behaviour.resume(kept, self.access)
        elif self.asked is not None and self.asked.value.number == self.taken_up and self.selected:
            self.taken_up -= 1  # so that it is taken up once more, and acknowledged by the same number

    def status(self, inhibited: bool) -> BehaviourStatus:
        """Return where it stands."""
        progress = self.behaviour.progress() if self.selected and not self.failed else Progress()
        if self.failed:
            state = "failed"
        elif self.selected and self.behaviour.done():
            state = "done"
        elif inhibited:
            state = "inhibited"
        else:
            state = "active" if self.answering else "idle"
        remaining_m = progress.remaining_m
        return BehaviourStatus(
            state=state,  # type: ignore[arg-type]
            selected=self.selected,
            acknowledged=self.taken_up,
            outcome="blocked" if self.refused else progress.outcome,
            remaining_m=None if remaining_m is None else round(remaining_m / PROGRESS_STEP_M) * PROGRESS_STEP_M,
            detail=(self.refused or progress.detail)[:4000],
        )


class Reflexes:
    """Behaviours and coordinator on one board."""

    def __init__(
        self,
        board: Board,
        behaviours: Sequence[tuple[Behaviour[Any], Wiring]],
        coordinator: Coordinator[Any] | None,
        robot: RobotDescription,
        *,
        switches_of: str | None = None,
        strict: bool = False,
    ) -> None:
        """Wire them; the switches belong to `switches_of`, who may set them (the coordinator itself unless given)."""
        self._board = board
        self._strict = strict
        self._robot = robot
        self._coordinator = coordinator
        self._coordinator_access = Access(board, coordinator.name, coordinator.reads, ()) if coordinator else None
        self._held = [_Held(board, b, wiring) for b, wiring in behaviours]
        self._by_name = {held.behaviour.name: held for held in self._held}
        self._switches: Switches | None = None
        if coordinator is not None and SWITCH in coordinator.reads:
            self._switches = Switches(board, switches_of or coordinator.name)
        self._wired = False
        board.subscribe(f"ski/{board.robot}/{MOTIVATION.path}/*", self._note)

    def states(self) -> dict[str, object]:
        """Return what has to outlive the process, by component, to be pickled at once."""
        states: dict[str, object] = {
            held.behaviour.name: (held.taken_up, state_of(held.behaviour)) for held in self._held if not held.failed
        }
        if self._coordinator is not None:
            states[self._coordinator.name] = state_of(self._coordinator)
        return states

    def resume(self, states: Mapping[str, object] = NOTHING) -> None:
        """Go on after a restart, on the board as it stands: motivations are taken up, switches stay as they are."""
        for held in self._held:
            try:
                held.resume(states.get(held.behaviour.name), self._board)
            except Exception as error:
                show_anew(self._board, held.behaviour.name, str(error))
        if self._coordinator is not None and self._coordinator_access is not None:
            resume(self._coordinator, states, self._coordinator_access, self._board)
        if self._switches is not None:
            self._switches.resume()

    def respond(self) -> Entry[Velocity] | None:
        """Run one control cycle and return the wanted velocity, None where nobody commands."""
        if not self._wired:
            self._wire()
        return self._combine(self._responses())

    def _note(self, entry: Entry[Motivation]) -> None:
        held = self._by_name.get(entry.id or "")
        if held is not None:
            held.asked = None if entry.event == "retracted" else entry

    def _wire(self) -> None:
        self._wired = True
        if self._switches is not None:
            self._switches.wire({held.behaviour.name: held.wiring for held in self._held})

    def _responses(self) -> dict[str, Entry[Response]]:
        inhibited: set[str] = set()
        responses: dict[str, Entry[Response]] = {}
        for held in self._held:
            name = held.behaviour.name
            answer: Response | None = None
            if held.failed:
                continue
            if held.asked is not None and held.asked.value.number != held.taken_up:
                held.take_up()
            if held.selected and name not in inhibited and not held.behaviour.done():
                if held.asked is not None:
                    held.access.newest(MOTIVATION, name)  # what it answers to
                try:
                    answer = held.behaviour.respond(held.access)
                except Exception as error:
                    held.failed = True
                    report_failure(self._board, name, error, None, strict=self._strict)
            seen = held.access.take_seen()
            if answer is not None:
                supports = tuple(entry.as_support() for entry in seen)
                entry = self._board.post(RESPONSE, answer, id=name, source=name, supports=supports)
                passed = self._switched(name, answer)
                if passed is not None:
                    responses[name] = entry if passed is answer else replace(entry, value=passed)
                    inhibited.update(held.inhibits)
                self._adjust(held, supports if passed is not None else None)
            elif held.answering:
                self._board.retract(RESPONSE, name, source=name)
                self._adjust(held, None)
            held.answering = answer is not None
            self._show(held, name in inhibited and answer is None and held.selected)
        return responses

    def _switched(self, name: str, answer: Response) -> Response | None:
        if self._coordinator is None or self._coordinator_access is None:
            return answer
        try:
            return self._coordinator.switched(name, answer, self._coordinator_access)
        except Exception as error:
            self._lose_coordinator(error)
            return None

    def _adjust(self, held: _Held, supports: tuple[Support, ...] | None) -> None:
        """Put the switches that a behaviour wants into the lines of others; take them out where its answer does not go on."""
        if self._switches is None:
            return
        try:
            wanted = held.behaviour.adjusts() if supports is not None else {}
            self._switches.adjust(held.behaviour.name, wanted, supports or ())
        except Exception as error:
            held.failed = True
            self._switches.adjust(held.behaviour.name, {}, ())
            report_failure(self._board, held.behaviour.name, error, None, strict=self._strict)

    def _show(self, held: _Held, inhibited: bool) -> None:
        try:
            status = held.status(inhibited)
        except Exception as error:
            held.failed = True
            report_failure(self._board, held.behaviour.name, error, None, strict=self._strict)
            status = held.status(inhibited)
        if status != held.shown:
            held.shown = status
            self._board.post(BEHAVIOUR, status, id=held.behaviour.name, source=held.behaviour.name)

    def _combine(self, responses: dict[str, Entry[Response]]) -> Entry[Velocity] | None:
        if self._coordinator is None or self._coordinator_access is None or not responses:
            return None
        values = {name: entry.value for name, entry in responses.items()}
        try:
            wanted = self._coordinator.combine(values, self._robot, self._coordinator_access)
            seen = self._coordinator_access.take_seen()
            supports = tuple(entry.as_support() for entry in (*responses.values(), *seen))
            return self._board.post(VELOCITY, wanted, source=self._coordinator.name, supports=supports)
        except Exception as error:
            self._lose_coordinator(error)
            return None

    def _lose_coordinator(self, error: Exception) -> None:
        if self._coordinator is not None:
            name, self._coordinator = self._coordinator.name, None
            report_failure(self._board, name, error, None, strict=self._strict)
