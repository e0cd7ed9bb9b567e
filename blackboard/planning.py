"""The planner on the board: it hears of every post, decides once a cycle, and where it fails the robot goes on without it."""

from typing import Any

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import Parts, Planner
from blackboard.control import report_failure


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

    def close(self) -> None:
        """Let go of what the planner holds."""
        if self.planner is not None:
            self.planner.close()
