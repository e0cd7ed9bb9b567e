"""The arguments that choose a mission and change it, shared by the verbs that take one."""

import argparse
import os
from pathlib import Path
from typing import Any

from blackboard.errors import MissionError
from blackboard.mission import Mission, find_mission, load_mission, parse_settings, shipped_missions


def add_mission_options(parser: argparse.ArgumentParser, *, mission: bool = True) -> None:
    """Declare the mission's name and what may be laid over its file. `SKI_SEED`, `SKI_WORLD` and `SKI_ROBOT` are defaults."""
    if mission:
        known = ", ".join(shipped_missions())
        parser.add_argument("mission", help=f"a shipped mission ({known}) or a .toml file")
        parser.add_argument(
            "--world",
            default=os.environ.get("SKI_WORLD"),
            help="a shipped world, a world.toml, a ROS map.yaml, or random",
        )
    parser.add_argument("--robot", default=os.environ.get("SKI_ROBOT"), help="a shipped robot or a robot.toml")
    parser.add_argument(
        "--seed", type=_seed, default=os.environ.get("SKI_SEED", "0"), help="seed of all random numbers"
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="set a parameter, e.g. eou_grid.cell_m=0.1 (repeatable)",
    )


def load(options: argparse.Namespace, robot: dict[str, Any] | None = None) -> Mission:
    """Load the mission that the options choose; `robot` holds more parameters for the robot's table."""
    settings = parse_settings(options.set)
    over = {**(robot or {}), **robot_settings(options)}
    if over:
        settings["robot"] = {**settings.get("robot", {}), **over}
    return load_mission(find_mission(options.mission), settings)


def robot_settings(options: argparse.Namespace) -> dict[str, str]:
    """Return what --world and --robot lay over the robot's table."""
    given = {name: getattr(options, name, None) for name in ("world", "robot")}
    return {name: _file(value) for name, value in given.items() if value is not None}


def _file(name: str) -> str:
    """Return a bare name as it is, and a path as seen from the current folder."""
    path = Path(name)
    return name if len(path.parts) == 1 and not path.suffix else str(path.absolute())


def _seed(text: str) -> int:
    seed = int(text)
    if seed < 0:
        raise MissionError(f"--seed {seed}: must be 0 or more")
    return seed
