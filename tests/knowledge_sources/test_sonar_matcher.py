"""The matcher through the board: a box room driven through with odometry that over-counts."""

from math import cos, pi, radians, sin

import numpy as np
import pytest

from blackboard.board import Board
from blackboard.control import Control
from blackboard.kinds import MAP_FROM_ODOM, ODOM_FROM_ROBOT, POSE_ESTIMATE, ROBOT, SONAR_SCAN
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import RobotDescription, SonarScan, SonarSensor
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions
from blackboard.vocabulary import Vocabulary
from knowledge_sources.sonar_matcher import SonarMatcher
from knowledge_sources.sonar_matching.params import SonarMatcherParams

BEARINGS = tuple(k * pi / 6 for k in range(-5, 7))
RING = RobotDescription(
    name="ring",
    radius_m=0.3,
    max_speed_mps=0.5,
    max_turn_radps=1.0,
    max_acceleration_mps2=0.5,
    sonars=tuple(
        SonarSensor(mount=Pose(x_m=0.0, y_m=0.0, heading_rad=b), cone_rad=radians(12), max_range_m=10.0)
        for b in BEARINGS
    ),
)
LENGTH_M, WIDTH_M = 4.0, 3.0  # of the room, the origin in its centre


def echoes(true: Pose) -> SonarScan:
    ranges = []
    for bearing in BEARINGS:
        angles = true.heading_rad + bearing + np.linspace(-radians(6), radians(6), 20) + 1e-4
        c, s = np.cos(angles), np.sin(angles)
        along = (np.copysign(LENGTH_M / 2, c) - true.x_m) / c
        across = (np.copysign(WIDTH_M / 2, s) - true.y_m) / s
        ranges.append(float(np.minimum(along, across).min()))
    return SonarScan(sensors=tuple(range(len(BEARINGS))), ranges_m=tuple(ranges))


class Drive:
    """A robot on a circle of 0.8 m; its odometry, which starts at the true pose, says `scale` times the way."""

    def __init__(self, params: SonarMatcherParams, scale: float = 1.0) -> None:
        self.board = Board(Vocabulary())
        self.source = SonarMatcher(params, name="sonar_matcher")
        self.control = Control(self.board, [self.source], strict=True)
        self.board.post(ROBOT, RING, source="robot")
        self.true = self.told = self._on_circle(0.0)
        self.scale = scale
        self.steps = 0

    def _on_circle(self, way_m: float) -> Pose:
        turn_rad = way_m / 0.8
        return Pose(x_m=0.8 * sin(turn_rad), y_m=-0.8 * cos(turn_rad), heading_rad=(turn_rad + pi) % (2 * pi) - pi)

    def scan(self, move: bool = True, range_m: float | None = None) -> None:
        if move:
            self.steps += 1
            there = self._on_circle(0.05 * self.steps)
            step = self.true.inverse() @ there
            wrong = Pose(x_m=step.x_m * self.scale, y_m=step.y_m * self.scale, heading_rad=step.heading_rad)
            self.true, self.told = there, self.told @ wrong
        self.board.now_s += 0.2
        self.board.post(ODOM_FROM_ROBOT, self.told, source="odometry", stamp_s=self.board.now_s)
        value = echoes(self.true)
        if range_m is not None:
            value = SonarScan(sensors=value.sensors, ranges_m=(range_m,) * len(value.sensors))
        self.board.post(SONAR_SCAN, value, source="robot", stamp_s=self.board.now_s)
        self.control.run_cycle()

    def error_m(self) -> float:
        entry = self.board.newest(MAP_FROM_ODOM)
        assert entry is not None
        return (entry.value @ self.told).distance_m(self.true)


def test_the_first_scan_puts_the_map_where_odometry_begins() -> None:
    drive = Drive(SonarMatcherParams())
    drive.scan()
    entry = drive.board.newest(MAP_FROM_ODOM)
    assert entry is not None
    assert entry.value == IDENTITY
    assert entry.source == "sonar_matcher"


