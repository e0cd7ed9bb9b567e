"""Floor plans from a seed: the same again, rooms that hang together, doors that a robot fits through, furniture."""

from pathlib import Path

import numpy as np
import pytest
import shapely

from blackboard.errors import MissionError
from sim.random_world import NARROWEST_M, ROBOT_M, random_world
from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams
from sim.world_by_name import load_world

SEEDS = range(25)


def test_the_same_seed_gives_the_same_world_and_another_another() -> None:
    for seed in (0, 7):
        one, again = random_world(seed), random_world(seed)
        assert shapely.equals_exact(one.free, again.free)
        assert np.array_equal(one.circles, again.circles)
        assert np.array_equal(one.shapes.segments.rough, again.shapes.segments.rough)
    assert len({random_world(seed).floor.wkt for seed in SEEDS}) == len(SEEDS)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_robot_gets_into_every_room(seed: int) -> None:
    world = random_world(seed)
    room = shapely.buffer(world.open_floor(), -(ROBOT_M - 0.01))
    large = [part for part in shapely.get_parts(room) if part.area > 0.05]
    assert len(large) == 1
    assert large[0].area > 0.25 * world.floor.area
    start = world.start_pose(None, ROBOT_M)
    assert large[0].contains(shapely.Point(start.x_m, start.y_m))
    x_min, y_min, x_max, y_max = world.floor.bounds
    corners = [(x_min, y_min), (x_max, y_min), (x_min, y_max), (x_max, y_max)]
    assert all(large[0].distance(shapely.Point(corner)) < NARROWEST_M for corner in corners)


def test_worlds_differ_in_rooms_and_hold_furniture() -> None:
    worlds = [random_world(seed) for seed in SEEDS]
    assert sum(len(world.circles) for world in worlds) > len(worlds)
    covered = [1.0 - world.open_floor().area / world.floor.area for world in worlds]
    assert 0.03 < min(covered) < max(covered) < 0.3
    assert any(world.shapes.segments.rough.any() for world in worlds)


def test_a_robot_is_tried_in_one_by_name_and_seed() -> None:
    params = SimulatedRobotParams(world=Path("random"), world_seed=3)
    robot = SimulatedRobot(params, name="robot", seed=1)
    assert list(robot.advance(1.0))
    assert robot.truth().floor.equals(load_world(Path("random"), 3).floor)
    with pytest.raises(MissionError, match="world_seed = -1"):
        SimulatedRobotParams(world_seed=-1)
