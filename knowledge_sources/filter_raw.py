"""Raw readings as points, without those that the grid does not bear out (Bou-Ghannam 1992, section 5.2.2).

Triggered by  observations/signal/sonar_scan    SonarScan
              observations/signal/laser_scan    LaserScan
Reads         status/robot, hypotheses/feature/grid,
              observations/feature/odom_from_robot, hypotheses/feature/map_from_odom
Posts         observations/feature/supported_points    PointSet: a batch, as soon as enough have come
"""

from dataclasses import dataclass
from math import hypot, inf
from typing import Any, NamedTuple

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry
from blackboard.grid import EMPTY_MAX, Grid
from blackboard.kinds import GRID, LASER_SCAN, ROBOT, SONAR_SCAN, SUPPORTED_POINTS
from blackboard.messages.geometry import Pose, pack_array
from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan
from blackboard.messages.world import PointSet
from blackboard.parameters import require
from knowledge_sources.poses import READS, map_from_robot_at, moved_on
from knowledge_sources.sensors import laser_of, sonar_of
from knowledge_sources.stretches import Stretches


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterRawParams:
    """Which readings count, and how many make a batch."""

    batch_points: int = 500  # the thesis's: some 45 scans of a ring of twelve
    use_grid: bool = True  # false: nothing is dropped, to see what the filter is worth
    max_range_m: float = 5.0  # further echoes are blurred by the cone and by the heading's error
    min_step_m: float = 0.05  # a robot that stands still hears the same again: a scan counts after moving a cell
    min_turn_rad: float = 0.05  # or turning by some 3 degrees
    laser_step_m: float = 0.1  # ends of beams nearer to each other than that count once: two cells of the grid
    least_points: int = 50  # what is left at the end makes a batch if it is more than a tenth of one

    def __post_init__(self) -> None:
        require(10 <= self.batch_points <= 100_000, "batch_points", self.batch_points, "[10, 100000]")
        require(0 < self.max_range_m <= 1000, "max_range_m", self.max_range_m, "(0, 1000] metres")
        require(0 <= self.min_step_m <= 10, "min_step_m", self.min_step_m, "[0, 10] metres")
        require(0 <= self.min_turn_rad <= 6.3, "min_turn_rad", self.min_turn_rad, "[0, 6.3]")
        require(0 <= self.laser_step_m <= 10, "laser_step_m", self.laser_step_m, "[0, 10] metres")
        require(self.least_points >= 1, "least_points", self.least_points, "1 and more")


class RawPoint(NamedTuple):
    """A reading as a point, map frame: on the axis of the cone, at its range."""

    x_m: float
    y_m: float
    from_x_m: float
    from_y_m: float
    half_cone_rad: float


def sonar_points(
    scan: SonarScan, robot: RobotDescription, map_from_robot: Pose, params: FilterRawParams
) -> list[RawPoint | None]:
    """Return the reading of each sonar of a scan as a point; None where there is no echo that counts."""
    points: list[RawPoint | None] = []
    for number, range_m in zip(scan.sensors, scan.ranges_m, strict=True):
        sonar = sonar_of(robot, number)
        if range_m is None or not 0.0 < range_m <= params.max_range_m:
            points.append(None)
            continue
        at = map_from_robot @ sonar.mount
        x, y = at.transform(range_m, 0.0)
        points.append(RawPoint(x, y, at.x_m, at.y_m, sonar.cone_rad / 2))
    return points


def laser_points(
    scan: LaserScan, robot: RobotDescription, map_from_robot: Pose, params: FilterRawParams
) -> list[RawPoint]:
    """Return the ends of a sweep's beams as points, thinned: one within `laser_step_m` of the last one kept is left out."""
    at = map_from_robot @ laser_of(robot, scan.laser).mount
    ranges = np.array([r or 0.0 for r in scan.ranges_m])
    beams = np.flatnonzero((ranges > 0.0) & (ranges <= params.max_range_m))
    angles = at.heading_rad + scan.angle_min_rad + scan.angle_step_rad * beams
    xs, ys = at.x_m + ranges[beams] * np.cos(angles), at.y_m + ranges[beams] * np.sin(angles)
    points: list[RawPoint] = []
    last_x, last_y = inf, inf
    for x, y in zip(xs.tolist(), ys.tolist(), strict=True):
        if hypot(x - last_x, y - last_y) >= params.laser_step_m:
            points.append(RawPoint(x, y, at.x_m, at.y_m, 0.0))
            last_x, last_y = x, y
    return points


