"""The table at the end of a run, for people and as JSON; units are read off the names (`distance_m`: "distance 12.3 m")."""

import json
from collections.abc import Mapping
from math import degrees, isfinite

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

Value = float | int | str

UNITS = (  # suffix, unit, decimals; the longer suffix first where one ends in another
    ("_mps", "m/s", 2),
    ("_m2", "m²", 1),
    ("_mb", "MB", 1),
    ("_ms", "ms", 2),
    ("_m", "m", 2),
    ("_deg", "°", 1),
    ("_hz", "Hz", 1),
    ("_s", "s", 1),
)


def describe(name: str, value: Value) -> tuple[str, str]:
    """Return what a row shows: words for the name, and the value with its unit."""
    if name.endswith("_rad") and isinstance(value, float):
        name, value = name.removesuffix("_rad") + "_deg", degrees(value)
    if name.endswith("_fraction") and isinstance(value, int | float):
        return _words(name.removesuffix("_fraction")), f"{100.0 * value:.1f} %"
    for suffix, unit, decimals in UNITS:
        if name.endswith(suffix) and isinstance(value, int | float):
            shown = f"{value:,}" if isinstance(value, int) else f"{value:,.{decimals}f}"
            return _words(name.removesuffix(suffix)), f"{shown}{'' if unit == '°' else ' '}{unit}"
    if isinstance(value, str):
        return _words(name), value
    return _words(name), f"{value:,}" if isinstance(value, int) else f"{value:,.3g}"


def end_table(table: Mapping[str, Value], title: str) -> Table:
    """Return the rich table of all rows, in the order given."""
    shown = Table(title=Text(title), title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, show_header=False)
    shown.add_column(style="dim", no_wrap=True)
    shown.add_column(justify="right", overflow="fold")
    for name, value in table.items():
        shown.add_row(*(Text(part) for part in describe(name, value)))
    return shown


def show_table(table: Mapping[str, Value], title: str, console: Console | None = None) -> None:
    """Show the table on standard output, or on the console given."""
    (console or Console()).print(end_table(table, title))


def table_json(table: Mapping[str, Value]) -> str:
    """Return the same rows as a JSON object; a number that is not finite becomes null, as JSON has none."""
    rows = {name: None if isinstance(v, float) and not isfinite(v) else v for name, v in table.items()}
    return json.dumps(rows, indent=2, ensure_ascii=False)


def _words(name: str) -> str:
    return name.replace("_", " ")
