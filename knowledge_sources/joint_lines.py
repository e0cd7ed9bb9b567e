"""Pose and lines in one estimate: every echo of a known line moves the pose, and with it all that was seen from there.

Triggered by  observations/signal/sonar_scan            SonarScan: echoes of known lines move the pose, and the lines
              observations/signal/laser_scan            LaserScan: some of its beams do
              observations/feature/line_set             LineSet: what matches is longer now, what does not is a hypothesis
Reads         status/robot, observations/feature/odom_from_robot, observations/feature/line,
              observations/feature/supported_points, hypotheses/feature/expected_lines
Posts         hypotheses/feature/map_from_odom          Pose
              hypotheses/feature/pose_estimate          PoseEstimate
              hypotheses/feature/re_reference           ReReference
              hypotheses/feature/model_line/<n>         ModelLine
              hypotheses/symbol/new_area_visited/<n>    NewAreaVisited: confirmed, it becomes model line <n>
              hypotheses/symbol/verdict/new_area_visited.*  Verdict
              hypotheses/symbol/pose_conflict/<n>       PoseConflict: echoes of a scan that were refused, and why

Source: Bou-Ghannam 1992, section 5.2.4, with the correlations that its equations leave out (Smith, Self and Cheeseman 1990), and
with echoes in the place of fitted lines where a line is known (Leonard and Durrant-Whyte 1992). Set `post_map_from_odom = false`
for the odometry pose, and leave re-reference and match/merge out: this source does the work of both.
"""

from math import inf, isfinite
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry
from blackboard.kinds import (
    EXPECTED_LINES,
    LASER_SCAN,
    LINE,
    LINE_SET,
    MAP_FROM_ODOM,
    MODEL_LINE,
    NEW_AREA_VISITED,
    ODOM_FROM_ROBOT,
    POSE_CONFLICT,
    POSE_ESTIMATE,
    RE_REFERENCE,
    ROBOT,
    SONAR_SCAN,
    SUPPORTED_POINTS,
    VERDICT,
)
from blackboard.messages.geometry import IDENTITY, Point, Pose, wrap_angle
from blackboard.messages.model import PoseConflict, PoseEstimate, ReReference
from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan
from blackboard.uncertainty.chi_square import chi_square_quantile
from blackboard.uncertainty.normal_distance import normal_distance
from knowledge_sources.joint_estimate.association import associate
from knowledge_sources.joint_estimate.correction import Corrector, Verdict
from knowledge_sources.joint_estimate.echo_model import Cones
from knowledge_sources.joint_estimate.line_keeping import LineKeeper
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import LATENCY, JointState
from knowledge_sources.joint_estimate.window import Look, Window
from knowledge_sources.observed_lines import observed_line
from knowledge_sources.poses import moved_on, odom_from_robot_at
from knowledge_sources.re_reference import upper
from knowledge_sources.sensors import laser_of, sonar_of

AROUND_S = 0.1  # before and after an instant, to tell the speed


