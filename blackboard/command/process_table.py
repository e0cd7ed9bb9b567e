"""Processes as rows of a table, for `ski up` and `ski ps`."""

from collections.abc import Iterable

from rich import box
from rich.table import Table
from rich.text import Text

from blackboard.processes.protocol import ProcessReport

COLOURS = {"running": "green", "done": "green", "starting": "yellow", "waiting": "yellow", "stopping": "yellow"}
BAD = "bold red"


def process_table(processes: Iterable[ProcessReport], title: str) -> Table:
    """Return a table of processes."""
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("process", "machine", "state"):
        table.add_column(name, no_wrap=True)
    for name in ("pid", "restarts", "cpu s", "age s", "beat s"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("last end")
    for process in processes:
        table.add_row(
            process.name,
            process.machine,
            Text(process.state, style=COLOURS.get(process.state, BAD)),
            str(process.pid or ""),
            str(process.restarts or ""),
            _number(process.cpu_s, 1),
            _number(process.age_s if process.pid else None, 0),
            _number(process.silent_s, 1),
            last_end(process),
        )
    return table


def last_end(process: ProcessReport) -> str:
    """Return how a process ended last; empty where it never did."""
    if process.signal is not None:
        how = f"signal {process.signal}"
    elif process.code is not None:
        how = f"exit {process.code}"
    else:
        return process.last_line
    return f"{how}: {process.last_line}" if process.last_line and process.code != 0 else how


def _number(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"
