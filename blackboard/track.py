"""Where a robot was, as it believed or as it was: a growing list of stamped poses."""

from array import array

import numpy as np
import numpy.typing as npt

from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.kinds import MAP_FROM_ODOM, ODOM_FROM_ROBOT
from blackboard.messages.geometry import IDENTITY, Pose


class Track:
    """A growing list of stamped poses, 32 bytes each."""

    def __init__(self) -> None:
        self._numbers = array("d")

    def add(self, stamp_s: float, pose: Pose) -> None:
        """Append a pose."""
        self._numbers.extend((stamp_s, pose.x_m, pose.y_m, pose.heading_rad))

    def rows(self) -> npt.NDArray[np.float64]:
        """Return (n, 4) stamp_s, x_m, y_m, heading_rad."""
        return np.array(self._numbers, dtype=np.float64).reshape(-1, 4)

    def __len__(self) -> int:
        return len(self._numbers) // 4


def believed_track(board: Board) -> Track:
    """Return a track that follows where the robot on a board believes to be, map frame, each pose as of its time."""
    track = Track()

    def note(entry: Entry[Pose]) -> None:
        correction = board.newest(MAP_FROM_ODOM)
        map_from_odom = correction.value if correction is not None else IDENTITY
        track.add(entry.stamp_s, map_from_odom @ entry.value)

    board.subscribe(board.key(ODOM_FROM_ROBOT), note)
    return track
