"""Scans through the board into grid tiles, and a closed loop with the simulated robot."""

from collections.abc import Sequence
from math import cos, pi, radians, sin
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.board import Board
from blackboard.control import Control
from blackboard.errors import ComponentFailed, MissionError
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, UNKNOWN, Grid
from blackboard.kinds import GRID, LASER_SCAN, MAP_FROM_ODOM, ODOM_FROM_ROBOT, ROBOT, SONAR_SCAN
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import LaserScan, LaserSensor, RobotDescription, SonarScan, SonarSensor
from blackboard.mission import find_mission, load_mission
from blackboard.report.scores import grid_score
from blackboard.runner import Run, RunOptions
from blackboard.vocabulary import Vocabulary
from knowledge_sources.eou_grid import EouGrid, EvidenceGrid
from knowledge_sources.eou_params import EouGridParams

FRONT = SonarSensor(mount=IDENTITY, cone_rad=radians(12.0), max_range_m=10.0)
LASER = LaserSensor(mount=IDENTITY, max_range_m=30.0)
ROBOT_WITH_BOTH = RobotDescription(
    name="both",
    radius_m=0.3,
    max_speed_mps=0.5,
    max_turn_radps=1.0,
    max_acceleration_mps2=0.5,
    sonars=(FRONT,),
    lasers=(LASER,),
)


class Setting:
    """A board with a robot at one place, and the grid source under control."""

    def __init__(self, params: EouGridParams | None = None) -> None:
        self.board = Board(Vocabulary())
        self.control = Control(self.board, [EouGrid(params or EouGridParams(), name="eou")], strict=True)
        self.board.post(ROBOT, ROBOT_WITH_BOTH, source="robot")
        self.board.post(MAP_FROM_ODOM, IDENTITY, source="odometry")

    def at(self, now_s: float, x_m: float = 0.0, y_m: float = 0.0, heading_rad: float = 0.0) -> None:
        self.board.now_s = now_s
        pose = Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad)
        self.board.post(ODOM_FROM_ROBOT, pose, source="odometry", stamp_s=now_s)

    def sonar(self, range_m: float | None, number: int = 0) -> None:
        scan = SonarScan(sensors=(number,), ranges_m=(range_m,))
        self.board.post(SONAR_SCAN, scan, source="robot", stamp_s=self.board.now_s)
        self.control.run_cycle()

    def laser(self, ranges_m: Sequence[float | None], first_rad: float, step_rad: float) -> None:
        scan = LaserScan(angle_min_rad=first_rad, angle_step_rad=step_rad, ranges_m=tuple(ranges_m))
        self.board.post(LASER_SCAN, scan, source="robot", stamp_s=self.board.now_s)
        self.control.run_cycle()

    def values(self, *places: tuple[float, float]) -> list[int]:
        grid = Grid.from_tiles(entry.value for entry in self.board.entries(GRID))
        return [UNKNOWN] * len(places) if grid is None else grid.values_at(np.array(places)).tolist()


def test_an_echo_stands_in_the_grid_where_the_robot_was() -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0))
    setting.at(0.0, x_m=-20.0, y_m=10.0, heading_rad=pi / 2)
    setting.at(0.1, x_m=-20.0, y_m=10.4, heading_rad=pi / 2)
    for _ in range(10):
        setting.sonar(2.0)
    passed, wall, beyond, beside = setting.values((-20.0, 11.4), (-20.0, 12.4), (-20.0, 12.6), (-19.0, 10.4))
    assert passed <= EMPTY_MAX
    assert wall >= OCCUPIED_MIN
    assert beyond == beside == UNKNOWN


def test_a_late_scan_is_folded_in_where_it_was_taken() -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0))
    setting.at(0.0)
    setting.at(1.0, x_m=1.0)
    scan = SonarScan(sensors=(0,), ranges_m=(1.0,))
    setting.board.post(SONAR_SCAN, scan, source="robot", stamp_s=0.5)
    setting.control.run_cycle()
    assert setting.values((1.475, 0.0), (1.525, 0.0), (1.975, 0.0), (0.45, 0.0))[2:] == [UNKNOWN, UNKNOWN]
    assert max(setting.values((1.475, 0.0), (1.525, 0.0))) > UNKNOWN


def test_a_scan_without_a_pose_is_passed_over() -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0))
    setting.board.now_s = 3.0
    setting.sonar(1.0)
    assert setting.board.entries(GRID) == []


