"""Worlds in TOML: a floor, walls, polygons, boxes, circles, people, docks, and where the robot starts."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import cos, sin
from pathlib import Path
from typing import TypeVar

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from blackboard.errors import MissionError, did_you_mean
from blackboard.parameters import parse_parameters
from blackboard.toml_file import Place, TomlFile, read_toml
from sim.dock import Dock
from sim.people import Person
from sim.world import FAR_M, PRECISION_M, Coloured, World, make_world
from sim.world_tables import Box, Circle, Floor, Points, Polygon, Start, Surface, Wall

T = TypeVar("T")


TABLES = ("floor", "start")
LISTS = ("wall", "polygon", "box", "circle", "person", "dock")
KEYS = ("title", *TABLES, *LISTS)


def load_world_file(path: Path) -> World:
    """Return the world of a TOML file; raise MissionError naming file, line and key where it is wrong."""
    file = read_toml(path)
    _check_keys(file)
    floor_table = parse_parameters(Floor, file.data["floor"], file.place("floor"))
    floor = _area(floor_table.outline, "outline", file.place("floor"))
    start = parse_parameters(Start, file.data["start"], file.place("start")) if "start" in file.data else None
    people = tuple(_people(file))
    docks = tuple(_docks(file, floor))
    things, circles = list(_things(file)), list(_circles(file))
    stays = [*(thing.stay for thing in things), *(circle.stay for circle in circles)]
    edge = [floor.boundary.buffer(PRECISION_M)] if floor_table.surface == "rough" else []
    worlds = []
    for at_s in sorted({0.0, *(s.from_s for s in stays), *(s.until_s for s in stays if s.until_s is not None)}):
        here = [thing for thing in things if thing.stay.holds(at_s)]
        smooth = [thing.shape for thing in here if thing.surface == "smooth"]
        rough = edge + [thing.shape for thing in here if thing.surface == "rough"]
        round_ = [circle for circle in circles if circle.stay.holds(at_s)]
        world = make_world(
            str(path),
            floor=floor,
            free=shapely.difference(
                floor, shapely.union_all([*smooth, *rough], grid_size=PRECISION_M), grid_size=PRECISION_M
            ),
            rough_things=shapely.union_all(rough),
            circles=np.array([circle.row for circle in round_], dtype=float).reshape(-1, 3),
            circle_rough=np.array([circle.surface == "rough" for circle in round_], dtype=bool),
            coloured=tuple(_coloured(here, round_)),
            people=people,
            start=None if start is None else start.pose(),
        )
        worlds.append((at_s, world))
    _check_ways(worlds[0][1], file)
    return replace(worlds[0][1], later=tuple(worlds[1:]), docks=docks)


def _check_keys(file: TomlFile) -> None:
    """Refuse top-level keys that are unknown or not of the right form."""
    for key, value in file.data.items():
        if key not in KEYS:
            place = file.place(key) if isinstance(value, dict | list) else file.place()
            raise MissionError(f"{place.at(key)}: unknown key '{key}'{did_you_mean(key, KEYS)}")
        if key in TABLES and not isinstance(value, dict):
            raise MissionError(f"{file.place().at(key)}: write '{key}' as a table [{key}]")
        if key in LISTS and not (isinstance(value, list) and all(isinstance(entry, dict) for entry in value)):
            place = file.place(key) if isinstance(value, dict) else file.place()
            raise MissionError(f"{place.at(key)}: write each {key} as [[{key}]]")
    if not isinstance(file.data.get("title", ""), str):
        raise MissionError(f"{file.place().at('title')}: title = {file.data['title']!r} must be text in quotes")
    if "floor" not in file.data:
        raise MissionError(f"{file.path}: table [floor] with its outline is missing; add it")


@dataclass(frozen=True)
class _Stay:
    """When a thing is there."""

    from_s: float
    until_s: float | None

    def holds(self, at_s: float) -> bool:
        return self.from_s <= at_s and (self.until_s is None or at_s < self.until_s)


@dataclass(frozen=True)
class _Thing:
    """Something that stands there and is no circle."""

    shape: BaseGeometry
    surface: Surface
    colour: str
    stay: _Stay


@dataclass(frozen=True)
class _Round:
    """A circle: x, y, radius."""

    row: tuple[float, float, float]
    surface: Surface
    colour: str
    stay: _Stay


def _things(file: TomlFile) -> Iterator[_Thing]:
    """Yield everything that ever stands there and is no circle."""
    for wall, place in _entries(Wall, file, "wall"):
        line = _points(wall.line, "line", place, 2)
        closed = len(line) > 3 and line[0] == line[-1]
        shape = shapely.LinearRing(line) if closed else shapely.LineString(line)
        if shape.length < PRECISION_M:
            raise MissionError(f"{place.at('line')}: line has no length; give two different points")
        solid = shape.buffer(wall.thickness_m / 2.0, cap_style="flat", join_style="mitre")
        yield _Thing(solid, wall.surface, "", _Stay(wall.from_s, wall.until_s))
    for polygon, place in _entries(Polygon, file, "polygon"):
        stay = _Stay(polygon.from_s, polygon.until_s)
        yield _Thing(_area(polygon.outline, "outline", place), polygon.surface, polygon.colour, stay)
    for box, place in _entries(Box, file, "box"):
        ((x, y),) = _points((box.centre,), "centre", place, 1)
        ((width, depth),) = _points((box.size,), "size", place, 1)
        if width <= 0.0 or depth <= 0.0:
            raise MissionError(f"{place.at('size')}: size = {[width, depth]} must be two positive lengths in metres")
        c, s = cos(box.heading_rad), sin(box.heading_rad)
        corners = [(a * width / 2, b * depth / 2) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        outline = shapely.Polygon([(x + c * a - s * b, y + s * a + c * b) for a, b in corners])
        yield _Thing(outline, box.surface, box.colour, _Stay(box.from_s, box.until_s))


def _circles(file: TomlFile) -> Iterator[_Round]:
    """Yield every circle that ever stands there."""
    for circle, place in _entries(Circle, file, "circle"):
        for x, y in _points(circle.centres, "centres", place, 1):
            yield _Round((x, y, circle.radius_m), circle.surface, circle.colour, _Stay(circle.from_s, circle.until_s))


def _coloured(things: Sequence[_Thing], circles: Sequence[_Round]) -> Iterator[Coloured]:
    """Yield what has a colour."""
    for thing in things:
        if thing.colour:
            yield Coloured(thing.shape.boundary, 0.0, thing.colour)
    for circle in circles:
        if circle.colour:
            yield Coloured(shapely.Point(circle.row[:2]), circle.row[2], circle.colour)


def _people(file: TomlFile) -> Iterator[Person]:
    for person, place in _entries(Person, file, "person"):
        _points(person.path, "path", place, 2)
        yield person


def _docks(file: TomlFile, floor: BaseGeometry) -> Iterator[Dock]:
    for dock, place in _entries(Dock, file, "dock"):
        if floor.distance(shapely.Point(dock.x_m, dock.y_m)) > PRECISION_M:
            raise MissionError(f"{place.at('x_m')}: ({dock.x_m:g}, {dock.y_m:g}) is outside the floor; move the dock")
        yield dock


def _check_ways(world: World, file: TomlFile) -> None:
    """Refuse people who would walk through walls."""
    open_floor = world.open_floor()
    for index, person in enumerate(world.people):
        for a, b in pairwise(person.path):
            way = shapely.LineString((a, b)).buffer(person.radius_m * 0.99)  # brushing along a wall is no fault
            if not open_floor.covers(way):
                stretch = f"between {list(a)} and {list(b)}"
                where = file.place("person", index).at("path")
                raise MissionError(f"{where}: path goes through a wall or a thing {stretch}; move it")


def _entries(type_: type[T], file: TomlFile, key: str) -> Iterator[tuple[T, Place]]:
    """Yield each [[key]] of the file as a record, with its place for messages."""
    for index, entry in enumerate(file.data.get(key, [])):
        place = file.place(key, index)
        yield parse_parameters(type_, entry, place), place


def _points(points: Sequence[Sequence[float]], key: str, place: Place, least: int) -> list[tuple[float, float]]:
    """Return points as pairs; raise MissionError where one is no pair, too far away, or there are too few."""
    if len(points) < least:
        raise MissionError(f"{place.at(key)}: {key} has {len(points)} points, it needs at least {least}")
    for point in points:
        if len(point) != 2:
            raise MissionError(f"{place.at(key)}: {key}: {list(point)} must be a pair [x, y] in metres")
        if max(abs(point[0]), abs(point[1])) > FAR_M:
            raise MissionError(f"{place.at(key)}: {key}: {list(point)} is outside [-{FAR_M:g}, {FAR_M:g}] m")
    return [(x, y) for x, y in points]


def _area(outline: Points, key: str, place: Place) -> BaseGeometry:
    """Return a closed outline as a polygon; raise MissionError where it is open, crosses itself or has no area."""
    points = _points(outline, key, place, 1)
    if points[0] != points[-1]:
        ends = f"it starts at {list(points[0])} and ends at {list(points[-1])}"
        raise MissionError(f"{place.at(key)}: {key} is open: {ends}; repeat the first point at the end")
    if len(set(points)) < 3:
        raise MissionError(f"{place.at(key)}: {key} has {len(set(points))} corners, it needs at least 3")
    polygon = shapely.Polygon(points)
    if not polygon.is_valid:
        reason = shapely.is_valid_reason(polygon)  # ends in [x y]
        at = ", ".join(reason[reason.find("[") + 1 : -1].split())
        raise MissionError(f"{place.at(key)}: {key} crosses or touches itself at ({at}); reorder its corners")
    if polygon.area < 1e-6:
        raise MissionError(f"{place.at(key)}: {key} encloses no area; check its corners")
    return polygon
