"""`ski ps`: the processes of what is up: where they run, how they fare, and whether the board misses anything of theirs."""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from blackboard.command.connection import add_connection_options, link_params
from blackboard.command.process_table import BAD, COLOURS
from blackboard.link.session import open_session
from blackboard.processes.ground import agents_at, keeper_may_be, keeper_status
from blackboard.processes.listing import Row, rows_of
from blackboard.processes.protocol import this_machine
from blackboard.processes.state_folder import StateFolder

WIDE = 150  # columns where the output is no terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    add_connection_options(parser)
    parser.add_argument("--json", action="store_true", help="print them as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    link = link_params(options)
    records = StateFolder(link.address).records()
    if keeper_may_be(link):
        with open_session(link) as session:
            rows = rows_of(keeper_status(session, link.address), agents_at(session), records, this_machine())
    else:
        rows = rows_of(None, (), records, this_machine())
        if records:
            sys.stderr.write(
                f"ski: no keeper answers at {link.address}; what was started on this machine and still runs:\n"
            )
        else:
            sys.stderr.write(f"ski: nothing is up at {link.address}; `ski up MISSION` starts something\n")
    if options.json:
        sys.stdout.write(json.dumps([asdict(row) for row in rows], indent=2) + "\n")
    elif rows:
        Console(width=None if sys.stdout.isatty() else WIDE).print(table_of(rows))
    return 0


def table_of(rows: Sequence[Row]) -> Table:
    """Return rows as a table."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    robots = {row.robot for row in rows if row.robot}
    for name in ("process", *(("robot",) if len(robots) > 1 else ()), "machine", "state"):
        table.add_column(name, no_wrap=True)
    for name in ("pid", "restarts", "cpu s", "age s", "beat s", "offset ms", "missing"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("detail")
    for row in rows:
        colour = COLOURS.get(row.state, "green" if row.state == "alive" else BAD)
        table.add_row(
            row.process,
            *((row.robot,) if len(robots) > 1 else ()),
            row.machine,
            Text(row.state, style=colour),
            _number(row.pid, 0),
            _number(row.restarts, 0),
            _number(row.cpu_s, 1),
            _number(row.age_s, 0),
            _number(row.beat_age_s, 1),
            _number(row.offset_s * 1000.0 if row.offset_s is not None else None, 1),
            Text(_number(row.missing, 0), style=BAD if row.missing else ""),
            row.detail,
        )
    return table


def _number(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"
