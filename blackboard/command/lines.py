"""`ski lines FILE`: find the lines in a map of points, and compare them with those that the file has already."""

import argparse
from pathlib import Path

from blackboard.command.execute import add_run_options, execute
from blackboard.command.mission_options import add_mission_options, load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "points", type=Path, help="an ARIA map (.map, plain or gzipped), or a text or CSV file of x and y in metres"
    )
    parser.add_argument(
        "--mission",
        default="lines-of-points",
        help="a mission whose robot is a file of points (default: lines-of-points)",
    )
    add_mission_options(parser, mission=False)
    add_run_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    mission = load(options, {"path": str(options.points.absolute())})
    return execute(mission, options, f"lines of {options.points.name}")
