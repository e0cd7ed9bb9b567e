"""What gets in a robot's way: a chair ahead of it, a person in a passage for a minute, a door that closes; never upon the robot."""

from math import hypot
from pathlib import Path

import numpy as np
import pytest
import shapely

from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Drive
from sim.disturbances import AHEAD_M, CHAIR_M, EARLIEST_S, S_PER_M2, STANDS_S, Disturber
from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams
from sim.world_by_name import load_world

ROOMS = """[floor]
outline = [[0, 0], [8, 0], [8, 4], [0, 4], [0, 0]]
[start]
x_m = 1.0
y_m = 2.0
[[wall]]
line = [[4, 0], [4, 1.5]]
thickness_m = 0.1
[[wall]]
line = [[4, 2.4], [4, 4]]
thickness_m = 0.1
"""
LATEST_S = EARLIEST_S + S_PER_M2 * 32
GOING = Drive(forward_mps=0.4, turn_radps=0.0, limited_by="nothing")


@pytest.fixture
def rooms(tmp_path: Path) -> Path:
    path = tmp_path / "rooms.toml"
    path.write_text(ROOMS)
    return path


def disturber(rooms: Path, kind: str, seed: int) -> Disturber:
    return Disturber((kind,), load_world(rooms), 0.3, 0.5, np.random.default_rng(seed))  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(5))
def test_a_chair_comes_ahead_of_a_robot_that_drives(rooms: Path, seed: int) -> None:
    world, one = load_world(rooms), disturber(rooms, "chair", seed)
    here = Pose(x_m=1.0, y_m=2.0, heading_rad=0.0)
    one.notice(LATEST_S, here, 0.1, world)
    assert one.version == 0  # it does not go anywhere
    one.notice(LATEST_S, Pose(x_m=3.2, y_m=1.0, heading_rad=0.0), 0.4, world)
    assert one.version == 0  # there is a wall
    one.notice(EARLIEST_S - 1.0, here, 0.4, world)
    assert one.version == 0
    one.notice(LATEST_S, here, 0.4, world)
    assert one.version == 1
    ((x, y, radius),) = one.standing_in(world).circles
    assert (x, y, radius) == pytest.approx((1.0 + 0.3 + AHEAD_M + CHAIR_M, 2.0, CHAIR_M))
    one.notice(LATEST_S + 1e4, here, 0.4, world)
    assert one.version == 1  # once, and for good


def test_a_person_stands_in_the_doorway_for_a_minute_and_keeps_away_from_the_robot(rooms: Path) -> None:
    world, one = load_world(rooms), disturber(rooms, "person", 1)
    one.notice(LATEST_S, Pose(x_m=4.9, y_m=2.0, heading_rad=0.0), 0.0, world)
    assert one.version == 0
    one.notice(LATEST_S + 5.0, Pose(x_m=6.0, y_m=2.0, heading_rad=0.0), 0.0, world)
    ((x, y, _),) = one.standing_in(world).circles
    assert hypot(x - 4.0, y - 1.95) < 0.1
    one.notice(LATEST_S + 4.0 + STANDS_S, Pose(x_m=6.0, y_m=2.0, heading_rad=0.0), 0.0, world)
    assert len(one.standing_in(world).circles) == 1
    one.notice(LATEST_S + 5.0 + STANDS_S, Pose(x_m=6.0, y_m=2.0, heading_rad=0.0), 0.0, world)
    assert len(one.standing_in(world).circles) == 0


def test_a_door_closes_for_good_but_not_on_the_robot(rooms: Path) -> None:
    world, one = load_world(rooms), disturber(rooms, "door", 1)
    one.notice(LATEST_S, Pose(x_m=4.2, y_m=1.95, heading_rad=0.0), 0.4, world)
    assert one.version == 0
    one.notice(LATEST_S, Pose(x_m=5.0, y_m=1.95, heading_rad=0.0), 0.4, world)
    closed = one.standing_in(world)
    assert len(shapely.get_parts(closed.free)) == 2
    assert "door" in one.told()
    assert len(shapely.get_parts(world.free)) == 1


def test_a_person_and_a_door_in_one_passage_come_one_after_the_other(rooms: Path) -> None:
    for seed in range(8):
        world = load_world(rooms)
        one = Disturber(("person", "door"), world, 0.3, 0.5, np.random.default_rng(seed))
        for tick in range(200):
            one.notice(float(tick), Pose(x_m=1.0, y_m=2.0, heading_rad=0.0), 0.0, world)
            there = one.standing_in(world)
            assert not (len(there.circles) and len(shapely.get_parts(there.free)) == 2)
        assert "did not come" not in one.told()


def test_times_and_places_are_drawn_with_the_seed_and_each_kind_has_its_own(rooms: Path) -> None:
    def told(kinds: list[str], seed: int) -> str:
        world = load_world(rooms)
        one = Disturber(kinds, world, 0.3, 0.5, np.random.default_rng(seed))  # type: ignore[arg-type]
        for tick in range(2000):
            one.notice(tick / 10, Pose(x_m=1.0, y_m=2.0, heading_rad=0.0), 0.4, world)
        return one.told()

    assert told(["chair", "person", "door"], 3) == told(["chair", "person", "door"], 3)
    assert told(["door"], 3) in told(["chair", "door"], 3)
    assert len({told(["person"], seed) for seed in range(6)}) == 6


def test_it_stands_there_and_stops_the_robot(rooms: Path) -> None:
    params = SimulatedRobotParams(world=rooms, robot=Path("pioneer"), disturbances=("chair", "door"))
    robot = SimulatedRobot(params, name="robot", seed=2)
    for _ in range(2):
        robot.drive(GOING)
        for tick in range(int(LATEST_S) + 5):
            list(robot.advance(float(tick)))
            if robot.true_pose().x_m > 2.0:
                robot.drive(Drive(forward_mps=-0.4, turn_radps=0.0, limited_by="nothing"))
            elif robot.true_pose().x_m < 1.0:
                robot.drive(GOING)
        told = robot.summary()["disturbances"]
        assert "did not come" not in str(told)
        assert len(shapely.get_parts(shapely.difference(robot.truth().floor, robot.truth().solid))) == 2
        robot.reset()
        assert shapely.Point(4.0, 1.95).disjoint(robot.truth().solid)


def test_without_them_nothing_is_said_of_them(rooms: Path) -> None:
    robot = SimulatedRobot(SimulatedRobotParams(world=rooms), name="robot", seed=2)
    assert "disturbances" not in robot.summary()
