"""`ski echo [PATTERN]`: print entries as they come, one line each."""

import argparse
import sys
import time

import msgspec

from blackboard.command.arguments import count, seconds
from blackboard.command.connection import add_connection_options, link_params
from blackboard.link.session import Arrived, open_session
from blackboard.watching.listening import Listener
from blackboard.watching.patterns import EVERYTHING, expression_of
from blackboard.watching.summary import printable, summarise


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "pattern",
        nargs="?",
        default=EVERYTHING,
        metavar="PATTERN",
        help="a key or key expression, e.g. commands/drive or 'hypotheses/**' (default: all)",
    )
    parser.add_argument("--count", type=count, metavar="N", help="end after so many")
    parser.add_argument("--for", dest="duration_s", type=seconds, metavar="S", help="end after so many seconds")
    parser.add_argument("--json", action="store_true", help="print entries whole, one JSON object a line")
    add_connection_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    expression = expression_of(options.pattern)
    with open_session(link_params(options)) as session:
        listener = Listener(session, expression)
        end_s = time.monotonic() + options.duration_s if options.duration_s is not None else None
        printed, linked = 0, True
        for arrived in listener.until(end_s):
            if arrived is None:
                if listener.connected != linked:
                    linked = not linked
                    told = "is back" if linked else "is gone; waiting for it"
                    sys.stderr.write(f"ski: the keeper at {options.connect} {told}\n")
                continue
            sys.stdout.write((_json_line if options.json else _line)(arrived) + "\n")
            sys.stdout.flush()
            printed += 1
            if printed == options.count:
                break
        if listener.dropped:
            sys.stderr.write(f"ski: {listener.dropped} more came too fast to be printed; a narrower PATTERN helps\n")
    return 0


def _line(arrived: Arrived) -> str:
    return f"{printable(arrived.key)} {summarise(arrived.payload)}"


def _json_line(arrived: Arrived) -> str:
    """Return an entry as a line of `board.jsonl`; of what is none, its key and size."""
    try:
        return msgspec.json.format(arrived.payload, indent=-1).decode()
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return msgspec.json.encode({"key": arrived.key, "bytes": len(arrived.payload), "problem": "no JSON"}).decode()
