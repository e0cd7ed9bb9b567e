"""`ski run MISSION`: run a mission to its end, with a picture and a table."""

import argparse

from blackboard.command.execute import add_run_options, execute
from blackboard.command.mission_options import add_mission_options, load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    add_mission_options(parser)
    add_run_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    return execute(load(options), options)
