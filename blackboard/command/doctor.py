"""`ski doctor [MISSION]`: find what is wrong with a running setup, and say what to do."""

import argparse
import json
import sys

from blackboard.command.arguments import seconds
from blackboard.command.connection import add_connection_options, link_params
from blackboard.mission import find_mission, load_mission
from blackboard.watching.findings import findings
from blackboard.watching.gathering import gather
from blackboard.watching.summary import printable

LISTEN_S = 2.0  # ten beats of every host; a hung host and a missing entry show within one second


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "mission", nargs="?", metavar="MISSION", help="also see that all of this mission's components run"
    )
    parser.add_argument(
        "--for",
        dest="duration_s",
        type=seconds,
        default=LISTEN_S,
        metavar="S",
        help="how long to listen (default: %(default)s)",
    )
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")
    add_connection_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb: 0 where nothing is wrong, 1 where something is."""
    expected: dict[str, str] = {}
    if options.mission is not None:
        from blackboard.watching.declared_graph import hosts_of

        mission = load_mission(find_mission(options.mission))
        coordinator = (
            mission.coordinator.name if mission.coordinator is not None else ""
        )  # it comes with the behaviours
        for robot in [spec.name for spec in mission.team] or [""]:
            hosts = hosts_of(mission, robot)
            expected |= {f"{robot}/{name}": host for name, host in hosts.items() if name != coordinator}
    facts = gather(link_params(options), options.duration_s, expected)
    found = findings(facts)
    if options.json:
        sys.stdout.write(json.dumps([finding.as_dict() for finding in found], indent=2) + "\n")
        return 1 if found else 0
    for finding in found:
        sys.stdout.write(f"{printable(finding.what)}\n    {printable(finding.do)}\n")
    if not found:
        alive = [host.name for host in facts.hosts if host.state == "alive"]
        sys.stdout.write(
            f"Nothing is wrong: the keeper at {facts.address} and {len(alive)} hosts ({', '.join(alive)}).\n"
        )
    return 1 if found else 0
