"""`ski watch [PATTERN]`: a table of what is on the board and what comes, in the terminal, until it is interrupted."""

import argparse
import json
import sys
import time
from contextlib import suppress

from rich.console import Console, Group
from rich.live import Live

from blackboard.command.arguments import seconds
from blackboard.command.connection import add_connection_options, link_params
from blackboard.link.session import Session, open_session
from blackboard.vocabulary import Vocabulary
from blackboard.watching.listening import Listener
from blackboard.watching.patterns import EVERYTHING, expression_of
from blackboard.watching.table import Row, Traffic
from blackboard.watching.table_view import SORTS, TITLE_LINES, sorted_rows, table_of

REDRAW_S = 0.5
ONCE_S = 2.0  # twenty entries of a 10 Hz stream: enough for a rate
WIDE = 120  # columns where the output is no terminal
FOLD_FROM = (7, 4, 2)  # so many members of a collection share a row; fewer where the terminal is low


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "pattern",
        nargs="?",
        default=EVERYTHING,
        metavar="PATTERN",
        help="a key or key expression, e.g. 'observations/**' (default: all)",
    )
    parser.add_argument("--sort", choices=SORTS, default="key", help="what stands above (default: %(default)s)")
    parser.add_argument("--all", action="store_true", help="a row for each member of a collection")
    parser.add_argument("--once", action="store_true", help="look for --for seconds, print the table, and end")
    parser.add_argument("--for", dest="duration_s", type=seconds, metavar="S", help="end after so many seconds")
    parser.add_argument("--json", action="store_true", help="as --once, printed as JSON")
    add_connection_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    expression = expression_of(options.pattern)
    with open_session(link_params(options)) as session:
        watch = _Watch(session, expression, options)
        if options.json or options.once:
            watch.listen(time.monotonic() + (options.duration_s or ONCE_S))
            watch.print()
        else:
            with suppress(KeyboardInterrupt):
                watch.live()
    return 0


class _Watch:
    """What was seen, and how it is shown."""

    def __init__(self, session: Session, expression: str, options: argparse.Namespace) -> None:
        self._options = options
        self._traffic = Traffic(Vocabulary(), began_s=time.monotonic())
        self._listener = Listener(session, expression)  # first, so that nothing is missed between
        for answer in session.ask(expression):
            if not answer.error:
                self._traffic.stood(answer.key, answer.payload, answer.attachment, time.monotonic())

    def listen(self, end_s: float) -> None:
        """Take note of what comes until `end_s`."""
        for arrived in self._listener.until(end_s):
            if arrived is not None:
                self._traffic.came(arrived.key, arrived.payload, arrived.attachment, time.monotonic())

    def print(self) -> None:
        """Print the table once."""
        at_s = time.monotonic()
        if self._options.json:
            rows = sorted_rows(self._traffic.rows(at_s), self._options.sort)
            clock_s = self._traffic.clock_s(at_s)
            table = {"clock_s": clock_s, "entries": self._traffic.entries, "rows": [row.as_dict() for row in rows]}
            sys.stdout.write(json.dumps(table, indent=2) + "\n")
        else:
            console = Console()
            console = console if console.is_terminal else Console(width=WIDE)
            console.print(self._table(at_s, console.width, None))

    def live(self) -> None:
        """Show the table until the time is up."""
        console = Console()
        end_s = None if self._options.duration_s is None else time.monotonic() + self._options.duration_s
        with Live(console=console, auto_refresh=False, screen=console.is_terminal) as live:
            while end_s is None or time.monotonic() < end_s:
                live.update(self._table(time.monotonic(), console.width, console.height), refresh=True)
                self.listen(min(time.monotonic() + REDRAW_S, end_s or float("inf")))

    def _rows(self, at_s: float, height: int | None) -> list[Row]:
        """Return the rows with as many members of collections on their own as there is room for."""
        if self._options.all:
            return self._traffic.rows(at_s)
        rows: list[Row] = []
        for fold_from in FOLD_FROM:
            rows = self._traffic.rows(at_s, fold_from=fold_from)
            if height is None or len(rows) + TITLE_LINES <= height:
                break
        return rows

    def _table(self, at_s: float, width: int, height: int | None) -> Group:
        rows = sorted_rows(self._rows(at_s, height), self._options.sort)
        clock_s = self._traffic.clock_s(at_s)
        words = [
            self._options.connect if self._listener.connected else f"{self._options.connect} is gone; waiting for it",
            "nothing has come yet" if clock_s is None else f"clock {clock_s:.1f} s",
            f"{self._traffic.rate_hz(at_s):.0f} entries/s",
        ]
        if self._listener.dropped:
            words.append(f"{self._listener.dropped} came too fast to be counted")
        return table_of(rows, "  ".join(words), width, height)
