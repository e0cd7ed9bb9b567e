"""`ski get [PATTERN]`: print what stands on the board, as the keeper has it."""

import argparse
import json
import sys

import msgspec

from blackboard.command.connection import add_connection_options, link_params
from blackboard.errors import LinkError
from blackboard.link.session import Answer, open_session
from blackboard.watching.patterns import EVERYTHING, expression_of
from blackboard.watching.summary import printable, summarise

TIMEOUT_S = 10.0  # a board of 10,000 entries takes a fraction of a second


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "pattern",
        nargs="?",
        default=EVERYTHING,
        metavar="PATTERN",
        help="a key or key expression, e.g. commands/drive or 'hypotheses/**' (default: all)",
    )
    parser.add_argument("--json", action="store_true", help="print the entries whole, as a JSON list")
    add_connection_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    expression = expression_of(options.pattern)
    with open_session(link_params(options)) as session:
        answers = session.ask(expression, timeout_s=TIMEOUT_S)
    refused = next((answer.error for answer in answers if answer.error), None)
    if refused is not None:
        raise LinkError(f"the keeper refused to answer: {printable(refused)}")
    found = sorted(answers, key=lambda answer: answer.key)
    if options.json:
        sys.stdout.write(json.dumps([_plain(answer) for answer in found], indent=2) + "\n")
    else:
        sys.stdout.writelines(f"{printable(a.key)} {summarise(a.payload)}\n" for a in found)
    if not found:
        hint = "" if options.pattern == EVERYTHING else "; `ski get` without a PATTERN shows all there is"
        sys.stderr.write(f"ski: nothing stands at {expression}{hint}\n")
    return 0 if found else 1


def _plain(answer: Answer) -> object:
    try:
        return msgspec.json.decode(answer.payload)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return {"key": answer.key, "bytes": len(answer.payload), "problem": "no JSON"}
