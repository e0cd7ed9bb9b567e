"""`ski find KIND --near X,Y [--in DIR]`: where objects of a run are, and what a place is part of."""

import argparse
import json
import math
import sys
from typing import Any

import msgspec

from blackboard.command.run_folder import add_run_folder, run_folder, stamp
from blackboard.errors import BoardError
from blackboard.journal import in_stamp_order, read_journal
from blackboard.messages.geometry import Point
from blackboard.object_index import CELL, Object, ObjectIndex, Place, read_objects
from blackboard.vocabulary import Vocabulary


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "kind", help="corner, target, trap, line, ...; 'all'; or 'cell': what is at --near, and what is it part of"
    )
    add_run_folder(parser)
    parser.add_argument("--near", metavar="X,Y", help="nearest to this place first (metres, map frame)")
    parser.add_argument("--within", metavar="M", help="no further than this from --near")
    parser.add_argument("--area", metavar="X0,Y0,X1,Y1", help="only what touches this box")
    parser.add_argument("--name", metavar="ID", help="only the one with this id")
    parser.add_argument("--words", metavar="TEXT", help="only those in whose description all these words occur")
    parser.add_argument("--at", type=stamp, metavar="S", help="as of this stamp (seconds); default: the run's end")
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
    place = (near[0], near[1]) if near is not None else None
    if options.kind == CELL:
        if place is None:
            raise BoardError("which cell? give --near X,Y")
        for flag in ("within", "area", "name", "words"):
            if getattr(options, flag) is not None:
                raise BoardError(f"--{flag} says nothing of a cell; leave it out, or ask for 'all'")
    index = read_objects(in_stamp_order(read_journal(run_folder(options))), Vocabulary(), at_s=options.at)
    if options.kind == CELL and place is not None:
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
    start, end = getattr(found.value, "start", None), getattr(found.value, "end", None)
    if isinstance(start, Point) and isinstance(end, Point):
        return f"from {_point(start.x_m, start.y_m)} to {_point(end.x_m, end.y_m)}"
    x0, y0, x1, y1 = found.value.extent()
    return f"at {_point(x0, y0)}" if (x0, y0) == (x1, y1) else f"within {_point(x0, y0)} and {_point(x1, y1)}"


def _point(x_m: float, y_m: float) -> str:
    return f"({round(x_m, 2) + 0.0:.2f}, {round(y_m, 2) + 0.0:.2f})"  # no -0.00


def _what(found: Object) -> str:
    parts = []
    for name, value in msgspec.to_builtins(found.value).items():
        if isinstance(value, float) and name.endswith("_rad"):
            parts.append(f"{name.removesuffix('_rad')}_deg {math.degrees(value):.1f}")
        elif isinstance(value, float):
            parts.append(f"{name} {value:.3g}")
        elif isinstance(value, str | int) and value != "":
            parts.append(f"{name} {value}")
        elif isinstance(value, dict) and value.keys() == {"x_m", "y_m"} and name not in ("place", "start", "end"):
            parts.append(f"{name} {_point(value['x_m'], value['y_m'])}")
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
        form, example = {1: ("a number", "1.5"), 2: ("X,Y", "2,3"), 4: ("X0,Y0,X1,Y1", "0,0,4,2.5")}[count]
        raise BoardError(f"{flag} {text}: must be {form} in metres, such as {flag} {example}")
    return numbers
