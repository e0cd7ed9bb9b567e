"""`ski run MISSION`: run a mission to its end, with a picture and a table."""

import argparse

from blackboard.command.execute import add_run_options, execute
from blackboard.command.execute_team import execute_team
from blackboard.command.mission_options import add_mission_options, load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    add_mission_options(parser)
    add_run_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    mission = load(options)
    return execute_team(mission, options) if mission.team else execute(mission, options)