def test_odometry_that_counts_too_much_is_held_and_found_out() -> None:
    drive = Drive(SonarMatcherParams(), scale=1.06)
    for _ in range(240):
        drive.scan()
    assert drive.told.distance_m(drive.true) > 0.05
    assert drive.error_m() < 0.05
    assert drive.source.tracker.estimate is not None
    assert drive.source.tracker.estimate.errors[0] == pytest.approx(1 / 1.06 - 1, abs=0.025)


def test_a_revision_names_the_scans_of_its_window_and_the_poses() -> None:
    drive = Drive(SonarMatcherParams())
    for _ in range(25):
        drive.scan()
    entry = drive.board.newest(MAP_FROM_ODOM)
    assert entry is not None
    assert entry.revision >= 2
    by_key = {support.key: support for support in entry.supports}
    scans = by_key[drive.board.key(SONAR_SCAN)]
    assert scans.last - scans.first == 14
    assert by_key[drive.board.key(ODOM_FROM_ROBOT)].last == scans.last
    assert by_key[drive.board.key(MAP_FROM_ODOM)].last == entry.revision - 1


def test_a_robot_that_stands_learns_nothing_new() -> None:
    drive = Drive(SonarMatcherParams())
    for _ in range(25):
        drive.scan()
    before = drive.board.newest(MAP_FROM_ODOM)
    for _ in range(30):
        drive.scan(move=False)
    assert drive.board.newest(MAP_FROM_ODOM) is before


def test_echoes_that_do_not_fit_the_map_are_refused_and_said_once() -> None:
    drive = Drive(SonarMatcherParams())
    for _ in range(60):
        drive.scan()
    for _ in range(20):
        drive.scan(range_m=0.4)  # as of one who walks beside the robot
    before = drive.board.newest(MAP_FROM_ODOM)
    assert before is not None
    for _ in range(10):
        drive.scan(range_m=0.4)
    after = drive.board.newest(MAP_FROM_ODOM)
    assert after is not None
    assert after.value == before.value
    assert [said.verdict for said in after.endorsements] == ["against"]
    assert "fit the map" in after.endorsements[0].why


def test_each_match_posts_the_pose_and_how_sure_it_is() -> None:
    drive = Drive(SonarMatcherParams())
    for _ in range(40):
        drive.scan()
    estimate, standing = drive.board.newest(POSE_ESTIMATE), drive.board.newest(MAP_FROM_ODOM)
    assert estimate is not None
    assert standing is not None
    assert estimate.value.map_from_robot.distance_m(standing.value @ drive.told) < 1e-9
    xx, _, _, yy, _, turn = estimate.value.covariance
    assert 0.0 < xx < 0.1**2
    assert 0.0 < yy < 0.1**2
    assert 0.0 < turn < 0.1**2


@pytest.mark.parametrize("mission", ["explore-lab-sonar", "map-recording-sonar"])
def test_the_shipped_missions_match_sonars(mission: str) -> None:
    settings = {"robot": {"path": "drive.log.gz"}} if mission.startswith("map") else {}
    loaded = load_mission(find_mission(mission), settings)
    assert SonarMatcher in [spec.type for spec in loaded.knowledge_sources]


def test_in_the_lab_the_pose_stays_nearer_to_the_truth_than_odometry() -> None:
    run = Run(load_mission(find_mission("explore-lab-sonar"), {}), RunOptions(seed=1, strict=True))
    errors = []
    for _ in range(900):
        run.cycle()
        true, odometry = run.robot.true_pose(), run.board.newest(ODOM_FROM_ROBOT)
        standing = run.board.newest(MAP_FROM_ODOM)
        assert true is not None
        if odometry is None or standing is None:
            continue
        if not errors:
            start = odometry.value @ true.inverse()
        errors.append((standing.value @ odometry.value).distance_m(start @ true))
    assert np.mean(errors) < 0.12
    assert max(errors) < 0.35
