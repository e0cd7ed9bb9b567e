"""Entries and other payloads as one short line each: numbers counted, grids and long lists summed up.

What comes is not trusted: whatever the bytes are, the answer is one printable line of bounded length.
"""

import math
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np

from blackboard.entry import Endorsement, Event, Support
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN
from blackboard.messages.geometry import PackedArray
from blackboard.uncertainty.endorsements import standing

SHOWN_CHARACTERS = 160  # of a value; the rest is cut
SHOWN_TEXT = 60  # of one text in it
SHOWN_ITEMS = 4  # of a list; longer ones are summed up
DEPTH = 3


class SeenEntry(msgspec.Struct, kw_only=True):
    """An entry as it travels, read leniently: what is not known is left alone, the value stays JSON."""

    key: str
    revision: int
    event: Event
    stamp_s: float
    source: str
    value: msgspec.Raw
    supports: tuple[Support, ...] = ()
    endorsements: tuple[Endorsement, ...] = ()


_ENTRY = msgspec.json.Decoder(SeenEntry)


def read_entry(payload: bytes) -> SeenEntry | None:
    """Return the entry that the bytes are; None where they are something else."""
    try:
        return _ENTRY.decode(payload)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None


def summarise(payload: bytes) -> str:
    """Return what the bytes say, whatever they are, in one line."""
    entry = read_entry(payload)
    if entry is not None:
        return summarise_entry(entry)
    try:
        return summarise_value(payload)
    except ValueError:
        return f"{len(payload)} bytes that are no JSON"


def summarise_entry(entry: SeenEntry) -> str:
    """Return revision, stamp, source, value, and how many reasons stand behind it and for and against it."""
    try:
        words = summarise_value(entry.value)
    except ValueError:
        words = f"{len(bytes(entry.value))} bytes that are no JSON"
    gone = " retracted" if entry.event == "retracted" else ""
    behind = f" <- {len(entry.supports)}" if entry.supports else ""
    said = ""
    if entry.endorsements:
        stands = [one.verdict for one in standing(entry.endorsements)]
        said = f" [{stands.count('for')} for, {stands.count('against')} against]"
    return printable(f"r{entry.revision}{gone} at {entry.stamp_s:.2f} s by {entry.source}: {words}{said}{behind}")


def summarise_value(raw: bytes | msgspec.Raw) -> str:
    """Return a JSON value in one line; raise ValueError where it is no JSON."""
    try:
        value = msgspec.json.decode(raw)
        if isinstance(value, dict):
            text = ", ".join(f"{name} {_shown(item, DEPTH)}" for name, item in value.items()) or "{}"
        else:
            text = _shown(value, DEPTH)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(str(error)) from None
    return printable(text if len(text) <= SHOWN_CHARACTERS else f"{text[: SHOWN_CHARACTERS - 3]}...")


def printable(text: str) -> str:
    """Return the text with what would steer a terminal (line breaks, escapes, reversed writing) written out."""
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in text)


def size_words(size_bytes: float) -> str:
    """Return a size for people: 812 B, 4.1 kB."""
    for unit in ("B", "kB", "MB"):
        if size_bytes < 999.5 or unit == "MB":
            break
        size_bytes /= 1000
    return f"{size_bytes:.0f} {unit}" if unit == "B" or size_bytes >= 99.95 else f"{size_bytes:.1f} {unit}"


def _shown(item: object, depth: int) -> str:
    if isinstance(item, dict):
        if {"zlib_base64", "dtype", "shape"} <= item.keys():
            return _array(item)
        if depth == 0:
            return f"{{{len(item)} fields}}"
        return f"({', '.join(f'{name} {_shown(part, depth - 1)}' for name, part in list(item.items())[:20])})"
    if isinstance(item, list):
        return _list(item, depth)
    if isinstance(item, float):
        return f"{item + 0.0:.4g}"  # -0.0 is 0
    if isinstance(item, str):
        return (item if len(item) <= SHOWN_TEXT else f"{item[:SHOWN_TEXT]}... ({len(item)} letters)") or '""'
    if isinstance(item, bool):
        return "yes" if item else "no"
    return "-" if item is None else str(item)


def _number(number: float) -> str:
    try:
        return f"{number:.4g}"
    except OverflowError:  # an integer of hundreds of digits
        return f"{str(number)[:6]}..."


def _list(items: Sequence[object], depth: int) -> str:
    numbers = [one for one in items if isinstance(one, int | float) and not isinstance(one, bool)]
    if items and len(numbers) + items.count(None) == len(items) and len(items) > SHOWN_ITEMS:
        nothing = len(items) - len(numbers)
        spread = f" {_number(min(numbers))} to {_number(max(numbers))}" if numbers else ""
        return f"{len(items)} numbers{spread}{f' ({nothing} missing)' if nothing else ''}"
    if len(items) > SHOWN_ITEMS or (depth == 0 and items):
        return f"{len(items)} items"
    return f"[{' '.join(_shown(one, depth - 1) for one in items)}]"


def _array(packed: dict[str, Any]) -> str:
    """Return shape and type of a packed array, and of a grid how much of it is known."""
    try:
        array = msgspec.convert(packed, PackedArray)
    except (msgspec.ValidationError, OverflowError):
        return "an array that does not unpack"
    form = f"{array.dtype}[{' '.join(map(str, array.shape))}]"
    cells = array.unpack()
    if cells.size == 0:
        return form
    if array.dtype == "uint8":
        empty, occupied = np.mean(cells <= EMPTY_MAX), np.mean(cells >= OCCUPIED_MIN)
        return f"{form} {100 * empty:.0f} % empty, {100 * occupied:.0f} % occupied"
    low, high = float(cells.min()), float(cells.max())
    return f"{form} {low:.4g} to {high:.4g}" if math.isfinite(low + high) else form
