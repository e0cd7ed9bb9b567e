"""`ski map RECORDING`: run a mission, `map-recording` unless told, on a CARMEN log, a ROS 1 bag or a ROS 2 bag."""

import argparse
from pathlib import Path

from blackboard.command.execute import add_run_options, execute
from blackboard.command.mission_options import add_mission_options, load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "recording", type=Path, help="a CARMEN log (plain or gzipped), a ROS 1 bag, a ROS 2 bag (sqlite3, MCAP)"
    )
    parser.add_argument("--cones", type=int, default=None, metavar="N", help="thin the laser to N sonar cones")
    parser.add_argument(
        "--mission", default="map-recording", help="a mission whose robot is a recording (default: map-recording)"
    )
    add_mission_options(parser, mission=False)
    add_run_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    robot = {"path": str(options.recording.absolute())}
    if options.cones is not None:
        robot["cones"] = options.cones
    return execute(load(options, robot), options, f"map of {options.recording.name}")
