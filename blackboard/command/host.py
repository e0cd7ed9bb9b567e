"""`ski host MISSION --name NAME`: run one host of a mission: its share of the components, on the board that the keeper keeps."""

import argparse
import sys
from pathlib import Path

from blackboard.command.connection import add_connection_options, link_params
from blackboard.command.ending import when_told_to_end
from blackboard.command.mission_options import add_mission_options, load
from blackboard.processes.leashed import end_with_holder

LEASHED_PATIENCE_S = 600.0  # an executor's host that dies while the network is cut is there when it heals


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    add_mission_options(parser)
    add_connection_options(parser)
    parser.add_argument("--name", required=True, help="which of the mission's hosts")
    parser.add_argument("--pace", type=float, default=1.0, help="mission seconds per second (the robot's host decides)")
    parser.add_argument("--state", type=Path, metavar="DIR", help="folder for what must outlive a kill of this process")
    parser.add_argument("--machine", default="", help="what this machine is called (default: its own name)")
    parser.add_argument("--strict", action="store_true", help="stop at the first component that raises")
    parser.add_argument("--leashed", action="store_true", help="end when standard input ends")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    from blackboard.link.host import Host, HostOptions

    sys.setswitchinterval(0.0005)  # arrivals must not wait for a long computation's time slice
    host = Host(
        load(options),
        options.name,
        HostOptions(
            link=link_params(options),
            seed=options.seed,
            pace=options.pace,
            state=options.state,
            strict=options.strict,
            machine=options.machine,
            patience_s=LEASHED_PATIENCE_S if options.leashed else 0.0,
        ),
    )
    if options.leashed:
        end_with_holder()
    with when_told_to_end(host.stop):
        host.run()
    return 0
