"""Points, and lines where there are any, from an ARIA map or from a text of x and y.

An ARIA map (MobileRobots' `.map`, mm) begins with `2D-Map`, and has `LINES` and `DATA` as headings of x1 y1 x2 y2 and of x y.
A text has x and y in metres, apart by blanks, commas, semicolons or tabs; a first line of names says which columns they are.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
import numpy.typing as npt

from blackboard.errors import RecordingError
from sim.point_maps.text import EXPECTED, text_lines

Array = npt.NDArray[np.float64]

MAX_POINTS = 5_000_000
FAR_M = 10_000.0  # no map is wider: who means millimetres hears of it
COMMENTS = ("#", "//", "%")


@dataclass(frozen=True, slots=True, eq=False)
class PointFile:
    """`points` (n, 2), and `lines` (m, 4) by their ends where the file has some; metres."""

    points: Array
    lines: Array


def read_points(path: Path) -> PointFile:
    """Return what a file holds; raise RecordingError naming file, line and what to do where it cannot be used."""
    lines = text_lines(path)
    first = next(lines, None)
    if first is None:
        raise RecordingError(f"{path}: the file is empty; expected {EXPECTED}")
    found = _aria(path, lines) if first[1].startswith("2D-Map") else _columns(path, chain([first], lines))
    if not len(found.points):
        raise RecordingError(f"{path}: there is no point in it; expected {EXPECTED}")
    return found


def _aria(path: Path, lines: Iterator[tuple[int, str]]) -> PointFile:
    sections: dict[str, list[list[float]]] = {"LINES": [], "DATA": []}
    promised: dict[str, int] = {}
    section = ""
    for number, text in lines:
        if text in sections:
            section = text
        elif section:
            values = _numbers(text.split(), 4 if section == "LINES" else 2)
            if values is None:
                form = "x1 y1 x2 y2" if section == "LINES" else "x y"
                raise RecordingError(
                    f"{path}: line {number}: '{text[:40]}' below {section} is not {form} in mm; correct or remove the line"
                )
            _check(path, number, [v / 1000.0 for v in values], sections[section])
        elif count := re.fullmatch(r"Num(Points|Lines):\s*(\d+)", text):
            promised["DATA" if count[1] == "Points" else "LINES"] = int(count[2])
    for name, count_promised in promised.items():
        if len(sections[name]) != count_promised:
            raise RecordingError(
                f"{path}: the head promises {count_promised} lines below {name} and there are {len(sections[name])}: "
                "the file breaks off or was edited; copy it again or correct its head"
            )
    return PointFile(np.array(sections["DATA"]).reshape(-1, 2), np.array(sections["LINES"]).reshape(-1, 4))


def _columns(path: Path, lines: Iterator[tuple[int, str]]) -> PointFile:
    points: list[list[float]] = []
    at: tuple[int, int] | None = None
    for number, text in lines:
        if text.startswith(COMMENTS):
            continue
        words = [
            word.strip().strip("\"'")
            for word in (re.split(r"[,;\t]", text) if re.search(r"[,;\t]", text) else text.split())
        ]
        if at is None:
            at = _named_columns([word.lower() for word in words])
            if at is not None:
                continue
            at = (0, 1)
        values = _numbers([words[i] for i in at], 2) if len(words) > max(at) else None
        if values is None:
            raise RecordingError(
                f"{path}: line {number}: '{text[:40]}' does not begin with x and y in metres; expected {EXPECTED}"
                if at == (0, 1)
                else f"{path}: line {number}: '{text[:40]}' has no number in column {at[0] + 1} or {at[1] + 1}; correct it"
            )
        _check(path, number, values, points)
    return PointFile(np.array(points).reshape(-1, 2), np.zeros((0, 4)))


def _named_columns(names: list[str]) -> tuple[int, int] | None:
    """Return which columns a first line names x and y, with or without `_m` or `(m)`; None where it names none."""
    bare = [re.sub(r"_m$|\s*[\[(]m[\])]$", "", name) for name in names]
    return (bare.index("x"), bare.index("y")) if "x" in bare and "y" in bare else None


def _numbers(words: list[str], count: int) -> list[float] | None:
    try:
        return [float(word) for word in words] if len(words) == count else None
    except ValueError:
        return None


def _check(path: Path, number: int, values: list[float], rows: list[list[float]]) -> None:
    """Add a row; refuse one that is no place on a map, and one too many."""
    if not all(abs(v) <= FAR_M for v in values):  # NaN is not either
        raise RecordingError(
            f"{path}: line {number}: a coordinate is not within {FAR_M:g} m of the origin; give metres (an ARIA map has mm)"
        )
    if len(rows) == MAX_POINTS:
        raise RecordingError(f"{path}: line {number}: more than {MAX_POINTS} points; thin them out")
    rows.append(values)