def test_tiles_are_posted_once_in_an_interval_and_the_rest_at_the_end() -> None:
    setting = Setting(EouGridParams(post_interval_s=1.0))
    for i in range(15):
        setting.at(0.1 * i)
        setting.sonar(1.0)
    tile = setting.board.newest(GRID, "0_0")
    assert tile is not None
    assert tile.revision == 2  # at 0.0 and at 1.0 s
    before = setting.values((0.5, 0.02))
    setting.control.finish()
    tile = setting.board.newest(GRID, "0_0")
    assert tile is not None
    assert tile.revision == 3
    assert setting.values((0.5, 0.02))[0] < before[0]
    setting.control.finish()
    assert tile.revision == 3  # what did not change is not posted again


def test_a_tile_names_the_stretch_of_scans_and_poses_in_it() -> None:
    setting = Setting(EouGridParams(post_interval_s=10.0))
    for i in range(5):
        setting.at(0.1 * i)
        setting.sonar(1.0)
    setting.control.finish()
    tile = setting.board.newest(GRID, "0_0")
    assert tile is not None
    supports = {s.key.rsplit("/", 1)[1]: (s.first, s.last) for s in tile.supports}
    assert supports == {"sonar_scan": (1, 5), "odom_from_robot": (1, 5), "map_from_odom": (1, 1)}


def test_a_tile_names_all_that_ever_went_into_it() -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0))
    setting.at(0.0)
    setting.sonar(1.0)
    setting.at(0.1)
    setting.laser([1.0] * 11, 0.0, pi / 180)
    tile = setting.board.newest(GRID, "0_0")
    assert tile is not None
    supports = {s.key.rsplit("/", 1)[1]: (s.first, s.last) for s in tile.supports}
    assert supports == {"sonar_scan": (1, 1), "laser_scan": (1, 1), "odom_from_robot": (1, 2), "map_from_odom": (1, 1)}


def test_a_tile_bears_the_stamp_of_its_newest_scan() -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0))
    setting.at(1.0)
    setting.board.now_s = 1.4
    scan = SonarScan(sensors=(0,), ranges_m=(1.0,))
    setting.board.post(SONAR_SCAN, scan, source="robot", stamp_s=1.0)  # it took 0.4 s to come
    setting.control.run_cycle()
    tile = setting.board.newest(GRID, "0_0")
    assert tile is not None
    assert tile.stamp_s == 1.0


def test_a_laser_sweep_empties_its_fan_and_marks_its_ends() -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0))
    setting.at(0.0, x_m=0.02, y_m=0.02)
    degree = pi / 180
    for _ in range(10):
        setting.laser([2.0] * 91, -pi / 4, degree)
    ends = [(0.02 + 2.0 * cos(a), 0.02 + 2.0 * sin(a)) for a in (-pi / 4 + i * degree for i in range(91))]
    assert min(setting.values(*ends)) >= OCCUPIED_MIN
    along = [(0.02 + r * cos(a), 0.02 + r * sin(a)) for r in (0.3, 1.0, 1.8) for a in (-0.7, 0.0, 0.7)]
    assert max(setting.values(*along)) <= EMPTY_MAX
    assert setting.values((-1.0, 0.0), (0.0, 1.0), (2.2, 0.0)) == [UNKNOWN] * 3


def test_laser_beams_that_do_not_return_say_nothing_and_long_ones_only_clear() -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0, laser_range_m=5.0))
    setting.at(0.0)
    setting.laser([None, 20.0], 0.0, pi / 2)
    assert setting.values((1.0, 0.0), (4.0, 0.0)) == [UNKNOWN, UNKNOWN]
    passed, capped, beyond = setting.values((0.0, 1.0), (0.0, 4.8), (0.0, 5.2))
    assert passed < UNKNOWN
    assert capped < UNKNOWN
    assert beyond == UNKNOWN


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_laser_may_turn_either_way(sign: float) -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0))
    setting.at(0.0, heading_rad=3.0)  # the fan goes over the cut at pi
    ranges = [1.0 + 0.02 * i for i in range(61)]
    ordered = ranges if sign > 0 else ranges[::-1]
    setting.laser(ordered, sign * -pi / 6, sign * pi / 180)
    for i in (5, 20, 30, 55):
        bearing, end = 3.0 - pi / 6 + i * pi / 180, 1.0 + 0.02 * i
        at_end, before = setting.values(
            (end * cos(bearing), end * sin(bearing)), ((end - 0.3) * cos(bearing), (end - 0.3) * sin(bearing))
        )
        assert at_end > UNKNOWN
        assert before < UNKNOWN


