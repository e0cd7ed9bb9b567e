"""Reflexes: from the newest readings to the wheels, every cycle, whatever becomes of the knowledge sources.

Behaviours answer in the mission's order; one that answers silences those it inhibits; the coordinator turns the answers into a
wanted velocity; the safety layer turns that into what may go to the wheels. A behaviour that raises is left out from then
on; without a coordinator or safety layer the robot stands still.

Posts  commands/response/<behaviour>, commands/velocity, commands/drive, status/behaviour/<behaviour>
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import Behaviour, Coordinator, SafetyLayer
from blackboard.control import report_failure
from blackboard.entry import Entry, Support
from blackboard.kinds import BEHAVIOUR, DRIVE, RESPONSE, VELOCITY
from blackboard.messages.motion import BehaviourStatus, Drive, Response, Velocity
from blackboard.messages.sensing import RobotDescription

STOP = Drive(forward_mps=0.0, turn_radps=0.0, limited_by="no command")


@dataclass
class _Held:
    behaviour: Behaviour[Any]
    access: Access
    inhibits: tuple[str, ...]
    state: str = ""
    failed: bool = False
    answering: bool = field(default=False)


class Reflexes:
    """Behaviours, coordinator and safety layer on one board."""

    def __init__(
        self,
        board: Board,
        behaviours: Sequence[tuple[Behaviour[Any], tuple[str, ...]]],
        coordinator: Coordinator[Any] | None,
        safety: SafetyLayer[Any],
        robot: RobotDescription,
        *,
        strict: bool = False,
    ) -> None:
        self._board = board
        self._strict = strict
        self._robot = robot
        self._coordinator = coordinator
        self._safety: SafetyLayer[Any] | None = safety
        self._safety_access = Access(board, safety.name, safety.reads, ())
        self._held = [_Held(b, Access(board, b.name, b.reads, (RESPONSE,)), inhibits) for b, inhibits in behaviours]

    def respond(self) -> Drive:
        """Run one control cycle and return what goes to the wheels."""
        responses = self._responses()
        wanted = self._combine(responses)
        return self._limit(wanted)

    def _responses(self) -> dict[str, Entry[Response]]:
        inhibited: set[str] = set()
        responses: dict[str, Entry[Response]] = {}
        for held in self._held:
            name = held.behaviour.name
            answer: Response | None = None
            if held.failed:
                continue
            if name not in inhibited and not held.behaviour.done():
                try:
                    answer = held.behaviour.respond(held.access)
                except Exception as error:
                    held.failed = True
                    report_failure(self._board, name, error, None, strict=self._strict)
            seen = held.access.take_seen()
            if answer is not None:
                supports = tuple(entry.as_support() for entry in seen)
                responses[name] = self._board.post(RESPONSE, answer, id=name, source=name, supports=supports)
                inhibited.update(held.inhibits)
            elif held.answering:
                self._board.retract(RESPONSE, name, source=name)
            held.answering = answer is not None
            self._show(held, name in inhibited and answer is None)
        return responses

    def _show(self, held: _Held, inhibited: bool) -> None:
        if held.failed:
            state = "failed"
        elif held.behaviour.done():
            state = "done"
        elif inhibited:
            state = "inhibited"
        else:
            state = "active" if held.answering else "idle"
        if state != held.state:
            held.state = state
            status = BehaviourStatus(state=state)  # type: ignore[arg-type]
            self._board.post(BEHAVIOUR, status, id=held.behaviour.name, source=held.behaviour.name)

    def _combine(self, responses: dict[str, Entry[Response]]) -> Entry[Velocity] | None:
        if self._coordinator is None or not responses:
            return None
        values = {name: entry.value for name, entry in responses.items()}
        try:
            wanted = self._coordinator.combine(values, self._robot, self._board.now_s)
            supports = tuple(entry.as_support() for entry in responses.values())
            return self._board.post(VELOCITY, wanted, source=self._coordinator.name, supports=supports)
        except Exception as error:
            name, self._coordinator = self._coordinator.name, None
            report_failure(self._board, name, error, None, strict=self._strict)
            return None

    def _limit(self, wanted: Entry[Velocity] | None) -> Drive:
        drive, supports = STOP, list[Support]()
        if self._safety is not None:
            try:
                drive = self._safety.limit(wanted.value if wanted is not None else None, self._safety_access)
            except Exception as error:
                name, self._safety = self._safety.name, None
                report_failure(self._board, name, error, wanted, strict=self._strict)
            supports = [entry.as_support() for entry in self._safety_access.take_seen()]
        if wanted is not None:
            supports.insert(0, wanted.as_support())
        return self._board.post(DRIVE, drive, source="safety", supports=tuple(supports)).value
