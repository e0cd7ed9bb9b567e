"""Holds the pose by matching laser scans, and straightens the whole way at the end.

Triggered by  observations/feature/odom_from_robot  Pose
              observations/signal/laser_scan        LaserScan
              observations/signal/sonar_scan        SonarScan: of a robot without a laser, such as one thinned to cones
Reads         status/robot
Posts         hypotheses/feature/map_from_odom      Pose: at each keyframe, matched to the last ones (a laser only)
              hypotheses/feature/corrected_path     CorrectedPath: at the end, loops closed; endorsed for or against
              hypotheses/feature/grid/<tile>        GridTile: at the end, folded along that path
              observations/feature/supported_points PointSet: at the end, all that was seen along that path, for a line finder

Cones say too little to be matched one by one: with them the pose is odometry's until the end.

Source: scan matching (Olson 2009; Censi 2008), a graph of poses (Grisetti et al. 2010).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry, Support
from blackboard.grid import tile_id
from blackboard.kinds import (
    CORRECTED_PATH,
    GRID,
    LASER_SCAN,
    MAP_FROM_ODOM,
    ODOM_FROM_ROBOT,
    ROBOT,
    SONAR_SCAN,
    SUPPORTED_POINTS,
)
from blackboard.messages.geometry import IDENTITY, Pose, pack_array, wrap_angle
from blackboard.messages.mapping import CorrectedPath
from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan
from blackboard.parameters import require
from knowledge_sources.eou_grid import EvidenceGrid
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.laser_graph.bend import bend
from knowledge_sources.laser_graph.carving import carve
from knowledge_sources.laser_graph.cone_solve import solve_cones
from knowledge_sources.laser_graph.cones import cones_of_lasers, cones_of_sonars
from knowledge_sources.laser_graph.front_end import Tracker
from knowledge_sources.laser_graph.map_points import beam_ends, echo_middles
from knowledge_sources.laser_graph.poses import Floats, between
from knowledge_sources.laser_graph.scan_points import scan_points
from knowledge_sources.laser_graph.solution import Solution
from knowledge_sources.laser_graph.solve import solve
from knowledge_sources.sensors import laser_of
from knowledge_sources.stretches import Stretches


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserGraphParams:
    """Which scans become keyframes."""

    step_m: float = 0.3  # driven, or turned by `turn_rad`, since the last keyframe
    turn_rad: float = 0.2
    longest_m: float = 30.0  # longer beams hit at a slant and lie far apart

    def __post_init__(self) -> None:
        require(0 <= self.step_m <= 10, "step_m", self.step_m, "[0, 10] metres")
        require(0 <= self.turn_rad <= 3.2, "turn_rad", self.turn_rad, "[0, 3.2]")
        require(1 <= self.longest_m <= 1000, "longest_m", self.longest_m, "[1, 1000] metres")


class LaserGraph(KnowledgeSource[LaserGraphParams]):
    """Tracks from keyframe to keyframe; looks back on all of them at the end. Memory grows with the way driven."""

    Params = LaserGraphParams
    triggers = (ODOM_FROM_ROBOT, LASER_SCAN, SONAR_SCAN)
    reads = (ROBOT,)
    posts = (MAP_FROM_ODOM, CORRECTED_PATH, GRID, SUPPORTED_POINTS)
    rating = 60.0
    work = 5

    def __init__(self, params: LaserGraphParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._tracker = Tracker()
        self._stamps: list[float] = []
        self._odometry: list[Floats] = []  # x_m, y_m, heading_rad at each stamp
        self._odometry_revision = 0  # the last one taken
        self._at: list[int] = []  # reading at which each keyframe was taken
        self._sweeps: list[LaserScan] = []  # of the keyframes
        self._rings: list[SonarScan] = []  # of the keyframes of a robot without a laser
        self._stretches = Stretches()

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        self._take_odometry(board, trigger.stamp_s)
        robot = board.newest(ROBOT)
        if isinstance(trigger.value, Pose) or robot is None or not self._odometry or not self._moved():
            return
        if isinstance(trigger.value, LaserScan):
            map_from_odom = self._track(trigger.value, robot.value)
            self._sweeps.append(trigger.value)
        elif not robot.value.lasers:
            map_from_odom = IDENTITY
            self._rings.append(trigger.value)
        else:
            return
        self._at.append(len(self._odometry) - 1)
        self._stretches.add((trigger,))
        if self._sweeps or len(self._at) == 1:
            board.post(MAP_FROM_ODOM, map_from_odom, supports=[trigger], stamp_s=trigger.stamp_s)

    def _track(self, sweep: LaserScan, robot: RobotDescription) -> Pose:
        """Match a sweep to the last ones; return map_from_odom."""
        start = self._odometry[self._at[-1]] if self._at else self._odometry[-1]
        scan = scan_points(sweep, laser_of(robot, sweep.laser).mount, self.params.longest_m)
        found = self._tracker.add(scan, between(start, self._odometry[-1]))
        if not self._at:  # the map begins where odometry does
            found = self._tracker.poses[0] = self._odometry[-1].copy()
        return _pose(found) @ _pose(self._odometry[-1]).inverse()

    def _take_odometry(self, board: Access, until_s: float) -> None:
        """Take what odometry said up to a stamp: of the readings that came together, no scan may see later ones."""
        newest = board.newest(ODOM_FROM_ROBOT)
        if newest is None or newest.revision == self._odometry_revision:
            return
        for entry in board.revisions(Support(newest.key, self._odometry_revision + 1, newest.revision)):
            if entry.stamp_s > until_s:
                break
            self._odometry_revision = entry.revision
            self._stamps.append(entry.stamp_s)
            self._odometry.append(_array(entry.value))
            self._stretches.add((entry,))

    def finish(self, board: Access) -> None:
        robot = board.newest(ROBOT)
        if robot is None or len(self._at) < 2:
            return
        odometry, at = np.array(self._odometry), np.array(self._at)
        if self._sweeps:
            solution = solve(self._tracker, cones_of_lasers(self._sweeps, robot.value))
            points = beam_ends(self._tracker.scans, solution.poses)
        else:
            cones = cones_of_sonars(self._rings, robot.value)
            solution = solve_cones(cones, odometry, at)
            points = echo_middles(cones, solution.poses, carve(cones, solution.poses))
        path = bend(odometry, at, solution.poses, solution.model)
        value = CorrectedPath(
            poses=pack_array(np.column_stack([np.array(self._stamps), path])),
            closures=solution.closures,
            candidates=solution.candidates,
            seen_again=solution.seen_again,
            contradicted_fraction=solution.contradicted_fraction,
            closed=solution.closed,
        )
        entry = board.post(CORRECTED_PATH, value, supports=self._stretches.supports())
        self._post_grid(solution.poses, robot.value, entry, board)
        board.post(SUPPORTED_POINTS, points, supports=[entry])
        _endorse(entry, solution, board)

    def _post_grid(self, keyframes: Floats, robot: RobotDescription, path: Entry[CorrectedPath], board: Access) -> None:
        grid = EvidenceGrid(EouGridParams())
        scans: Sequence[LaserScan | SonarScan] = self._sweeps or self._rings
        for scan, pose in zip(scans, keyframes, strict=True):
            grid.fold(scan, robot, _pose(pose))
        for tile in grid.take_changed():
            board.post(GRID, tile, id=tile_id(tile), supports=[path])

    def _moved(self) -> bool:
        if not self._at:
            return True
        last, now = self._odometry[self._at[-1]], self._odometry[-1]
        far = float(np.hypot(*(now - last)[:2])) >= self.params.step_m
        return far or abs(wrap_angle(float(now[2] - last[2]))) >= self.params.turn_rad


def _endorse(entry: Entry[CorrectedPath], solution: Solution, board: Access) -> None:
    """Say of the path whether what was seen again from it fits together; nothing where nothing was."""
    if solution.candidates:
        why = (
            f"{solution.closures} of {solution.candidates} places met again fit; "
            f"{100.0 * solution.contradicted_fraction:.0f} % of what was seen again contradicts another pass"
        )
        board.endorse(entry, "for" if solution.closed else "against", why)


def _array(pose: Pose) -> Floats:
    return np.array([pose.x_m, pose.y_m, pose.heading_rad])


def _pose(array: Floats) -> Pose:
    return Pose(x_m=float(array[0]), y_m=float(array[1]), heading_rad=wrap_angle(float(array[2])))
