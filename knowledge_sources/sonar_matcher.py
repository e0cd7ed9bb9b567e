"""Holds the robot's pose in the map by matching its newest sonar echoes to patches of a grid of the older ones.

Triggered by  observations/signal/sonar_scan             SonarScan
Reads         status/robot, observations/feature/odom_from_robot
Posts         hypotheses/feature/map_from_odom           Pose: the identity at first, then a revision for each match
              hypotheses/feature/pose_estimate           PoseEstimate: with each match

A match whose jump is larger than its own uncertainty is refused, and endorsed against the standing map_from_odom. Scan to grid
with a forward model of the cone, instead of the line matching of Bou-Ghannam 1992, section 5.2.4; the parts and their sources
are in `knowledge_sources/sonar_matching/`.
"""

from collections import deque
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry, stretches
from blackboard.kinds import MAP_FROM_ODOM, ODOM_FROM_ROBOT, POSE_ESTIMATE, ROBOT, SONAR_SCAN
from blackboard.messages.geometry import IDENTITY, Pose, wrap_angle
from blackboard.messages.model import PoseEstimate
from blackboard.messages.sensing import SonarScan
from knowledge_sources.poses import odom_from_robot_at
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.tracker import Tracker
from knowledge_sources.sonar_matching.window import Told

SPEED_OVER_S = 0.2  # a speed is taken over the last poses of common odometry


class SonarMatcher(KnowledgeSource[SonarMatcherParams]):
    """Posts where odometry stands in the map. A scan of which no odometry is known is passed over."""

    Params = SonarMatcherParams
    triggers = (SONAR_SCAN,)
    reads = (ROBOT, ODOM_FROM_ROBOT)
    posts = (MAP_FROM_ODOM, POSE_ESTIMATE)
    rating = 60.0  # before the grid on the board, which then takes the scan at the corrected pose
    work = 5

    def __init__(self, params: SonarMatcherParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self.tracker = Tracker(params)
        self._window: deque[tuple[Entry[Any], ...]] = deque(maxlen=params.window_scans)
        self._refusing = False

    def activate(self, trigger: Entry[SonarScan], board: Access) -> None:
        robot = board.newest(ROBOT)
        odometry = odom_from_robot_at(board, trigger.stamp_s)
        if robot is None or odometry is None:
            return
        odom_from_robot, poses = odometry
        standing = board.newest(MAP_FROM_ODOM)
        if standing is None:
            standing = board.post(MAP_FROM_ODOM, IDENTITY, supports=[trigger, *poses], stamp_s=trigger.stamp_s)
        told = Told(odom_from_robot, _speed(odom_from_robot, trigger.stamp_s, board))
        outcome = self.tracker.take(trigger.value, told, robot.value)
        if outcome.kept:
            self._window.append((trigger, *poses))
        if outcome.map_from_odom is not None:
            supports = stretches(entry for entries in self._window for entry in entries)
            posted = board.post(
                MAP_FROM_ODOM, outcome.map_from_odom, supports=[*supports, standing], stamp_s=trigger.stamp_s
            )
            self._refusing = False
            pose, covariance = self.tracker.pose()
            upper = tuple(float(number) for number in covariance[np.triu_indices(3)])
            estimate = PoseEstimate(map_from_robot=pose, covariance=upper)
            board.post(POSE_ESTIMATE, estimate, supports=[posted, *poses], stamp_s=trigger.stamp_s)
        elif outcome.refused and not self._refusing:
            board.endorse(standing, "against", outcome.refused)
            self._refusing = True


def _speed(odom_from_robot: Pose, stamp_s: float, board: Access) -> Pose:
    """Return m and rad a second, robot frame; none where odometry does not reach back far enough."""
    before = odom_from_robot_at(board, stamp_s - SPEED_OVER_S)
    if before is None:
        return IDENTITY
    way = before[0].inverse() @ odom_from_robot
    return Pose(
        x_m=way.x_m / SPEED_OVER_S,
        y_m=way.y_m / SPEED_OVER_S,
        heading_rad=wrap_angle(way.heading_rad / SPEED_OVER_S),
    )
