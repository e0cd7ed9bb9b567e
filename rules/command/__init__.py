"""`ski rules`: what can be done with rule files. Each sub-verb is a module of this package."""

import argparse
import importlib

SUB_VERBS = {
    "check": "check rule files, or the rules of missions, without running them",
    "cover": "tell which rules fired how often in some runs, and which never",
    "templates": "print the templates that follow from the board's vocabulary",
    "test": "tell stories about rules to an engine: facts in turn, and what must stand after each step",
    "why-not": "tell which condition kept a rule from firing at some time of a run",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the sub-verbs and their arguments."""
    verbs = parser.add_subparsers(dest="sub_verb", metavar="SUB-VERB", required=True)
    for name, text in SUB_VERBS.items():
        below = verbs.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
        module = importlib.import_module(f"rules.command.{name.replace('-', '_')}")
        module.add_arguments(below)
        below.set_defaults(call_sub_verb=module.call)


def call(options: argparse.Namespace) -> int:
    """Run the sub-verb."""
    return int(options.call_sub_verb(options))
