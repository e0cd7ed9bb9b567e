"""The table of what comes, for a terminal."""

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from blackboard.watching.summary import size_words
from blackboard.watching.table import Row

SORTS = ("key", "rate", "age", "size")
STALE_S = 2.0  # of a stream that has come before: shown faint from then on


def sorted_rows(rows: Sequence[Row], by: str) -> list[Row]:
    """Return the rows by key, or with the highest rate, the youngest or the largest first."""
    if by == "rate":
        return sorted(rows, key=lambda row: (-row.rate_hz, row.key))
    if by == "age":
        return sorted(rows, key=lambda row: (row.age_s is None, row.age_s or 0.0, row.key))
    if by == "size":
        return sorted(rows, key=lambda row: (-row.size_bytes, row.key))
    return sorted(rows, key=lambda row: row.key)


def age_words(age_s: float | None) -> str:
    """Return an age for people: 0.3 s, 42 s, 7 min, 3 h."""
    if age_s is None:
        return "-"
    if age_s < 9.95:
        return f"{age_s:.1f} s"
    if age_s < 119.5:
        return f"{age_s:.0f} s"
    return f"{age_s / 60:.0f} min" if age_s < 7170 else f"{age_s / 3600:.0f} h"


def rate_words(rate_hz: float) -> str:
    """Return a rate for people: 10.0, 0.2, or nothing where nothing came."""
    if rate_hz <= 0:
        return ""
    return f"{rate_hz:.1f}" if rate_hz >= 0.095 else f"{rate_hz:.2f}"


def table_of(rows: Sequence[Row], title: str, height: int | None = None) -> Table:
    """Return the rows as a table of at most `height` lines; what does not fit is counted below."""
    table = Table(box=None, pad_edge=False, title=title, title_justify="left", title_style="bold", header_style="bold")
    table.add_column("key", overflow="ellipsis", no_wrap=True, ratio=None)
    table.add_column("kind", overflow="ellipsis", no_wrap=True)
    table.add_column("source", overflow="ellipsis", no_wrap=True)
    table.add_column("host", overflow="ellipsis", no_wrap=True)
    table.add_column("rate /s", justify="right", no_wrap=True)
    table.add_column("age", justify="right", no_wrap=True)
    table.add_column("size", justify="right", no_wrap=True)
    most = len(rows) if height is None else max(1, height - 3)
    for row in rows if len(rows) <= most else rows[: most - 1]:
        members = f" ({row.members})" if row.members > 1 else ""
        table.add_row(
            Text(row.key.removeprefix("ski/") + members),
            Text(row.type),
            Text(row.source),
            Text(row.host),
            rate_words(row.rate_hz),
            age_words(row.age_s),
            size_words(row.size_bytes),
            style="dim" if not row.rate_hz and (row.age_s is None or row.age_s > STALE_S) else "",
        )
    if len(rows) > most:
        table.add_row(Text(f"... and {len(rows) - most + 1} more; a PATTERN shows fewer"), *[""] * 6, style="dim")
    return table
