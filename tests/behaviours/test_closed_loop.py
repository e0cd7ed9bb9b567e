"""All behaviours, the coordinator and the safety layer drive simulated robots: nothing is touched, and they get around."""

from math import hypot
from pathlib import Path

import pytest

from blackboard.mission import Mission, load_mission
from blackboard.runner import Run, RunOptions

MISSION = """
[robot]
use = "sim.simulated:SimulatedRobot"
world = "{world}"
robot = "{robot}"
people = true

[[behaviour]]
use = "behaviours.avoid_obstacles:AvoidObstacles"

[[behaviour]]
use = "behaviours.curiosity:Curiosity"
inhibits = ["boundary_following", "random_wander"]

[[behaviour]]
use = "behaviours.boundary_following:BoundaryFollowing"
inhibits = ["random_wander"]

[[behaviour]]
use = "behaviours.random_wander:RandomWander"

[coordinator]
use = "behaviours.superposition:Superposition"
"""


def mission(folder: Path, world: str, robot: str) -> Mission:
    path = folder / "drive.toml"
    path.write_text(MISSION.format(world=world, robot=robot), encoding="utf-8")
    return load_mission(path)


@pytest.mark.parametrize(
    ("world", "robot"), [("lab", "k2a"), ("lab", "pioneer"), ("trap", "k2a"), ("office", "pioneer")]
)
def test_a_minute_without_a_collision(tmp_path: Path, world: str, robot: str) -> None:
    run = Run(mission(tmp_path, world, robot), RunOptions(seed=7, strict=True))
    run.run(60.0)
    summary = run.robot.summary()
    assert summary["collisions"] == 0
    assert float(summary["distance_m"]) > 5.0
    track = run.true_trajectory()
    assert track is not None
    start = track[0]
    assert max(hypot(row[1] - start[1], row[2] - start[2]) for row in track) > 1.5


def test_the_same_seed_drives_the_same_way(tmp_path: Path) -> None:
    def drive() -> bytes:
        run = Run(mission(tmp_path, "lab", "k2a"), RunOptions(seed=3, strict=True))
        run.run(10.0)
        track = run.true_trajectory()
        assert track is not None
        return track.tobytes()

    assert drive() == drive()
