"""The empty-occupied-unknown grid out of sonar and laser scans (Bou-Ghannam 1992, section 5.2.1).

Triggered by  observations/signal/sonar_scan    SonarScan
              observations/signal/laser_scan    LaserScan
Reads         status/robot, observations/feature/odom_from_robot, hypotheses/feature/map_from_odom
Posts         hypotheses/feature/grid/<column>_<row>    GridTile: tiles that changed, at most once in an interval
"""

from math import hypot, inf
from typing import Any

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry
from blackboard.grid import Grid, tile_id
from blackboard.kinds import GRID, LASER_SCAN, ROBOT, SONAR_SCAN
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan
from blackboard.messages.world import GridTile
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.laser_evidence import LaserEvidence
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.sensors import laser_of
from knowledge_sources.sonar_evidence import SonarEvidence, pings
from knowledge_sources.stretches import Stretches


class EouGrid(KnowledgeSource[EouGridParams]):
    """Folds each scan into a grid of its own, and posts the tiles that changed. A scan of which no pose is known is passed over."""

    Params = EouGridParams
    triggers = (SONAR_SCAN, LASER_SCAN)
    reads = (ROBOT, *READS)
    posts = (GRID,)
    rating = 50.0
    derived = ("_grid", "_stretches", "_tiles")  # the grid stands on the board

    def __init__(self, params: EouGridParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._grid = EvidenceGrid(params)
        self._posted_s: float | None = None
        self._newest_s = -inf  # stamp of the newest scan that was folded in
        self._stretches = Stretches()  # of scans and poses, since the last posting
        self._tiles: dict[str, Stretches] = {}  # what went into each tile

    def resume(self, state: object, board: Access) -> None:
        """Go on with the tiles that stand; what was not posted yet, one interval's scans at most, is forgotten."""
        super().resume(state, board)
        for entry in board.entries(GRID):
            self._grid.grid.update(entry.value)
            self._tiles.setdefault(str(entry.id), Stretches()).merge(entry.supports)
            self._newest_s = max(self._newest_s, entry.stamp_s)
        self._grid.take_changed()

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        robot = board.newest(ROBOT)
        pose = map_from_robot_at(board, trigger.stamp_s)
        if robot is None or pose is None:
            return
        self._grid.fold(trigger.value, robot.value, pose[0])
        self._newest_s = max(self._newest_s, trigger.stamp_s)
        self._stretches.add((trigger, *pose[1]))
        if self._posted_s is None or board.now_s - self._posted_s >= self.params.post_interval_s:
            self._post(board)

    def finish(self, board: Access) -> None:
        self._post(board)

    def _post(self, board: Access) -> None:
        self._posted_s = board.now_s
        for tile in self._grid.take_changed():
            name = tile_id(tile)
            stretches = self._tiles.setdefault(name, Stretches())
            stretches.merge(self._stretches.supports())
            board.post(GRID, tile, id=name, supports=stretches.supports(), stamp_s=self._newest_s)
        self._stretches.clear()


class EvidenceGrid:
    """A grid that scans are folded into, one after another; it grows as they reach further."""

    def __init__(self, params: EouGridParams) -> None:
        self.grid = Grid(params.cell_m)
        self._params = params
        self._sonar = SonarEvidence(params)
        self._laser = LaserEvidence(params)

    def fold(self, scan: SonarScan | LaserScan, robot: RobotDescription, map_from_robot: Pose) -> None:
        """Fold one scan, taken at `map_from_robot`; raise BoardError for a sensor that the robot does not have."""
        if isinstance(scan, SonarScan):
            said = pings(scan, robot, map_from_robot, self._params)
            x_m, y_m = map_from_robot.x_m, map_from_robot.y_m
            reaches_m = [hypot(ping.x_m - x_m, ping.y_m - y_m) + ping.range_m for ping in said]
            if said:
                self._cover(map_from_robot, max(reaches_m) + self._params.band_m)
                self._sonar.fold(self.grid, said)
        else:
            map_from_laser = map_from_robot @ laser_of(robot, scan.laser).mount
            longest_m = max((r for r in scan.ranges_m if r is not None), default=0.0)
            if longest_m > 0.0:
                self._cover(map_from_laser, min(longest_m, self._params.laser_range_m))
                self._laser.fold(self.grid, scan, map_from_laser)

    def take_changed(self) -> list[GridTile]:
        """Return the tiles that changed since the last call."""
        return self.grid.take_changed()

    def _cover(self, pose: Pose, reach_m: float) -> None:
        reach_m += self._params.cell_m
        self.grid.cover(pose.x_m - reach_m, pose.y_m - reach_m, pose.x_m + reach_m, pose.y_m + reach_m)