def supported(points: list[RawPoint], grid: Grid | None) -> list[RawPoint]:
    """Return the points whose cell is not considered empty."""
    if grid is None or not points:
        return points
    values = grid.values_at(np.array([(p.x_m, p.y_m) for p in points]))
    return [point for point, value in zip(points, values.tolist(), strict=True) if value > EMPTY_MAX]


class FilterRaw(KnowledgeSource[FilterRawParams]):
    """Collects points until a batch of them is borne out by the grid. At most a batch and one scan of them are held."""

    Params = FilterRawParams
    triggers = (SONAR_SCAN, LASER_SCAN)
    reads = (ROBOT, GRID, *READS)
    posts = (SUPPORTED_POINTS,)
    rating = 20.0

    def __init__(self, params: FilterRawParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._points: list[RawPoint] = []
        self._dropped = 0
        self._newest_s = -inf  # stamp of the newest scan with a point
        self._stretches = Stretches()  # of scans and poses, since the last batch
        self._counted_at: dict[tuple[str, int], Pose] = {}  # where each sensor's reading last counted

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        batch = board.newest(SUPPORTED_POINTS)
        if batch is not None and batch.stamp_s > self._newest_s:  # the points that were kept are in it
            self._points, self._dropped, self._newest_s = [], 0, batch.stamp_s
            self._stretches.clear()

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        robot = board.newest(ROBOT)
        found = map_from_robot_at(board, trigger.stamp_s)
        if robot is None or found is None:
            return
        points = self._new_points(trigger.value, robot.value, found[0])
        if not points:
            return
        self._points += points
        self._newest_s = max(self._newest_s, trigger.stamp_s)
        self._stretches.add((trigger, *found[1]))
        self._post(board, self.params.batch_points)

    def finish(self, board: Access) -> None:
        self._post(board, self.params.least_points)

    def _new_points(self, scan: SonarScan | LaserScan, robot: RobotDescription, pose: Pose) -> list[RawPoint]:
        """Return the points of those sensors that have moved since they last counted."""
        if isinstance(scan, LaserScan):
            return laser_points(scan, robot, pose, self.params) if self._moved(("laser", scan.laser), pose) else []
        moved = [self._moved(("sonar", number), pose) for number in scan.sensors]
        points = sonar_points(scan, robot, pose, self.params)
        return [point for point, counts in zip(points, moved, strict=True) if counts and point is not None]

    def _moved(self, sensor: tuple[str, int], pose: Pose) -> bool:
        params = self.params
        moved = moved_on(self._counted_at.get(sensor), pose, params.min_step_m, params.min_turn_rad)
        if moved:
            self._counted_at[sensor] = pose
        return moved

    def _post(self, board: Access, least: int) -> None:
        """Where there may be enough, drop what the grid does not bear out, and post the rest if it is enough."""
        if len(self._points) < least:
            return
        tiles: list[Entry[Any]] = []
        if self.params.use_grid:
            tiles = board.entries(GRID, area=_box(self._points))
            kept = supported(self._points, Grid.from_tiles(tile.value for tile in tiles))
            self._dropped += len(self._points) - len(kept)
            self._points = kept
        if len(self._points) < least:
            return
        points = np.array(self._points, dtype=np.float32)
        value = PointSet(
            points=pack_array(np.ascontiguousarray(points[:, 0:2])),
            sensed_from=pack_array(np.ascontiguousarray(points[:, 2:4])),
            half_cone_rad=pack_array(np.ascontiguousarray(points[:, 4])),
            dropped=self._dropped,
        )
        board.post(SUPPORTED_POINTS, value, supports=[*self._stretches.supports(), *tiles], stamp_s=self._newest_s)
        self._points, self._dropped = [], 0
        self._stretches.clear()


def _box(points: list[RawPoint]) -> tuple[float, float, float, float]:
    xs, ys = [p.x_m for p in points], [p.y_m for p in points]
    return (min(xs), min(ys), max(xs), max(ys))
