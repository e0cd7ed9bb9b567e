"""The robot finds its place again by the lines that it knows (Bou-Ghannam 1992, section 5.2.4.2).

Triggered by  observations/feature/line_set        LineSet: how unsure the pose is by now
              hypotheses/feature/line_matches      LineMatches: the correction
Reads         observations/feature/odom_from_robot
Posts         hypotheses/feature/pose_estimate     PoseEstimate: before and after the correction
              hypotheses/feature/re_reference      ReReference: the correction and its size, applied or refused
              hypotheses/feature/map_from_odom     Pose: where it is applied
              hypotheses/symbol/pose_conflict/<batch>  PoseConflict: where it is refused

Set `post_map_from_odom = false` for the odometry pose, since this source owns it. The functions are in `pose_correction`
and `odometry_uncertainty`.
"""

from dataclasses import dataclass, field
from math import radians
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry, Support
from blackboard.kinds import (
    LINE_MATCHES,
    LINE_SET,
    MAP_FROM_ODOM,
    ODOM_FROM_ROBOT,
    POSE_CONFLICT,
    POSE_ESTIMATE,
    RE_REFERENCE,
)
from blackboard.messages.geometry import IDENTITY, Point, Pose, wrap_angle
from blackboard.messages.model import LineMatches, PoseConflict, PoseEstimate, ReReference
from blackboard.parameters import require
from blackboard.uncertainty.matrices import Array
from knowledge_sources.odometry_uncertainty import OdometryNoise, Unsureness, carried_on, way_of
from knowledge_sources.pose_correction import Correction, correct, least_sigmas, stretch_to
from knowledge_sources.poses import READS, map_from_robot_at

START_SIGMAS = np.array(
    [1e-3, 1e-3, radians(0.05)]
)  # the map is where the robot starts; a covariance must not be singular


@dataclass(frozen=True, slots=True, kw_only=True)
class ReReferenceParams:
    """How much odometry is trusted, and what a correction must show for itself."""

    distance_fraction: float = OdometryNoise().distance_fraction
    heading_rad_per_m: float = OdometryNoise().heading_rad_per_m
    heading_fraction: float = OdometryNoise().heading_fraction
    heading_noise_rad: float = OdometryNoise().heading_noise_rad
    outlier_sigmas: float = 2.5  # a line that the others leave further out is another wall
    least_information: float = 0.1  # of odometry's: below it lines say nothing of a direction worth moving for
    confidence: float = 0.999  # a jump beyond this bound is refused
    noise: OdometryNoise = field(init=False)

    def __post_init__(self) -> None:
        require(self.outlier_sigmas > 0.0, "outlier_sigmas", self.outlier_sigmas, "more than 0")
        require(self.least_information >= 0.0, "least_information", self.least_information, "0 and more")
        require(0.5 <= self.confidence < 1.0, "confidence", self.confidence, "[0.5, 1)")
        noise = OdometryNoise(
            distance_fraction=self.distance_fraction,
            heading_rad_per_m=self.heading_rad_per_m,
            heading_fraction=self.heading_fraction,
            heading_noise_rad=self.heading_noise_rad,
        )
        object.__setattr__(self, "noise", noise)


