"""`ski rules ...`: hands over to the package of the rules, which this one does not know."""

import argparse
import importlib
from typing import Any


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the sub-verbs and their arguments."""
    _package().add_arguments(parser)


def call(options: argparse.Namespace) -> int:
    """Run the sub-verb."""
    return int(_package().call(options))


def _package() -> Any:
    return importlib.import_module("rules.command")
