"""`ski rules why-not RULE [--in DIR] [--at S]`: which condition kept a rule from firing then."""

import argparse
import json
import sys

from blackboard.command.run_folder import add_run_folder, run_folder, stamp
from blackboard.errors import did_you_mean
from blackboard.journal import in_stamp_order, read_journal
from blackboard.mission import find_mission, load_mission
from rules.checks.parts import parts_of
from rules.explaining.record import situation
from rules.explaining.told import as_dict, told
from rules.explaining.why_not import why_not
from rules.language.errors import RuleError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("rule", help="the name of a rule")
    add_run_folder(parser)
    parser.add_argument("--at", type=stamp, metavar="S", help="as of this stamp (seconds); default: the run's end")
    parser.add_argument("--mission", metavar="NAME", help="the mission of the run, where it has kinds of its own")
    parser.add_argument("--json", action="store_true", help="print the answer as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    mission = load_mission(find_mission(options.mission)) if options.mission is not None else None
    vocabulary = parts_of(mission).vocabulary if mission is not None else None
    then = situation(in_stamp_order(read_journal(run_folder(options))), options.at, vocabulary)
    rules = {rule.name: rule for rule in then.program.rules}
    if options.rule not in rules:
        raise RuleError(f"no rule '{options.rule}' was in force{did_you_mean(options.rule, rules)}")
    verdict = why_not(then.program, rules[options.rule], then.facts)
    if options.json:
        sys.stdout.write(json.dumps(as_dict(verdict, then), indent=2) + "\n")
    else:
        sys.stdout.write("\n".join(told(verdict, then)) + "\n")
    return 0
