"""Raw readings through the board: batches of points, without those that the grid calls empty."""

from math import pi, radians
from typing import Any

import numpy as np
import pytest

from blackboard.board import Board
from blackboard.control import Control
from blackboard.errors import ComponentFailed, MissionError
from blackboard.grid import EMPTY_MAX, UNKNOWN
from blackboard.kinds import GRID, LASER_SCAN, MAP_FROM_ODOM, ODOM_FROM_ROBOT, ROBOT, SONAR_SCAN, SUPPORTED_POINTS
from blackboard.messages.geometry import IDENTITY, Pose, pack_array
from blackboard.messages.sensing import LaserScan, LaserSensor, RobotDescription, SonarScan, SonarSensor
from blackboard.messages.world import TILE_CELLS, GridTile, PointSet
from blackboard.vocabulary import Vocabulary
from knowledge_sources.filter_raw import FilterRaw, FilterRawParams

CELL_M = 0.05
MOUNTS = [Pose(x_m=0.2, y_m=0.0, heading_rad=0.0), Pose(x_m=-0.2, y_m=0.0, heading_rad=pi)]
RING = RobotDescription(
    name="two",
    radius_m=0.3,
    max_speed_mps=0.5,
    max_turn_radps=1.0,
    max_acceleration_mps2=0.5,
    sonars=tuple(SonarSensor(mount=m, cone_rad=radians(12.0), max_range_m=10.0) for m in MOUNTS),
    lasers=(LaserSensor(mount=IDENTITY, max_range_m=30.0),),
)


class Setting:
    """A board with a robot, and the filter under control."""

    def __init__(self, params: FilterRawParams) -> None:
        self.board = Board(Vocabulary())
        self.source = FilterRaw(params, name="filter")
        self.control = Control(self.board, [self.source], strict=True)
        self.board.post(ROBOT, RING, source="robot")
        self.board.post(MAP_FROM_ODOM, IDENTITY, source="odometry")
        self.batches: list[PointSet] = []
        self.board.subscribe(self.board.key(SUPPORTED_POINTS), lambda entry: self.batches.append(entry.value))

    def move(self, x_m: float, heading_rad: float = 0.0) -> None:
        self.board.now_s += 0.1
        pose = Pose(x_m=x_m, y_m=0.0, heading_rad=heading_rad)
        self.board.post(ODOM_FROM_ROBOT, pose, source="odometry", stamp_s=self.board.now_s)

    def sonar(self, *ranges_m: float | None) -> None:
        scan = SonarScan(sensors=tuple(range(len(ranges_m))), ranges_m=ranges_m)
        self.board.post(SONAR_SCAN, scan, source="robot", stamp_s=self.board.now_s)
        self.control.run_cycle()

    def drive(self, steps: int, *ranges_m: float | None) -> None:
        for i in range(steps):
            self.move(0.1 * i)
            self.sonar(*ranges_m)

    def tile(self, value: int, column: int = 0, row: int = 0) -> None:
        cells = np.full((TILE_CELLS, TILE_CELLS), value, np.uint8)
        tile = GridTile(column=column, row=row, cell_m=CELL_M, cells=pack_array(cells))
        self.board.post(GRID, tile, source="eou", id=f"{column}_{row}")


def points(batch: PointSet) -> np.ndarray:
    return np.asarray(batch.points.unpack())


def test_a_batch_comes_with_the_last_point_that_it_needs() -> None:
    setting = Setting(FilterRawParams(batch_points=20))
    setting.drive(9, 1.0, 2.0)
    assert setting.batches == []
    setting.move(1.0)
    setting.sonar(1.0, 2.0)
    assert len(setting.batches) == 1
    batch = setting.batches[0]
    assert points(batch)[:2] == pytest.approx(np.array([[1.2, 0.0], [-2.2, 0.0]]), abs=1e-6)
    assert np.asarray(batch.sensed_from.unpack())[:2] == pytest.approx(np.array([[0.2, 0.0], [-0.2, 0.0]]), abs=1e-6)
    assert np.asarray(batch.half_cone_rad.unpack()) == pytest.approx(radians(6.0))
    setting.drive(5, 1.0, 2.0)
    assert len(setting.batches) == 1


