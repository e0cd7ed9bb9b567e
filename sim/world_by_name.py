"""Worlds by name: shipped ones, world files, ROS maps, and floor plans drawn from a seed."""

from pathlib import Path

from blackboard.errors import MissionError
from sim.random_world import random_world
from sim.ros_map import load_ros_map
from sim.shipped import find_file
from sim.world import World
from sim.world_file import load_world_file

RANDOM = Path("random")


def load_world(name: Path, seed: int = 0) -> World:
    """Return a shipped world, one from a world file or a ROS map, or a random one; raise MissionError where it is wrong."""
    if name == RANDOM:
        return random_world(seed)
    path = find_file(name, "worlds")
    if path.suffix in (".yaml", ".yml"):
        return load_ros_map(path)
    if path.suffix == ".toml":
        return load_world_file(path)
    raise MissionError(f"world file '{path}' is neither a world (.toml) nor a ROS map (.yaml)")
