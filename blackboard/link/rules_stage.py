"""The rules' stage of a host: the planner, from when the behaviours have shown themselves."""

from collections.abc import Mapping
from typing import Any

from blackboard.assembly import Assembly
from blackboard.board import Board
from blackboard.component import Planner
from blackboard.kinds import BEHAVIOUR
from blackboard.planning import Planning

SHOW_S = 10.0  # on the mission's clock: processes that are started together are up by then


class RulesStage:
    """The planner. It begins once the behaviours have shown themselves, as in an embedded run, or have had time enough to."""

    def __init__(self, board: Board, assembly: Assembly, planner: Planner[Any], *, strict: bool = False) -> None:
        self.board = board
        self._planning = Planning(board, planner, assembly.parts(), strict=strict)
        self._waits_for = [behaviour.name for behaviour, _ in assembly.behaviours]
        self._waits_since_s: float | None = None

    def states(self) -> dict[str, object]:
        """Return what has to outlive the process."""
        return self._planning.states()

    def resume(self, states: Mapping[str, object]) -> None:
        """Go on from what a process before this one kept."""
        self._planning.resume(states)

    def decide(self) -> None:
        """Look at what changed, and act."""
        if self._waits_for and not self._ready():
            return
        self._planning.decide()

    @property
    def acted(self) -> bool:
        """Say whether something was done that should be kept at once."""
        return self._planning.acted

    def close(self) -> None:
        """Let go of what the planner holds."""
        self._planning.close()

    def _ready(self) -> bool:
        now_s = self.board.now_s
        self._waits_since_s = now_s if self._waits_since_s is None else self._waits_since_s
        self._waits_for = [name for name in self._waits_for if self.board.newest(BEHAVIOUR, name) is None]
        if now_s - self._waits_since_s > SHOW_S:
            self._waits_for = []  # rules are told by communication errors who does not answer
        return not self._waits_for