def test_points_in_empty_cells_are_dropped_and_counted() -> None:
    # Ahead, to x = 3.2 m, the grid is empty: the front sonar's echoes there are not borne out; those behind lie in the unknown.
    setting = Setting(FilterRawParams(batch_points=10))
    setting.tile(EMPTY_MAX)
    setting.drive(10, 1.0, 2.0)
    assert len(setting.batches) == 1
    assert (points(setting.batches[0])[:, 0] < 0).all()
    assert setting.batches[0].dropped == 10


@pytest.mark.parametrize("value", [EMPTY_MAX + 1, UNKNOWN, 255])
def test_points_in_other_cells_stay(value: int) -> None:
    setting = Setting(FilterRawParams(batch_points=10))
    setting.tile(value)
    setting.drive(10, 1.0)
    assert [batch.dropped for batch in setting.batches] == [0]


def test_the_newest_grid_decides() -> None:
    setting = Setting(FilterRawParams(batch_points=10))
    setting.drive(9, 1.0)
    setting.tile(0)
    setting.move(2.0)
    setting.sonar(1.0)
    assert setting.batches == []  # nine of the ten have turned out to lie in empty cells
    setting.drive(30, 1.0, 2.0)
    assert sum(batch.dropped for batch in setting.batches) >= 9


def test_without_the_filter_nothing_is_dropped() -> None:
    setting = Setting(FilterRawParams(batch_points=10, use_grid=False))
    setting.tile(0)
    setting.drive(10, 1.0)
    assert [len(points(batch)) for batch in setting.batches] == [10]


def test_standing_still_brings_nothing_new() -> None:
    setting = Setting(FilterRawParams(batch_points=10))
    for _ in range(30):
        setting.move(0.0)
        setting.sonar(1.0, 2.0)
    assert setting.batches == []
    for i in range(10):
        setting.move(0.0, heading_rad=0.06 * (i + 1))  # turning on the spot does
        setting.sonar(1.0, 2.0)
    assert len(setting.batches) == 2


def test_sonars_that_fire_in_turn_all_count() -> None:
    # Each comes in a scan of its own, and the second never after a move since the first.
    setting = Setting(FilterRawParams(batch_points=20))
    for i in range(10):
        setting.move(0.1 * i)
        for number, range_m in ((0, 1.0), (1, 2.0)):
            scan = SonarScan(sensors=(number,), ranges_m=(range_m,))
            setting.board.post(SONAR_SCAN, scan, source="robot", stamp_s=setting.board.now_s)
            setting.control.run_cycle()
    assert [len(points(batch)) for batch in setting.batches] == [20]
    assert (points(setting.batches[0])[:, 0] < 0).sum() == 10


def test_a_laser_takes_nothing_from_the_sonars() -> None:
    setting = Setting(FilterRawParams(batch_points=20))
    for i in range(10):
        setting.move(0.1 * i)
        scan = LaserScan(angle_min_rad=pi / 2, angle_step_rad=0.0, ranges_m=(3.0,))
        setting.board.post(LASER_SCAN, scan, source="robot", stamp_s=setting.board.now_s)
        setting.sonar(1.0)
    assert len(setting.batches) == 1
    half_cones = np.asarray(setting.batches[0].half_cone_rad.unpack())
    assert [(half_cones == 0.0).sum(), (half_cones > 0.0).sum()] == [10, 10]


def test_no_echo_and_far_echoes_are_no_points_and_none_at_the_sensor() -> None:
    setting = Setting(FilterRawParams(batch_points=10, max_range_m=4.0))
    setting.drive(20, None, 4.1)
    setting.drive(20, 0.0, 4.1)
    setting.control.finish()
    assert setting.batches == []


def test_what_is_never_borne_out_is_not_heaped_up() -> None:
    setting = Setting(FilterRawParams(batch_points=10, least_points=1))
    for column in range(-3, 4):
        setting.tile(0, column=column)
        setting.tile(0, column=column, row=-1)
    for i in range(200):
        setting.move(0.05 * (i % 40))
        setting.sonar(1.0, 2.0)
        assert len(setting.source._points) < 10
    setting.control.finish()
    assert setting.batches == []


