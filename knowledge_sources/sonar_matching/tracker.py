"""Scan by scan: predict by odometry, match the window to the grid, and let the grid have what leaves the window."""

from dataclasses import dataclass
from math import hypot

import numpy as np

from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import RobotDescription, SonarScan
from blackboard.uncertainty.chi_square import chi_square_quantile
from knowledge_sources.eou_grid import EvidenceGrid
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.sonar_matching import pose_filter
from knowledge_sources.sonar_matching.matcher import Match, match, surprise
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.pose_filter import Estimate
from knowledge_sources.sonar_matching.window import Kept, heard, poses_back


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a scan: the map_from_odom that a match asks for, or why a match was refused."""

    kept: bool = False  # it went into the window
    map_from_odom: Pose | None = None
    refused: str = ""


class Tracker:
    """A window of scans, the grid of all older ones, and the pose between them. The map begins at the odometry's own frame."""

    def __init__(self, params: SonarMatcherParams) -> None:
        self._params = params
        self.grid = EvidenceGrid(EouGridParams(cell_m=params.cell_m, sonar_range_m=params.reach_m))
        self.estimate: Estimate | None = None
        self._odom_from_robot: Pose | None = None  # at the newest scan kept
        self._window: list[Kept] = []
        self._scans = 0
        self._farthest = chi_square_quantile(params.trust_probability, 3)
        # each scan takes part in several matches, and stands for its neighbours that take part in none
        self._weight = params.independence * params.match_every_scans * params.used_every_scans / params.window_scans

    def take(self, scan: SonarScan, odom_from_robot: Pose, robot: RobotDescription) -> Outcome:
        """Take the next scan; raise BoardError for a sonar that the robot lacks."""
        params = self._params
        if self.estimate is None or self._odom_from_robot is None:
            self.estimate = pose_filter.start(odom_from_robot, params)
            step = Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)
        else:
            step = self._odom_from_robot.inverse() @ odom_from_robot
            if hypot(step.x_m, step.y_m) < params.least_way_m and abs(step.heading_rad) < params.least_turn_rad:
                return Outcome()
            self.estimate = pose_filter.predict(self.estimate, step, params)
        self._odom_from_robot = odom_from_robot
        self._window.append(Kept(scan, step))
        self._scans += 1
        if self._scans <= params.window_scans:  # the first window is the map to begin with
            self.grid.fold(scan, robot, self.estimate.map_from_robot)
            return Outcome(kept=True)
        outcome = Outcome(kept=True)
        if self._scans % params.match_every_scans == 0:
            outcome = self._match(self.estimate, odom_from_robot, robot)
        self._let_go(robot)
        return outcome

    def _match(self, estimate: Estimate, odom_from_robot: Pose, robot: RobotDescription) -> Outcome:
        params = self._params
        newest_from_robot = poses_back(self._window, estimate.errors)
        used = slice((len(self._window) - 1) % params.used_every_scans, None, params.used_every_scans)
        echoes = heard([kept.scan for kept in self._window[used]], newest_from_robot[used], robot, params.reach_m)
        prior = estimate.covariance[:3, :3]
        found = match(self.grid.grid, echoes, estimate.map_from_robot, prior, self._weight, params)
        if found is None:
            return Outcome(kept=True)
        if surprise(found, prior) > self._farthest:
            return Outcome(kept=True, refused=_said(found))
        self.estimate = pose_filter.update(estimate, found.shift, found.information)
        return Outcome(kept=True, map_from_odom=self.estimate.map_from_robot @ odom_from_robot.inverse())

    def _let_go(self, robot: RobotDescription) -> None:
        """Fold the oldest scan into the grid, where the newest pose says that it was taken."""
        if self.estimate is None or len(self._window) <= self._params.window_scans:
            return
        if self._scans - len(self._window) >= self._params.window_scans:  # it was not of the first window
            newest_from_oldest = poses_back(self._window, self.estimate.errors)[0]
            self.grid.fold(self._window[0].scan, robot, self.estimate.map_from_robot @ newest_from_oldest)
        del self._window[0]


def _said(found: Match) -> str:
    x_m, y_m, turn_rad = (float(v) for v in found.shift)
    return (
        f"{found.echoes} echoes ask for a jump of {hypot(x_m, y_m):.2f} m and {np.degrees(wrap_angle(turn_rad)):.1f} degrees,"
        " more than the pose is uncertain by"
    )
