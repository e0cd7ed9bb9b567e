"""The table of what comes, for a terminal."""

from collections.abc import Sequence

from rich.console import Group
from rich.table import Table
from rich.text import Text

from blackboard.watching.summary import size_words
from blackboard.watching.table import Row

SORTS = ("key", "rate", "age", "size")
TITLE_LINES = 2
GAP = 2  # letters between two columns
TEXTS = {"key": 80, "kind": 18, "source": 20, "host": 18}  # columns, and how many letters they have at most
NUMBERS = {"rate /s": 7, "age": 6, "size": 7}
KEY_WISHED, KEY_LEAST = 44, 32  # letters that keys need before hosts and kinds, and before sources, get any
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


def table_of(rows: Sequence[Row], title: str, width: int, height: int | None = None) -> Group:
    """Return the rows as a table of at most `width` letters and `height` lines; what does not fit is counted below.

    Where it is narrow, hosts are left out, then kinds: the keys must be told apart.
    """
    most = len(rows) if height is None else max(1, height - TITLE_LINES)
    shown = rows if len(rows) <= most else rows[: most - 1]
    words = [(_key(row), row.type, row.source, row.host) for row in shown]
    widths = _widths([max(map(len, column)) for column in zip(*words, strict=True)] if words else [0, 0, 0, 0], width)
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name, letters in zip(TEXTS, widths, strict=True):
        if letters:
            table.add_column(name, width=letters, no_wrap=True)
    for name, letters in NUMBERS.items():
        table.add_column(name, justify="right", width=letters, no_wrap=True)
    for row, texts in zip(shown, words, strict=True):
        table.add_row(
            *(Text(_cut(text, letters)) for text, letters in zip(texts, widths, strict=True) if letters),
            rate_words(row.rate_hz),
            age_words(row.age_s),
            size_words(row.size_bytes),
            style="dim" if not row.rate_hz and (row.age_s is None or row.age_s > STALE_S) else "",
        )
    if len(rows) > most:
        table.add_row(Text(_cut(f"... {len(rows) - most + 1} more", widths[0])), style="dim")
    return Group(Text(_cut(title, width), style="bold"), table)


def _widths(longest: Sequence[int], width: int) -> list[int]:
    """Return how wide the columns of text may be, 0 for one that is left out."""
    numbers = sum(NUMBERS.values()) + GAP * len(NUMBERS)
    wanted = [max(len(name), min(most, n)) for (name, most), n in zip(TEXTS.items(), longest, strict=True)]
    for dropped, least in (((), KEY_WISHED), ((3,), KEY_WISHED), ((1, 3), KEY_LEAST), ((1, 2, 3), 1)):
        widths = [0 if i in dropped else n for i, n in enumerate(wanted)]
        left = width - numbers - sum(n + GAP for n in widths[1:] if n)
        if left >= min(widths[0], least):
            break
    widths[0] = max(1, min(widths[0], left))
    return widths


def _key(row: Row) -> str:
    return row.key.removeprefix("ski/") + (f" ({row.members})" if row.members > 1 else "")


def _cut(text: str, letters: int) -> str:
    return text if len(text) <= letters else f"{text[: letters - 1]}…"
