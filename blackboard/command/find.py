"""`ski find KIND --near X,Y --in DIR`: where objects of a run are, and what a place is part of."""

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

import msgspec

from blackboard.errors import BoardError
from blackboard.journal import read_journal
from blackboard.object_index import CELL, Object, ObjectIndex, Place, read_objects
from blackboard.vocabulary import Vocabulary


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "kind", help="corner, target, trap, line, ...; 'all'; or 'cell': what is at --near, and what is it part of"
    )
    parser.add_argument("--in", dest="folder", type=Path, required=True, metavar="DIR", help="output folder of a run")
    parser.add_argument("--near", metavar="X,Y", help="nearest to this place first (metres, map frame)")
    parser.add_argument("--within", metavar="M", help="no further than this from --near")
    parser.add_argument("--area", metavar="X0,Y0,X1,Y1", help="only what touches this box")
    parser.add_argument("--name", metavar="ID", help="only the one with this id")
    parser.add_argument("--words", metavar="TEXT", help="only those in whose description all these words occur")
    parser.add_argument("--at", type=float, metavar="S", help="as of this stamp (seconds); default: the run's end")
    parser.add_argument("--json", action="store_true", help="print the objects as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    near = _numbers("--near", options.near, 2)
    area = _numbers("--area", options.area, 4)
    within = _numbers("--within", options.within, 1)
    if within is not None and (near is None or within[0] < 0.0):
        raise BoardError(f"--within {options.within}: give --near X,Y with it, and metres of 0 or more")
    if area is not None and (area[0] > area[2] or area[1] > area[3]):
        raise BoardError(f"--area {options.area}: must be x_min,y_min,x_max,y_max")
    index = read_objects(read_journal(options.folder), Vocabulary(), at_s=options.at)
    place = (near[0], near[1]) if near is not None else None
    if options.kind == CELL:
        if place is None:
            raise BoardError("which cell? give --near X,Y")
        return _tell_cell(index, place, options.json)
    found = index.find(
        None if options.kind == "all" else options.kind,
        near=place,
        within_m=within[0] if within is not None else math.inf,
        name=options.name,
        area=(area[0], area[1], area[2], area[3]) if area is not None else None,
        words=(options.words or "").split(),
    )
    if options.json:
        sys.stdout.write(json.dumps([_as_dict(o, place) for o in found], indent=2) + "\n")
    else:
        sys.stdout.writelines(f"{_told(o, place)}\n" for o in found)
        if not found:
            sys.stderr.write("ski: nothing found\n")
    return 0


def _tell_cell(index: ObjectIndex, place: Place, as_json: bool) -> int:
    cell, part_of = index.cell(place), index.part_of(place)
    if as_json:
        told = {"x_m": place[0], "y_m": place[1], "state": cell.state, "value": cell.value}
        sys.stdout.write(json.dumps({**told, "part_of": [_as_dict(o, place) for o in part_of]}, indent=2) + "\n")
        return 0
    sys.stdout.write(f"({place[0]:g}, {place[1]:g}) is {cell.state} ({cell.value} of 255)\n")
    sys.stdout.writelines(f"  part of {_told(o, place)}\n" for o in part_of)
    return 0


def _told(found: Object, near: Place | None) -> str:
    away = f", {found.distance_m(near):.2f} m away" if near is not None else ""
    short = "/".join(found.key.split("/")[2:])
    return f"{short} {_where(found)}{away}: {_what(found)}"


def _where(found: Object) -> str:
    x0, y0, x1, y1 = found.value.extent()
    return f"at ({x0:.2f}, {y0:.2f})" if (x0, y0) == (x1, y1) else f"from ({x0:.2f}, {y0:.2f}) to ({x1:.2f}, {y1:.2f})"


def _what(found: Object) -> str:
    parts = []
    for name, value in msgspec.to_builtins(found.value).items():
        if isinstance(value, float) and name.endswith("_rad"):
            parts.append(f"{name.removesuffix('_rad')}_deg {math.degrees(value):.1f}")
        elif isinstance(value, float):
            parts.append(f"{name} {value:.3g}")
        elif isinstance(value, str | int) and value != "":
            parts.append(f"{name} {value}")
    return ", ".join(parts)


def _as_dict(found: Object, near: Place | None) -> dict[str, Any]:
    x0, y0, x1, y1 = found.value.extent()
    away = {"distance_m": found.distance_m(near)} if near is not None else {}
    return {
        "key": found.key,
        "kind": found.kind.path,
        "id": found.id,
        "extent_m": [x0, y0, x1, y1],
        **away,
        "stamp_s": found.stamp_s,
        "value": msgspec.to_builtins(found.value),
        "endorsements": list(found.said),
    }


def _numbers(flag: str, text: str | None, count: int) -> tuple[float, ...] | None:
    if text is None:
        return None
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        form = {1: "a number", 2: "X,Y", 4: "X0,Y0,X1,Y1"}[count]
        raise BoardError(
            f"{flag} {text}: must be {form} in metres, such as {flag} {','.join('123'[i % 3] for i in range(count))}"
        )
    return numbers
