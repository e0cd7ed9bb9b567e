"""`ski why KEY [--in DIR]`: explain an entry of a run, down to the readings."""

import argparse
import json
import sys
from pathlib import Path

from blackboard.command.run_folder import add_run_folder, run_folder, stamp
from blackboard.journal import read_journal
from blackboard.why import Record, render


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "key", help="a key, e.g. commands/drive or observations/feature/line/3-0; wildcards if one matches"
    )
    add_run_folder(parser)
    parser.add_argument("--at", type=stamp, metavar="S", help="as of this stamp (seconds); default: the last revision")
    parser.add_argument("--depth", type=int, default=12, metavar="N", help="steps down at most (default: %(default)s)")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="also draw the tree: a .png or .svg file")
    parser.add_argument("--json", action="store_true", help="print the tree as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    record = Record(read_journal(run_folder(options)))
    reason = record.explain(record.find(options.key, at_s=options.at), options.depth)
    if options.picture is not None:
        from blackboard.report.why_picture import write_why_picture  # loads matplotlib

        write_why_picture(reason, options.picture)
    if options.json:
        sys.stdout.write(json.dumps(reason.as_dict(), indent=2) + "\n")
    else:
        sys.stdout.write("\n".join(render(reason)) + "\n")
    return 0
