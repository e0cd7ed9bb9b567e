"""What a run says of its pose while it goes on, kept for scores: odometry alone, and the estimates with their covariances.

Reads  observations/feature/odom_from_robot      Pose
       hypotheses/feature/pose_estimate          PoseEstimate
"""

from array import array

import numpy as np
import numpy.typing as npt

from blackboard.entry import Entry
from blackboard.kinds import ODOM_FROM_ROBOT, POSE_ESTIMATE
from blackboard.messages.geometry import Pose
from blackboard.messages.model import PoseEstimate
from blackboard.report.pose_scores import nees, pose_errors
from blackboard.report.result import Trajectory
from blackboard.runner import Run
from blackboard.track import Track


class PoseLog:
    """Listens from the beginning of a run; build it before the run starts."""

    def __init__(self, run: Run) -> None:
        self._odometry = Track()
        self._estimates = Track()
        self._covariances = array("d")
        run.board.subscribe(run.board.key(ODOM_FROM_ROBOT), self._note_odometry)
        run.board.subscribe(run.board.key(POSE_ESTIMATE), self._note_estimate)

    def odometry(self) -> Trajectory:
        """Return where odometry alone put the robot, the frames agreeing at the start."""
        return self._odometry.rows()

    def estimates(self) -> tuple[Trajectory, npt.NDArray[np.float64]]:
        """Return the estimates, (n, 4), with their covariances, (n, 3, 3); of several with one stamp the last."""
        rows = self._estimates.rows()
        upper = np.array(self._covariances, dtype=np.float64).reshape(-1, 6)
        covariances = upper[:, [[0, 1, 2], [1, 3, 4], [2, 4, 5]]]
        last = {stamp_s: number for number, stamp_s in enumerate(rows[:, 0].tolist())}
        chosen = sorted(last.values())
        return rows[chosen], covariances[chosen]

    def nees(self, truth: Trajectory) -> npt.NDArray[np.float64]:
        """Return the NEES of each estimate that the truth covers, (n,)."""
        estimates, covariances = self.estimates()
        covered = (estimates[:, 0] >= truth[0, 0]) & (estimates[:, 0] <= truth[-1, 0])
        return nees(pose_errors(estimates, truth), covariances[covered])

    def _note_odometry(self, entry: Entry[Pose]) -> None:
        self._odometry.add(entry.stamp_s, entry.value)

    def _note_estimate(self, entry: Entry[PoseEstimate]) -> None:
        self._estimates.add(entry.stamp_s, entry.value.map_from_robot)
        self._covariances.extend(entry.value.covariance)
