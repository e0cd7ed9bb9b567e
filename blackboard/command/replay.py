"""A run across processes, read back from the journal that its keeper kept: the same results as of an embedded run."""

from pathlib import Path

import msgspec
import numpy as np
import numpy.typing as npt

from blackboard.assembly import Assembly
from blackboard.board import Board
from blackboard.component import WorldTruth
from blackboard.errors import BoardError, MessageError
from blackboard.journal import read_journal
from blackboard.kinds import ROBOT_SUMMARY, TRUE_POSE
from blackboard.link.envelope import read_entry
from blackboard.messages.sensing import RobotDescription
from blackboard.runner import Progress
from blackboard.track import Track, believed_track

TELL_S = 5.0  # of the mission's clock between two words of progress


class ReplayedRobot:
    """A robot that ran in another process: what it told of itself stands on the board, the rest is as its mission says."""

    def __init__(self, assembly: Assembly, board: Board) -> None:
        self._robot = assembly.robot
        self._board = board

    @property
    def description(self) -> RobotDescription:
        """Body and sensors."""
        return self._robot.description

    @property
    def start_s(self) -> float:
        """The mission's clock when the run began."""
        return self._robot.start_s

    def truth(self) -> WorldTruth | None:
        """Return the world as it is; None where nobody knows."""
        return self._robot.truth()

    def drawn_lines(self) -> npt.NDArray[np.float64] | None:
        """Return the lines that others drew for the same map."""
        return self._robot.drawn_lines()

    def summary(self) -> dict[str, float | int | str]:
        """Return the last figures that its host posted."""
        told = self._board.newest(ROBOT_SUMMARY)
        return msgspec.json.decode(told.value.figures, type=dict[str, float | int | str]) if told is not None else {}


class ReplayedRun:
    """A run that is read back: watch its board, then `read` its journal."""

    def __init__(self, assembly: Assembly) -> None:
        self.mission = assembly.mission
        self.board = Board(assembly.vocabulary, robot=assembly.robot.description.name, history=assembly.mission.history)
        self.robot = ReplayedRobot(assembly, self.board)
        self.passed_over = 0  # lines that no kind of this mission fits
        self._track, self._truth = believed_track(self.board), Track()
        self.board.subscribe(self.board.key(TRUE_POSE), lambda entry: self._truth.add(entry.stamp_s, entry.value))

    def read(self, journal: Path, progress: Progress | None = None) -> None:
        """Read a journal to its end; raise RecordingError where it is none."""
        board = self.board
        told_s = self.robot.start_s
        own = f"ski/{board.robot}/"
        for line in read_journal(journal):
            try:
                entry = read_entry(board.vocabulary, line)[1]
            except (BoardError, MessageError):
                self.passed_over += 1
                continue
            if not entry.key.startswith(own):
                continue
            board.posts += 1
            board.now_s = max(board.now_s, entry.stamp_s)
            board.accept(entry)
            if progress is not None and board.now_s - told_s >= TELL_S:
                told_s = board.now_s
                progress(told_s - self.robot.start_s, 0.0)

    def trajectory(self) -> npt.NDArray[np.float64]:
        """Return where the robot believed to be, (n, 4): stamp_s, x_m, y_m, heading_rad, map frame, each as of its time."""
        return self._track.rows()

    def true_trajectory(self) -> npt.NDArray[np.float64] | None:
        """Return where it really was, likewise; None where nobody knows."""
        return self._truth.rows() if len(self._truth) else None
