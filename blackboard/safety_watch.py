"""The safety layer at work, next to the wheels: from a wanted velocity to what may go to them, whatever else has failed.

Posts  commands/drive    Drive
"""

from collections.abc import Mapping
from typing import Any

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import SafetyLayer
from blackboard.control import report_failure
from blackboard.entry import Entry, Support
from blackboard.kinds import DRIVE
from blackboard.messages.motion import Drive, Velocity
from blackboard.resumption import NOTHING, resume, state_of

STOP = Drive(forward_mps=0.0, turn_radps=0.0, limited_by="no command")


class SafetyWatch:
    """One safety layer on a board; where it raises the robot stands still from then on."""

    def __init__(self, board: Board, safety: SafetyLayer[Any], *, strict: bool = False) -> None:
        self._board = board
        self._strict = strict
        self._safety: SafetyLayer[Any] | None = safety
        self._access = Access(board, safety.name, safety.reads, ())

    def states(self) -> dict[str, object]:
        """Return what has to outlive the process, by component, to be pickled at once."""
        return {} if self._safety is None else {self._safety.name: state_of(self._safety)}

    def resume(self, states: Mapping[str, object] = NOTHING) -> None:
        """Go on after a restart, on the board as it stands."""
        if self._safety is not None:
            resume(self._safety, states, self._access, self._board)

    def limit(self, wanted: Entry[Velocity] | None) -> Drive:
        """Post and return what goes to the wheels; `wanted` is None when nobody commands."""
        drive, supports = STOP, list[Support]()
        if self._safety is not None:
            try:
                drive = self._safety.limit(wanted.value if wanted is not None else None, self._access)
            except Exception as error:
                name, self._safety = self._safety.name, None
                report_failure(self._board, name, error, wanted, strict=self._strict)
            supports = [entry.as_support() for entry in self._access.take_seen()]
        if wanted is not None:
            supports.insert(0, wanted.as_support())
        return self._board.post(DRIVE, drive, source="safety", supports=tuple(supports)).value
