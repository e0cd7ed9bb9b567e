"""What results are made from: a run in this process, or one read back from a keeper's journal."""

from typing import Protocol

import numpy as np
import numpy.typing as npt

from blackboard.board import Board
from blackboard.component import WorldTruth
from blackboard.messages.sensing import RobotDescription
from blackboard.mission import Mission


class SeenRobot(Protocol):
    """What a robot tells for results."""

    @property
    def description(self) -> RobotDescription:
        """Body and sensors."""

    @property
    def start_s(self) -> float:
        """The mission's clock when the run began."""

    def truth(self) -> WorldTruth | None:
        """Return the world as it is; None where nobody knows."""

    def drawn_lines(self) -> npt.NDArray[np.float64] | None:
        """Return the lines that others drew for the same map; None where nobody did."""

    def summary(self) -> dict[str, float | int | str]:
        """Return figures for the table at the end."""


class SeenRun(Protocol):
    """A run as it is looked at when it has ended, or on the way."""

    mission: Mission
    board: Board

    @property
    def robot(self) -> SeenRobot:
        """The robot."""

    def trajectory(self) -> npt.NDArray[np.float64]:
        """Return where the robot believed to be, (n, 4): stamp_s, x_m, y_m, heading_rad, map frame."""

    def true_trajectory(self) -> npt.NDArray[np.float64] | None:
        """Return where it really was, likewise; None where nobody knows."""