def test_someone_who_walked_by_fades() -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0))
    setting.at(0.0)
    for _ in range(4):
        setting.sonar(1.0)
    assert max(setting.values((0.975, 0.0), (1.025, 0.0))) >= OCCUPIED_MIN
    for _ in range(40):
        setting.sonar(2.0)
    assert max(setting.values((0.975, 0.0), (1.025, 0.0))) <= EMPTY_MAX


def test_a_sensor_that_the_robot_does_not_have_is_named() -> None:
    setting = Setting()
    setting.at(0.0)
    with pytest.raises(ComponentFailed, match="sonar number 7, the description of robot 'both' has numbers 0 to 0"):
        setting.sonar(1.0, number=7)
    scan = LaserScan(laser=2, angle_min_rad=0.0, angle_step_rad=0.1, ranges_m=(1.0,))
    setting = Setting()
    setting.at(0.0)
    setting.board.post(LASER_SCAN, scan, source="robot")
    with pytest.raises(ComponentFailed, match="laser number 2, the description of robot 'both' has numbers 0 to 0"):
        setting.control.run_cycle()


PLACES = st.floats(-12.0, 12.0)
SCANS = st.lists(st.tuples(PLACES, PLACES, st.floats(-pi, pi), st.floats(0.0, 6.0)), min_size=1, max_size=8)


@given(SCANS, st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_a_grid_that_grows_is_one_that_was_large_from_the_start(
    scans: list[tuple[float, float, float, float]], mount_x_m: float, mount_y_m: float
) -> None:
    # Sensors may also stand far outside of the body.
    mount = Pose(x_m=mount_x_m, y_m=mount_y_m, heading_rad=0.3)
    robot = RobotDescription(
        name="mast",
        radius_m=0.3,
        max_speed_mps=0.5,
        max_turn_radps=1.0,
        max_acceleration_mps2=0.5,
        sonars=(SonarSensor(mount=mount, cone_rad=radians(25.0), max_range_m=10.0),),
        lasers=(LaserSensor(mount=mount, max_range_m=30.0),),
    )
    grows, large = EvidenceGrid(EouGridParams()), EvidenceGrid(EouGridParams())
    large.grid.cover(-40.0, -40.0, 40.0, 40.0)
    for x_m, y_m, heading_rad, range_m in scans:
        pose = Pose(x_m=x_m, y_m=y_m, heading_rad=heading_rad)
        for grid in (grows, large):
            grid.fold(SonarScan(sensors=(0,), ranges_m=(range_m,)), robot, pose)
            grid.fold(LaserScan(angle_min_rad=-0.1, angle_step_rad=0.01, ranges_m=(range_m,) * 20), robot, pose)
    one, other = grows.grid.known_part(), large.grid.known_part()
    if one is None or other is None:
        assert one is other
        return
    assert (one.x_min_m, one.y_min_m) == pytest.approx((other.x_min_m, other.y_min_m))
    assert np.array_equal(one.cells, other.cells)


def test_a_pose_that_lies_far_off_is_an_error_and_no_memory() -> None:
    setting = Setting(EouGridParams(post_interval_s=0.0))
    setting.at(0.0)
    setting.sonar(1.0)
    setting.at(0.1, x_m=9e5)
    with pytest.raises(ComponentFailed, match="a pose or a tile lies far off"):
        setting.sonar(1.0)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("sonar_range_m", 50.1),
        ("laser_range_m", 0.1),
        ("cell_m", 0.0),
        ("sonar_range_m", -1.0),
        ("sonar_up", 0),
        ("sonar_down", 200),
        ("share", -1.0),
        ("band_m", 0.0),
    ],
)
def test_parameters_have_limits(key: str, value: Any) -> None:
    with pytest.raises(MissionError, match=key):
        EouGridParams(**{key: value})


def test_a_range_of_too_many_cells_is_refused() -> None:
    with pytest.raises(MissionError, match=r"laser_range_m = 10.1 is outside 10 metres, 1000 cells of cell_m = 0.01"):
        EouGridParams(cell_m=0.01, laser_range_m=10.1)
    EouGridParams(cell_m=0.01, laser_range_m=10.0)


def test_a_minute_in_the_lab() -> None:
    settings = {"robot": {"odometry_errors": False}}
    run = Run(load_mission(find_mission("wander-lab"), settings), RunOptions(seed=3, strict=True))
    run.run(60.0)
    grid = Grid.from_tiles(entry.value for entry in run.board.entries(GRID))
    truth = run.robot.truth()
    assert grid is not None
    assert truth is not None
    score = grid_score(grid, truth)
    assert score.decided > 4000
    assert (score.right_fraction or 0.0) > 0.95
    assert score.occupied > 100
    assert (score.occupied_right_fraction or 0.0) > 0.9
