"""Scan by scan: predict by odometry, match the window to patches of the map, and let the map have what leaves the window."""

from dataclasses import dataclass
from math import cos, hypot, sin

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import RobotDescription, SonarScan
from blackboard.uncertainty.chi_square import chi_square_quantile
from knowledge_sources.sonar_matching import joint_filter
from knowledge_sources.sonar_matching.joint_filter import Estimate
from knowledge_sources.sonar_matching.matcher import Match, match, surprise
from knowledge_sources.sonar_matching.params import SonarMatcherParams
from knowledge_sources.sonar_matching.patches import Patches
from knowledge_sources.sonar_matching.window import Kept, Told, heard, poses_back, when_heard

Floats = npt.NDArray[np.float64]

CLOSE_M, CLOSE_RAD = 0.15, 0.05  # a patch known better than this from here may take scans: a wall's band stays narrow
STAY_M = 0.5  # another patch must be nearer by so much to take over
MATCHED_M = 2.0  # times patch_m: patches further off hold little of what is heard


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a scan: the map_from_odom that a match asks for, or why a match was refused."""

    kept: bool = False  # it went into the window
    map_from_odom: Pose | None = None
    refused: str = ""


class Tracker:
    """A window of scans, patches of all older ones, and the poses of all. The map begins at the odometry's own frame."""

    def __init__(self, params: SonarMatcherParams) -> None:
        self._params = params
        self.patches = Patches(params)
        self.estimate: Estimate | None = None
        self._told: Told | None = None  # at the newest scan kept
        self._window: list[Kept] = []
        self._scans = 0
        self._active = 0  # the patch that takes scans
        self._farthest = chi_square_quantile(params.trust_probability, 3)
        # each scan takes part in several matches, and stands for its neighbours that take part in none
        self._weight = params.independence * params.match_every_scans * params.used_every_scans / params.window_scans

    def take(self, scan: SonarScan, told: Told, robot: RobotDescription) -> Outcome:
        """Take the next scan; raise BoardError for a sonar that the robot lacks."""
        params = self._params
        if self.estimate is None or self._told is None:
            self.estimate = joint_filter.with_patch(joint_filter.start(told.odom_from_robot, params))
            self.patches.add()
            self._told = told
        else:
            step = self._told.odom_from_robot.inverse() @ told.odom_from_robot
            if hypot(step.x_m, step.y_m) < params.least_way_m and abs(step.heading_rad) < params.least_turn_rad:
                return Outcome()
            self.estimate = joint_filter.predict(self.estimate, self._told, told, params)
        self._window.append(Kept(scan, told, self._told))
        self._told = told
        self._scans += 1
        if self._scans <= params.window_scans:  # the first window is the map to begin with
            self.patches.fold(0, scan, robot, joint_filter.in_patch(self.estimate, 0)[0])
            return Outcome(kept=True)
        self._choose_patch(self.estimate)
        outcome = Outcome(kept=True)
        if self._scans % params.match_every_scans == 0:
            outcome = self._match(robot)
        self._let_go(robot)
        return outcome

    def pose(self) -> tuple[Pose, Floats]:
        """Return where the robot is at the newest stamp, which may be later than its scan, and the covariance (3, 3)."""
        assert self.estimate is not None
        assert self._told is not None
        latency_s = float(self.estimate.errors[3])
        pose = self.estimate.map_from_robot @ when_heard(self._told, latency_s).inverse() @ self._told.odom_from_robot
        speed = self._told.speed
        c, s = cos(pose.heading_rad), sin(pose.heading_rad)
        way = np.array([c * speed.x_m - s * speed.y_m, s * speed.x_m + c * speed.y_m, speed.heading_rad])
        change = np.hstack([np.eye(3), np.zeros((3, 3)), way[:, None]])
        size = joint_filter.PATCHES
        covariance = change @ self.estimate.covariance[:size, :size] @ change.T
        return pose, (covariance + covariance.T) / 2.0

    def _choose_patch(self, estimate: Estimate) -> None:
        """Let the nearest patch whose place is well known from here take the scans, a new one where there is none."""
        params = self._params
        robot = estimate.map_from_robot
        nearest, least_m = -1, params.patch_m
        for patch in range(estimate.patches):
            far_m = estimate.map_from_patch(patch).distance_m(robot) - (STAY_M if patch == self._active else 0.0)
            if far_m < least_m:
                _, covariance, _ = joint_filter.in_patch(estimate, patch)
                if covariance[0, 0] + covariance[1, 1] < CLOSE_M**2 and covariance[2, 2] < CLOSE_RAD**2:
                    nearest, least_m = patch, far_m
        if nearest >= 0:
            self._active = nearest
            return
        newest = estimate.patches - 1
        if self._active != newest or estimate.map_from_patch(newest).distance_m(robot) >= params.patch_m:
            self._active = self.patches.add()
            self.estimate = joint_filter.with_patch(estimate)

    def _match(self, robot: RobotDescription) -> Outcome:
        params = self._params
        assert self.estimate is not None
        newest_from_robot = poses_back(self._window, self.estimate.errors)
        used = slice((len(self._window) - 1) % params.used_every_scans, None, params.used_every_scans)
        echoes = heard([kept.scan for kept in self._window[used]], newest_from_robot[used], robot, params.reach_m)
        matched, refused = False, ""
        near = self._near(self.estimate)[: params.match_patches]
        for patch in near:
            where, prior, _ = joint_filter.in_patch(self.estimate, patch)
            found = match(self.patches.grids[patch], echoes, where, prior, self._weight / len(near), params)
            if found is None:
                continue
            if found.fitting < params.least_fit or surprise(found, prior) > self._farthest:
                refused = refused or _said(found, params)
                continue
            floor = np.diag([params.floor_m, params.floor_m, params.floor_rad]) ** 2
            information = np.linalg.inv(np.eye(3) + found.information @ floor) @ found.information
            self.estimate = joint_filter.update(self.estimate, patch, found.shift, (information + information.T) / 2.0)
            matched = True
        if not matched:
            return Outcome(kept=True, refused=refused)
        assert self._told is not None
        return Outcome(kept=True, map_from_odom=self.pose()[0] @ self._told.odom_from_robot.inverse())

    def _near(self, estimate: Estimate) -> list[int]:
        """Return the patches that may hold what is heard, the nearest first."""
        robot = estimate.map_from_robot
        far_m = [estimate.map_from_patch(patch).distance_m(robot) for patch in range(estimate.patches)]
        order = sorted(range(len(far_m)), key=far_m.__getitem__)
        return [patch for patch in order if far_m[patch] < MATCHED_M * self._params.patch_m]

    def _let_go(self, robot: RobotDescription) -> None:
        """Fold the oldest scan into the active patch, where the newest pose says that it was taken."""
        if self.estimate is None or len(self._window) <= self._params.window_scans:
            return
        newest_from_oldest = poses_back(self._window, self.estimate.errors)[0]
        patch_from_robot = joint_filter.in_patch(self.estimate, self._active)[0] @ newest_from_oldest
        oldest = self._window[0]
        if self._scans - len(self._window) >= self._params.window_scans:  # it was not of the first window
            self.patches.fold(self._active, oldest.scan, robot, patch_from_robot)
        del self._window[0]


def _said(found: Match, params: SonarMatcherParams) -> str:
    if found.fitting < params.least_fit:
        return f"of {found.echoes} echoes only {found.fitting:.0%} fit the map: no match"
    x_m, y_m, turn_rad = (float(v) for v in found.shift)
    return (
        f"{found.echoes} echoes ask for a jump of {hypot(x_m, y_m):.2f} m and {np.degrees(wrap_angle(turn_rad)):.1f} degrees,"
        " more than the pose is uncertain by"
    )