class ReReferencer(KnowledgeSource[ReReferenceParams]):
    """Moves the odometry frame in the map by what matched lines say, and keeps the pose's covariance."""

    Params = ReReferenceParams
    triggers = (LINE_SET, LINE_MATCHES)
    reads = READS
    posts = (POSE_ESTIMATE, RE_REFERENCE, MAP_FROM_ODOM, POSE_CONFLICT)
    rating = 9.0  # before the lines are matched, which needs the pose's covariance

    def __init__(self, params: ReReferenceParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._pose: Pose | None = None  # map_from_robot at the last batch
        self._covariance = np.diag(START_SIGMAS**2)
        self._shared = np.zeros((3, 3))
        self._odometry: Entry[Pose] | None = None  # the newest pose that the covariance covers

    def resume(self, state: object, board: Access) -> None:
        """Go on; without a state, from the estimate that stands, as if the robot had not driven since."""
        super().resume(state, board)
        estimate, newest = board.newest(POSE_ESTIMATE), board.newest(ODOM_FROM_ROBOT)
        if self._pose is None and estimate is not None and newest is not None:
            self._pose, self._odometry = estimate.value.map_from_robot, newest
            self._covariance[np.triu_indices(3)] = estimate.value.covariance
            self._covariance = self._covariance + np.triu(self._covariance, 1).T

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        found = map_from_robot_at(board, trigger.stamp_s)
        if found is None:
            return
        pose, supports = found
        if isinstance(trigger.value, LineMatches):
            self._correct(trigger, pose, supports, board)
        else:
            self._carry_on(pose, board)
            self._post_estimate(trigger, pose, supports, board)

    def _carry_on(self, pose: Pose, board: Access) -> None:
        newest = board.newest(ODOM_FROM_ROBOT)
        if newest is None:
            return
        first = newest.revision if self._odometry is None else self._odometry.revision
        driven = board.revisions(Support(newest.key, 1 if self._odometry is None else first, newest.revision))
        if self._odometry is not None and (not driven or driven[0].revision > first):
            driven = [self._odometry, *driven]  # what lies between is forgotten, after a restart
        way = way_of(entry.value for entry in driven)
        before = self._pose if self._pose is not None else driven[0].value
        known = carried_on(Unsureness(pose=self._covariance, shared=self._shared), before, pose, way, self.params.noise)
        self._covariance, self._shared = known.pose, known.shared
        self._pose, self._odometry = pose, newest

    def _correct(
        self, trigger: Entry[LineMatches], pose: Pose, supports: tuple[Entry[Pose], ...], board: Access
    ) -> None:
        matches, prior, params = trigger.value.matches, self._covariance, self.params
        found = correct(
            matches,
            pose.x_m,
            pose.y_m,
            prior,
            outlier_sigmas=params.outlier_sigmas,
            least_information=params.least_information,
            confidence=params.confidence,
        )
        used = [matches[i] for i in found.used]
        value = ReReference(
            batch=trigger.value.batch,
            applied=found.allowed,
            centre=Point(x_m=pose.x_m, y_m=pose.y_m),
            shift=Point(x_m=found.shift_x_m, y_m=found.shift_y_m),
            turn_rad=found.turn_rad,
            normal_distance=found.distance,
            bound=found.bound,
            lines=tuple(match.observed for match in used),
        )
        if found.allowed and used:
            stretch = stretch_to(found.covariance, prior, least_sigmas(used))
            self._covariance = found.covariance * np.outer(stretch, stretch)
            self._shared = stretch[:, None] * (found.kept @ self._shared)
            self._move(trigger, moved(pose, found), supports, board)
        if not found.allowed:
            why = (
                f"{len(used)} lines ask for a jump of ({found.shift_x_m:.2f}, {found.shift_y_m:.2f}) m and "
                f"{np.degrees(found.turn_rad):.1f} degrees: normal distance {found.distance:.1f}, bound {found.bound:.1f}"
            )
            conflict = PoseConflict(refused=value, why=why)
            board.post(
                POSE_CONFLICT, conflict, id=str(value.batch), supports=[trigger, *supports], stamp_s=trigger.stamp_s
            )
        board.post(RE_REFERENCE, value, supports=[trigger, *supports], stamp_s=trigger.stamp_s)

    def _move(self, trigger: Entry[Any], pose: Pose, supports: tuple[Entry[Pose], ...], board: Access) -> None:
        standing = board.newest(MAP_FROM_ODOM)
        map_from_odom = standing.value if standing is not None else IDENTITY
        assert self._pose is not None  # the batch's line set has set it
        corrected = pose @ self._pose.inverse() @ map_from_odom
        board.post(MAP_FROM_ODOM, corrected, supports=[trigger, *supports], stamp_s=trigger.stamp_s)
        self._pose = pose
        self._post_estimate(trigger, pose, supports, board)

    def _post_estimate(self, trigger: Entry[Any], pose: Pose, supports: tuple[Entry[Pose], ...], board: Access) -> None:
        value = PoseEstimate(map_from_robot=pose, covariance=upper(self._covariance))
        board.post(POSE_ESTIMATE, value, supports=[trigger, *supports], stamp_s=trigger.stamp_s)


def moved(pose: Pose, correction: Correction) -> Pose:
    """Return the corrected pose."""
    return Pose(
        x_m=pose.x_m + correction.shift_x_m,
        y_m=pose.y_m + correction.shift_y_m,
        heading_rad=wrap_angle(pose.heading_rad + correction.turn_rad),
    )


def upper(covariance: Array) -> tuple[float, ...]:
    """Return the six numbers of a symmetric (3, 3) matrix, row by row from the diagonal."""
    return tuple(float(covariance[i, j]) for i in range(3) for j in range(i, 3))
