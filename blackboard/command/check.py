"""`ski check MISSION`: read a mission, build and wire its components, and say what it is made of, without running it."""

import argparse
import json
import sys

from blackboard.command.mission_options import add_mission_options, load
from blackboard.control import as_triggers
from blackboard.runner import RunOptions
from blackboard.team import Team


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    add_mission_options(parser)
    parser.add_argument("--json", action="store_true", help="print the result as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    mission = load(options)
    runs = list(Team(mission, RunOptions(seed=options.seed)).runs.values())
    run = runs[0]  # all robots have the same components
    facts = {
        "mission": mission.name,
        "file": str(mission.path),
        "description": mission.params.description,
        "robot": ", ".join(each.robot.description.name for each in runs),
        "knowledge_sources": {
            source.name: {
                "rating": source.rating,
                "triggers": [trigger.kind.path for trigger in as_triggers(source)],
                "posts": [kind.path for kind in source.posts],
            }
            for source in sorted(run.sources, key=lambda source: -source.rating)
        },
        "behaviours": {spec.name: {"inhibits": list(spec.wiring.inhibits)} for spec in mission.behaviours},
    }
    if options.json:
        sys.stdout.write(json.dumps(facts, indent=2) + "\n")
        return 0
    write = sys.stdout.write
    write(f"{mission.name}: {mission.params.description}\n  file   {mission.path}\n  robot  {facts['robot']}\n")
    write("knowledge sources, by rating\n")
    for source in sorted(run.sources, key=lambda source: -source.rating):
        triggers = ", ".join(trigger.kind.path for trigger in as_triggers(source))
        write(f"  {source.rating:5g}  {source.name}: {triggers} -> {', '.join(k.path for k in source.posts)}\n")
    if mission.behaviours:
        write("behaviours, highest first\n")
    for spec in mission.behaviours:
        write(
            f"  {spec.name}" + (f" (inhibits {', '.join(spec.wiring.inhibits)})" if spec.wiring.inhibits else "") + "\n"
        )
    write("The mission is sound.\n")
    return 0
