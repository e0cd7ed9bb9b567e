"""The planner on the board: it hears of every post, decides once a cycle, and where it fails the robot goes on without it."""

from collections.abc import Mapping
from typing import Any

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import Parts, Planner
from blackboard.control import report_failure
from blackboard.resumption import NOTHING, resume, state_of


class Planning:
    """One planner at work. Raises a SkiError where it asks for what the mission does not have."""

    def __init__(self, board: Board, planner: Planner[Any], parts: Parts, *, strict: bool = False) -> None:
        self._board = board
        self._strict = strict
        self.planner: Planner[Any] | None = planner
        planner.start(parts)
        self._access = Access(board, planner.name, parts.vocabulary, planner.posts)
        board.subscribe(f"ski/{board.robot}/**", planner.note)

    def decide(self) -> None:
        """Let the planner look at what changed, and act."""
        planner = self.planner
        if planner is None:
            return
        try:
            planner.decide(self._access)
        except Exception as error:
            self.planner = None
            report_failure(self._board, planner.name, error, None, strict=self._strict)

    @property
    def acted(self) -> bool:
        """Say whether the planner has acted since its state was last told."""
        return self.planner is not None and self.planner.acted

    def states(self) -> dict[str, object]:
        """Return what has to outlive the process, by component, to be pickled at once."""
        return {} if self.planner is None else {self.planner.name: state_of(self.planner)}

    def resume(self, states: Mapping[str, object] = NOTHING) -> None:
        """Let the planner go on after a restart, on the board as it stands."""
        if self.planner is not None:
            resume(self.planner, states, self._access, self._board)

    def close(self) -> None:
        """Let go of what the planner holds."""
        if self.planner is not None:
            self.planner.close()