class JointLines(KnowledgeSource[JointLinesParams]):
    """Keeps the pose, the wheels' errors and all lines in one estimate."""

    Params = JointLinesParams
    triggers = (SONAR_SCAN, LASER_SCAN, LINE_SET)
    reads = (ROBOT, ODOM_FROM_ROBOT, LINE, SUPPORTED_POINTS, EXPECTED_LINES)
    posts = (MAP_FROM_ODOM, POSE_ESTIMATE, RE_REFERENCE, MODEL_LINE, NEW_AREA_VISITED, VERDICT, POSE_CONFLICT)
    rating = 60.0  # before the grid takes the scan in
    work = 3

    def __init__(self, params: JointLinesParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._state: JointState | None = None
        self._odometry = IDENTITY  # odom_from_robot that the state's pose belongs to
        self._at_s = -inf
        self._counted_at: dict[tuple[str, int], Pose] = {}
        self._window = Window()
        self._keeper = LineKeeper(params, self._window)
        self._corrector = Corrector(params)
        self._remembered_at: Pose | None = None
        self._refused = 0
        self._stamp_s = -inf  # of the newest correction

    def resume(self, state: object, board: Access) -> None:
        """Go on; without a state, from the pose and the lines that stand, as if they had nothing in common."""
        super().resume(state, board)
        self._refused = max(self._refused, board.last_number(POSE_CONFLICT))
        for newest in (board.newest(MAP_FROM_ODOM), board.newest(RE_REFERENCE)):
            self._stamp_s = max(self._stamp_s, -inf if newest is None else newest.stamp_s)
        odometry, correction = board.newest(ODOM_FROM_ROBOT), board.newest(MAP_FROM_ODOM)
        if self._state is None and odometry is not None and correction is not None:
            self._odometry, self._at_s = odometry.value, odometry.stamp_s
            self._state = JointState(correction.value @ odometry.value, self.params)
            estimate = board.newest(POSE_ESTIMATE)
            if estimate is not None:
                self._state.trust_pose(estimate.value.covariance)
        if self._state is not None:
            self._keeper.resume(self._state, board)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        if isinstance(trigger.value, SonarScan | LaserScan):
            self._hear(trigger, board)
        elif self._state is not None:
            lines = [entry for id_ in trigger.value.lines if (entry := board.newest(LINE, id_)) is not None]
            seen = [observed_line(entry, board, self.params.floor) for entry in lines]
            before, prior = self._state.pose, self._state.pose_covariance
            self._keeper.take_in(self._state, seen, trigger, board)
            if self._state.pose != before:
                change = np.array(_change(before, self._state.pose))
                distance, bound = (
                    normal_distance(change, prior),
                    chi_square_quantile(self.params.confidence, len(change)),
                )
                self._stamp_s = max(self._stamp_s, trigger.stamp_s)
                value = _re_reference(
                    trigger.value.batch, before, self._state.pose, distance, bound, trigger.value.lines
                )
                board.post(RE_REFERENCE, value, supports=[trigger, *lines], stamp_s=self._stamp_s)
                self._move(self._state, [trigger, *lines], board)

    def _hear(self, trigger: Entry[Any], board: Access) -> None:
        robot = board.newest(ROBOT)
        late_s = self._state.mean[LATENCY] if self._state is not None and isinstance(trigger.value, SonarScan) else 0.0
        found = odom_from_robot_at(board, trigger.stamp_s - float(late_s))
        if robot is None or found is None:
            return
        odometry, supports = found
        if self._state is None:
            self._state = JointState(odometry, self.params)
            board.post(MAP_FROM_ODOM, IDENTITY, supports=[trigger, *supports], stamp_s=trigger.stamp_s)
        state = self._state
        step = self._odometry.inverse() @ odometry if isfinite(self._at_s) else IDENTITY
        state.drive(step)
        self._corrector.wheels.drive(step)
        self._odometry, self._at_s = odometry, trigger.stamp_s - float(late_s)
        cones, ranges = self._cones(trigger.value, robot.value, odometry)
        motion = self._motion(state, board) if isinstance(trigger.value, SonarScan) else (0.0, 0.0, 0.0)
        if abs(motion[2]) <= self.params.max_turn_radps:
            unexplained = np.ones(len(ranges), dtype=np.bool_)
            if state.lines and len(ranges):
                paired = associate(state, cones, ranges, motion, self.params)
                unexplained[paired.cone] = False
                if len(paired.cone):
                    before = state.pose
                    verdict = self._corrector.correct(state, paired)
                    self._tell(state, before, verdict, trigger, supports, board)
            params = self.params
            if len(ranges) and moved_on(self._remembered_at, odometry, params.remember_m, params.remember_rad):
                self._remembered_at = odometry
                look = Look(cones=cones, ranges_m=ranges, motion=motion, open=unexplained)
                self._corrector.wheels.begin(state, self._window.add(state, look))
        self._post_estimate(state, trigger, supports, board)

    def _tell(
        self,
        state: JointState,
        before: Pose,
        verdict: Verdict,
        trigger: Entry[Any],
        supports: tuple[Entry[Pose], ...],
        board: Access,
    ) -> None:
        applied, distance, bound = not verdict.refused, verdict.distance, verdict.bound
        self._stamp_s = max(self._stamp_s, trigger.stamp_s)
        lines = tuple(state.lines[i].id for i in sorted(set(verdict.paired.line.tolist())))
        value = _re_reference(trigger.revision, before, state.pose, distance, bound, lines, applied=applied)
        known = [entry for id_ in lines if (entry := board.newest(MODEL_LINE, id_)) is not None]
        board.post(RE_REFERENCE, value, supports=[trigger, *supports, *known], stamp_s=self._stamp_s)
        if applied:
            self._move(state, [trigger, *supports, *known], board)
            return
        self._refused += 1
        conflict = PoseConflict(refused=value, why=verdict.refused)
        board.post(
            POSE_CONFLICT,
            conflict,
            id=str(self._refused),
            supports=[trigger, *supports, *known],
            stamp_s=self._stamp_s,
        )

    def _move(self, state: JointState, supports: list[Entry[Any]], board: Access) -> None:
        map_from_odom = state.pose @ self._odometry.inverse()
        board.post(MAP_FROM_ODOM, map_from_odom, supports=supports, stamp_s=self._stamp_s)

    def _post_estimate(
        self, state: JointState, trigger: Entry[Any], supports: tuple[Entry[Pose], ...], board: Access
    ) -> None:
        value = PoseEstimate(map_from_robot=state.pose, covariance=upper(state.pose_covariance))
        standing = board.newest(POSE_ESTIMATE)  # of a sonar that is later than the laser before it, time stands still
        at_s = self._at_s if standing is None else max(self._at_s, standing.stamp_s)
        board.post(POSE_ESTIMATE, value, supports=[trigger, *supports], stamp_s=at_s)

    def _motion(self, state: JointState, board: Access) -> tuple[float, float, float]:
        """Return the speed of map_from_robot about the instant of the state, from odometry."""
        before = odom_from_robot_at(board, self._at_s - AROUND_S)
        after = odom_from_robot_at(board, self._at_s + AROUND_S)
        if before is None or after is None:
            return 0.0, 0.0, 0.0
        step = before[0].inverse() @ after[0]
        dx, dy = step.x_m / (2.0 * AROUND_S), step.y_m / (2.0 * AROUND_S)
        c, s = np.cos(state.pose.heading_rad), np.sin(state.pose.heading_rad)
        return float(c * dx - s * dy), float(s * dx + c * dy), step.heading_rad / (2.0 * AROUND_S)

    def _cones(
        self, scan: SonarScan | LaserScan, robot: RobotDescription, odometry: Pose
    ) -> tuple[Cones, np.ndarray[Any, Any]]:
        """Return the sensors that heard something and have moved since they last counted, and what they heard."""
        rows: list[tuple[float, float, float, float, float]] = []
        most = self.params.max_range_m
        if isinstance(scan, SonarScan):
            for number, range_m in zip(scan.sensors, scan.ranges_m, strict=True):
                if range_m is None or range_m > most or not self._moved(("sonar", number), odometry):
                    continue
                sonar = sonar_of(robot, number)
                mount = sonar.mount
                rows.append((mount.x_m, mount.y_m, mount.heading_rad, sonar.cone_rad / 2.0, range_m))
        elif self._moved(("laser", scan.laser), odometry):
            mount = laser_of(robot, scan.laser).mount
            count = len(scan.ranges_m)
            for i in np.unique(np.linspace(0, count - 1, min(self.params.beams, count)).astype(int)).tolist():
                range_m = scan.ranges_m[i]
                if range_m is not None and range_m <= most:
                    bearing = mount.heading_rad + scan.angle_min_rad + i * scan.angle_step_rad
                    rows.append((mount.x_m, mount.y_m, bearing, 0.0, range_m))
        columns = np.array(rows).reshape(len(rows), 5).T
        cones = Cones(x_m=columns[0], y_m=columns[1], bearing_rad=columns[2], half_rad=columns[3])
        return cones, columns[4]

    def _moved(self, sensor: tuple[str, int], pose: Pose) -> bool:
        moved = moved_on(self._counted_at.get(sensor), pose, self.params.step_m, self.params.step_rad)
        if moved:
            self._counted_at[sensor] = pose
        return moved


def _change(before: Pose, after: Pose) -> tuple[float, float, float]:
    return after.x_m - before.x_m, after.y_m - before.y_m, wrap_angle(after.heading_rad - before.heading_rad)


def _re_reference(
    batch: int,
    before: Pose,
    after: Pose,
    distance: float,
    bound: float,
    lines: tuple[str, ...],
    *,
    applied: bool = True,
) -> ReReference:
    """Return how far a correction moved the pose; `batch` is the scan's revision, or the batch of a set of lines."""
    x_m, y_m, turn_rad = _change(before, after)
    return ReReference(
        batch=batch,
        applied=applied,
        centre=Point(x_m=before.x_m, y_m=before.y_m),
        shift=Point(x_m=x_m, y_m=y_m),
        turn_rad=turn_rad,
        normal_distance=distance,
        bound=bound,
        lines=lines,
    )
