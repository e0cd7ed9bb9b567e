"""Functions of multifields; places count from 1."""

from collections.abc import Iterable

from rules.language.library.function import FunctionFault, LibraryFunction, at_least, fixed, integer, multifield
from rules.language.values import FALSE, NIL, Value, as_symbol, same

Multifield = tuple[Value, ...]


def flattened(values: Iterable[Value]) -> Multifield:
    """`create$`: the values in a row, multifields spread out."""
    row: list[Value] = []
    for value in values:
        row.extend(value) if isinstance(value, tuple) else row.append(value)
    return tuple(row)


def nth(place: Value, values: Value) -> Value:
    """`nth$`: the value at a place, nil where there is none."""
    at, row = integer(place), multifield(values)
    return row[at - 1] if 1 <= at <= len(row) else NIL


def member(sought: Value, values: Value) -> Value:
    """`member$`: the place of a value (first and last place of several in a row), or FALSE."""
    row = multifield(values)
    several = isinstance(sought, tuple) and len(sought) != 1
    part = sought if isinstance(sought, tuple) else (sought,)
    for at in range(len(row) - len(part) + 1):
        if same(row[at : at + len(part)], part):
            return (at + 1, at + len(part)) if several else at + 1
    return FALSE


def stretch(values: Value, first: Value, last: Value) -> Multifield:
    """`subseq$`: from one place to another, as far as there are any."""
    row, begin, end = multifield(values), integer(first), integer(last)
    return row[max(begin, 1) - 1 : max(end, 0)]


def replace(values: Value, first: Value, last: Value, *by: Value) -> Multifield:
    """`replace$`, and `delete$` where nothing comes instead."""
    row, begin, end = multifield(values), integer(first), integer(last)
    if not 1 <= begin <= end <= len(row):
        raise FunctionFault(f"has no places {begin} to {end} in a multifield of {len(row)}")
    return row[: begin - 1] + flattened(by) + row[end:]


def insert(values: Value, place: Value, first: Value, *others: Value) -> Multifield:
    """`insert$`: before a place; at the end where there is no such place."""
    row, at = multifield(values), integer(place)
    if at < 1:
        raise FunctionFault(f"has no place {at}; places count from 1")
    return row[: at - 1] + flattened((first, *others)) + row[at - 1 :]


def without(values: Value, *unwanted: Value) -> Multifield:
    """`delete-member$`: without these values, or stretches of values, wherever they stand; one after the other."""
    row = multifield(values)
    for value in unwanted:
        row = _without_part(row, value if isinstance(value, tuple) else (value,))
    return row


def _without_part(row: Multifield, part: Multifield) -> Multifield:
    kept: list[Value] = []
    at = 0
    while at < len(row):
        if part and same(row[at : at + len(part)], part):
            at += len(part)
        else:
            kept.append(row[at])
            at += 1
    return tuple(kept)


def union(*several: Value) -> Multifield:
    """`union$`: each value once."""
    found: list[Value] = []
    for value in flattened(map(multifield, several)):
        if not _in(value, found):
            found.append(value)
    return tuple(found)


def intersection(*several: Value) -> Multifield:
    """`intersection$`: what is in all of them, each value once."""
    if not several:
        return ()
    first, *others = map(multifield, several)
    return tuple(value for value in union(first) if all(_in(value, other) for other in others))


def difference(first: Value, *others: Value) -> Multifield:
    """`difference$`: what is in the first and in none of the others, each value once."""
    unwanted = [multifield(other) for other in others]
    return tuple(value for value in union(multifield(first)) if not any(_in(value, other) for other in unwanted))


def _in(value: Value, row: Iterable[Value]) -> bool:
    return any(same(value, other) for other in row)


def subset(part: Value, whole: Value) -> Value:
    """`subsetp`."""
    values = multifield(whole)
    return as_symbol(all(_in(value, values) for value in multifield(part)))


MULTIFIELDS: dict[str, LibraryFunction] = {
    "create$": at_least(lambda *values: flattened(values), 0),
    "length$": fixed(lambda values: len(multifield(values)), 1),
    "nth$": fixed(nth, 2),
    "first$": fixed(lambda values: multifield(values)[:1], 1),
    "rest$": fixed(lambda values: multifield(values)[1:], 1),
    "member$": fixed(member, 2),
    "subsetp": fixed(subset, 2),
    "subseq$": fixed(stretch, 3),
    "delete$": fixed(replace, 3),
    "replace$": at_least(replace, 4),
    "insert$": at_least(insert, 3),
    "delete-member$": at_least(without, 2),
    "union$": at_least(union, 0),
    "intersection$": at_least(intersection, 0),
    "difference$": at_least(difference, 1),
}
