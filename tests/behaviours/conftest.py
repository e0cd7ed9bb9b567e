"""A ring robot as in the thesis, and a board that readings can be put on by hand."""

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, pi, sin

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.kinds import BUMPER, LASER_SCAN, ODOMETRY, ROBOT, SONAR_SCAN
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.sensing import (
    Bumper,
    LaserScan,
    LaserSensor,
    Odometry,
    RobotDescription,
    SonarScan,
    SonarSensor,
)
from blackboard.vocabulary import Vocabulary

RADIUS_M = 0.3


def ring_robot(*, laser: bool = False) -> RobotDescription:
    """Return a robot with twelve sonars on its rim, 30 degrees apart, numbered to the left from straight ahead."""
    bearings = [wrap_angle(i * pi / 6) for i in range(12)]
    return RobotDescription(
        name="ring",
        radius_m=RADIUS_M,
        max_speed_mps=1.0,
        max_turn_radps=2.0,
        max_acceleration_mps2=0.5,
        sonars=tuple(
            SonarSensor(
                mount=Pose(x_m=RADIUS_M * cos(b), y_m=RADIUS_M * sin(b), heading_rad=b),
                cone_rad=pi / 15,
                max_range_m=10.0,
            )
            for b in bearings
        ),
        lasers=(LaserSensor(mount=Pose(x_m=0.1, y_m=0.0, heading_rad=0.0), max_range_m=8.0),) if laser else (),
        bumper=True,
    )


@dataclass
class Bench:
    """A board with a robot on it that stands at the origin of the odometry frame unless moved."""

    board: Board
    access: Access
    robot: RobotDescription

    def at(self, now_s: float, pose: Pose | None = None, forward_mps: float = 0.0, turn_radps: float = 0.0) -> "Bench":
        self.board.now_s = now_s
        pose = pose or Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)
        odometry = Odometry(pose=pose, forward_mps=forward_mps, turn_radps=turn_radps)
        self.board.post(ODOMETRY, odometry, source="robot", stamp_s=now_s)
        return self

    def hear(self, ranges_m: dict[int, float | None], stamp_s: float | None = None) -> "Bench":
        scan = SonarScan(sensors=tuple(ranges_m), ranges_m=tuple(ranges_m.values()))
        self.board.post(SONAR_SCAN, scan, source="robot", stamp_s=stamp_s)
        return self

    def sweep(self, scan: LaserScan) -> "Bench":
        self.board.post(LASER_SCAN, scan, source="robot")
        return self

    def touch(self, *bearings_rad: float) -> "Bench":
        self.board.post(BUMPER, Bumper(bearings_rad=bearings_rad), source="robot")
        return self


@pytest.fixture
def ring() -> RobotDescription:
    return ring_robot()


@pytest.fixture
def make_bench() -> Callable[..., Bench]:
    def make(*, laser: bool = False) -> Bench:
        board = Board(Vocabulary(), robot="ring")
        robot = ring_robot(laser=laser)
        board.post(ROBOT, robot, source="robot")
        reads = (ROBOT, ODOMETRY, SONAR_SCAN, LASER_SCAN, BUMPER)
        return Bench(board=board, access=Access(board, "tested", reads, ()), robot=robot)

    return make


@pytest.fixture
def bench(make_bench: Callable[..., Bench]) -> Bench:
    return make_bench()
