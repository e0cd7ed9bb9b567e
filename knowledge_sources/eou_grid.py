"""The empty-occupied-unknown grid out of sonar and laser scans (Bou-Ghannam 1992, section 5.2.1).

Triggered by  observations/signal/sonar_scan    SonarScan
              observations/signal/laser_scan    LaserScan
Reads         status/robot, observations/feature/odom_from_robot, hypotheses/feature/map_from_odom
Posts         hypotheses/feature/grid/<column>_<row>    GridTile: tiles that changed, at most once in an interval
"""

from typing import Any

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry, Support
from blackboard.grid import Grid, tile_id
from blackboard.kinds import GRID, LASER_SCAN, ROBOT, SONAR_SCAN
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.laser_evidence import fold_laser
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.sonar_evidence import SonarEvidence, pings


class EouGrid(KnowledgeSource[EouGridParams]):
    """Folds each scan into a grid of its own, and posts the tiles that changed."""

    Params = EouGridParams
    triggers = (SONAR_SCAN, LASER_SCAN)
    reads = (ROBOT, *READS)
    posts = (GRID,)
    rating = 50.0

    def __init__(self, params: EouGridParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._grid = Grid(params.cell_m)
        self._sonar = SonarEvidence(params)
        self._posted_s: float | None = None
        self._stretches: dict[str, Support] = {}  # of scans and poses, since the last posting
        self._tiles: dict[str, dict[str, int]] = {}  # for each tile the first revision of each key that went into it

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        robot = board.newest(ROBOT)
        pose = map_from_robot_at(board, trigger.stamp_s)
        if robot is None or pose is None:
            return
        fold(self._grid, self._sonar, trigger.value, robot.value, pose[0], self.params)
        for entry in (trigger, *pose[1]):
            known = self._stretches.get(entry.key)
            first = entry.revision if known is None else min(known.first, entry.revision)
            last = entry.revision if known is None else max(known.last, entry.revision)
            self._stretches[entry.key] = Support(entry.key, first, last)
        if self._posted_s is None or board.now_s - self._posted_s >= self.params.post_interval_s:
            self._post(board)

    def finish(self, board: Access) -> None:
        self._post(board)

    def _post(self, board: Access) -> None:
        self._posted_s = board.now_s
        for tile in self._grid.take_changed():
            name = tile_id(tile)
            firsts = self._tiles.setdefault(name, {})
            supports = [Support(s.key, firsts.setdefault(s.key, s.first), s.last) for s in self._stretches.values()]
            board.post(GRID, tile, id=name, supports=supports)
        self._stretches.clear()


def fold(
    grid: Grid,
    sonar: SonarEvidence,
    scan: SonarScan | LaserScan,
    robot: RobotDescription,
    map_from_robot: Pose,
    params: EouGridParams,
) -> None:
    """Fold one scan, taken at `map_from_robot`, into the grid, which grows to cover it."""
    if isinstance(scan, SonarScan):
        said = pings(scan, robot, map_from_robot, params)
        reach_m = max((ping.range_m for ping in said), default=0.0) + params.band_m + params.cell_m
        _cover(grid, map_from_robot, reach_m + robot.radius_m)
        sonar.fold(grid, said)
    else:
        map_from_laser = map_from_robot @ robot.lasers[scan.laser].mount
        longest_m = max((r for r in scan.ranges_m if r is not None), default=0.0)
        _cover(grid, map_from_laser, min(longest_m, params.laser_range_m) + params.cell_m)
        fold_laser(grid, scan, map_from_laser, params)


def _cover(grid: Grid, pose: Pose, reach_m: float) -> None:
    grid.cover(pose.x_m - reach_m, pose.y_m - reach_m, pose.x_m + reach_m, pose.y_m + reach_m)
