"""`ski rules cover OUT...`: which rules fired how often in these runs, and which never."""

import argparse
import json
import sys
from pathlib import Path

from blackboard.errors import RecordingError
from blackboard.journal import read_journal
from rules.explaining.coverage import coverage, rules_of_run, told


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("folders", nargs="+", type=Path, metavar="OUT", help="the output folder of a run")
    parser.add_argument("--json", action="store_true", help="print the counts as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    runs = []
    for folder in options.folders:
        run = rules_of_run(read_journal(folder))
        if run is None:
            sys.stderr.write(f"ski: {folder}: no rules decided in this run; it is left out\n")
        else:
            runs.append(run)
    if not runs:
        raise RecordingError("no rules decided in any of these runs; name those of missions with [rules]")
    files = coverage(runs)
    if options.json:
        found = [
            {"file": rule.file, "line": rule.line, "rule": rule.rule, "firings": rule.firings, "runs": rule.runs}
            for file in files
            for rule in file.rules
        ]
        sys.stdout.write(json.dumps({"runs": len(runs), "rules": found}, indent=2) + "\n")
    else:
        sys.stdout.write("\n".join(told(files, len(runs))) + "\n")
    return 0
