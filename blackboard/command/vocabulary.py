"""`ski vocabulary`: every kind of entry, with its JSON Schema."""

import argparse
import json
import sys

from blackboard.vocabulary import Vocabulary


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("path", nargs="?", help="print the schema of one kind, e.g. observations/signal/sonar_scan")
    parser.add_argument("--json", action="store_true", help="print all schemas as one JSON object, by path")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    vocabulary = Vocabulary()
    if options.path:
        kind = vocabulary.at(options.path)
        sys.stdout.write(json.dumps(vocabulary.schemas()[kind.path], indent=2) + "\n")
    elif options.json:
        sys.stdout.write(json.dumps(vocabulary.schemas(), indent=2) + "\n")
    else:
        width = max(len(kind.path) for kind in vocabulary) + 5
        for kind in vocabulary:
            path = kind.path + ("/<id>" if kind.collection else "")
            sys.stdout.write(f"{path:{width}}  {kind.type.__name__:18}  {kind.doc}\n")
        sys.stdout.write("\n`ski vocabulary PATH` prints a kind's JSON Schema, `ski vocabulary --json` all of them.\n")
    return 0