def test_a_scan_without_a_pose_is_passed_over() -> None:
    setting = Setting(FilterRawParams(batch_points=10, least_points=1))
    for _ in range(20):
        setting.board.now_s += 0.1
        setting.sonar(1.0, 2.0)
    setting.control.finish()
    assert setting.batches == []


def test_a_batch_bears_the_stamp_of_its_newest_scan() -> None:
    setting = Setting(FilterRawParams(batch_points=10))
    setting.drive(9, 1.0)
    setting.move(1.0)
    taken_s = setting.board.now_s
    setting.board.now_s += 0.2
    setting.board.post(SONAR_SCAN, SonarScan(sensors=(0,), ranges_m=(1.0,)), source="robot", stamp_s=taken_s)
    setting.control.run_cycle()
    entry = setting.board.newest(SUPPORTED_POINTS)
    assert entry is not None
    assert entry.stamp_s == taken_s


def test_the_next_batch_starts_where_the_last_one_ended() -> None:
    setting = Setting(FilterRawParams(batch_points=10))
    setting.drive(10, 1.0)
    setting.move(5.0)
    setting.sonar(None)  # no point: no part of the batch
    for i in range(10):
        setting.move(6.0 + 0.1 * i)
        setting.sonar(1.0)
    entry = setting.board.newest(SUPPORTED_POINTS)
    assert entry is not None
    supports = {s.key.rsplit("/", 1)[1]: (s.first, s.last) for s in entry.supports}
    assert supports == {"sonar_scan": (12, 21), "odom_from_robot": (12, 21), "map_from_odom": (1, 1)}


def test_a_sensor_that_the_robot_does_not_have_is_named() -> None:
    setting = Setting(FilterRawParams())
    setting.move(0.0)
    with pytest.raises(ComponentFailed, match="sonar number 2, the description of robot 'two' has numbers 0 to 1"):
        setting.sonar(1.0, 2.0, 3.0)


def test_a_laser_s_points_are_thinned() -> None:
    setting = Setting(FilterRawParams(batch_points=10, laser_step_m=0.1))
    setting.move(0.0)
    # Beams a degree apart at 2 m end 3.5 cm apart: every third counts; with a single gap of 10.5 cm the first and the fourth.
    scan = LaserScan(angle_min_rad=0.0, angle_step_rad=radians(1.0), ranges_m=(2.0,) * 31)
    setting.board.post(LASER_SCAN, scan, source="robot", stamp_s=setting.board.now_s)
    setting.control.run_cycle()
    setting.control.finish()
    assert len(setting.batches) == 1
    there = points(setting.batches[0])
    assert len(there) == 11
    bearings = np.degrees(np.arctan2(there[:, 1], there[:, 0]))
    assert bearings == pytest.approx(np.arange(0.0, 31.0, 3.0), abs=1e-3)
    assert (np.asarray(setting.batches[0].half_cone_rad.unpack()) == 0.0).all()


def test_the_rest_comes_at_the_end_if_it_is_worth_it() -> None:
    setting = Setting(FilterRawParams(batch_points=100, least_points=20))
    setting.drive(9, 1.0, 2.0)
    setting.control.finish()
    assert setting.batches == []
    setting.drive(2, 1.0, 2.0)
    setting.control.finish()
    assert [len(points(batch)) for batch in setting.batches] == [22]


def test_a_batch_names_its_scans_poses_and_tiles() -> None:
    setting = Setting(FilterRawParams(batch_points=10))
    setting.tile(UNKNOWN)
    setting.tile(UNKNOWN, column=40)  # far from every point
    setting.drive(10, 1.0)
    entry = setting.board.newest(SUPPORTED_POINTS)
    assert entry is not None
    supports = {s.key.rsplit("/", 1)[1]: (s.first, s.last) for s in entry.supports}
    assert supports == {"sonar_scan": (1, 10), "odom_from_robot": (1, 10), "map_from_odom": (1, 1), "0_0": (1, 1)}


@pytest.mark.parametrize(
    ("key", "value"), [("batch_points", 3), ("max_range_m", 0.0), ("min_step_m", -0.1), ("least_points", 0)]
)
def test_parameters_have_limits(key: str, value: Any) -> None:
    with pytest.raises(MissionError, match=key):
        FilterRawParams(**{key: value})
