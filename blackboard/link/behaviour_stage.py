"""The behaviours' stage of a host: they answer each cycle of the robot, and by their own clock where none comes."""

from collections.abc import Mapping

from blackboard.assembly import Assembly
from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.kinds import CYCLE, VELOCITY
from blackboard.link.mission_end import ends, mission_over
from blackboard.messages.hosts import CycleBeat
from blackboard.reflexes import Reflexes


class BehaviourStage:
    """Behaviours and coordinator: they answer each cycle of the robot, and by their own clock where none comes."""

    def __init__(self, board: Board, assembly: Assembly, *, strict: bool = False) -> None:
        self.board = board
        self._reflexes = Reflexes(
            board,
            assembly.behaviours,
            assembly.coordinator,
            assembly.robot.description,
            switches_of=assembly.switches_of,
            strict=strict,
        )
        self._step_s = assembly.mission.params.step_s
        self._ends = ends(assembly)
        self._answered: Entry[CycleBeat] | None = None
        self._answered_s = float("-inf")

    def states(self) -> dict[str, object]:
        """Return what has to outlive the process."""
        return self._reflexes.states()

    def resume(self, states: Mapping[str, object]) -> None:
        """Take up the motivations that stand, where this host ran before."""
        self._reflexes.resume(states)

    @property
    def next_s(self) -> float:
        """When it answers by itself."""
        return self._answered_s + 2.5 * self._step_s

    def due(self) -> bool:
        """Say whether a cycle of the robot waits for an answer, or should have come long ago."""
        return self.board.newest(CYCLE) is not self._answered or self.board.now_s >= self.next_s

    def answer(self) -> None:
        """Answer the newest readings."""
        self._answered = self.board.newest(CYCLE)
        self._answered_s = self.board.now_s
        if self._ends and mission_over(self.board):
            return
        standing = self.board.newest(VELOCITY)
        wanted = self._reflexes.respond()
        if wanted is None and standing is not None:
            self.board.retract(VELOCITY, source=standing.source)
