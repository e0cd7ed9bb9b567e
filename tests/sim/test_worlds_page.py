"""The world on the documentation's page is one that can be run."""

import re
from pathlib import Path

from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams

PAGE = Path(__file__).resolve().parents[2] / "docs/worlds-and-robots.md"


def test_the_world_on_the_page(tmp_path: Path) -> None:
    blocks = re.findall(r"```toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    world = tmp_path / "room.toml"
    world.write_text(next(block for block in blocks if block.startswith("[floor]")))
    robot = SimulatedRobot(SimulatedRobotParams(world=world, people=True), name="robot")
    assert list(robot.advance(1.0))
