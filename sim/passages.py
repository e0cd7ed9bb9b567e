"""Narrow passages of a floor: doorways and gaps where a robot must go through, as chords from one side to the other.

A passage is a place half way between two sides that face each other, wide enough for the robot, where a door would part the
floor around it in two. Of passages near to each other the narrowest counts.
"""

from dataclasses import dataclass
from math import hypot

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

RASTER_M = 0.1  # places are looked for on a raster; a passage is centred afterwards
WIDEST_M = 1.5  # wider than this is no passage
AROUND_M = 1.5  # a door parts the floor within this distance of it ...
SIDE_M2 = 0.25  # ... into two sides on which a robot's centre can be in at least this area
APART_M = 1.0  # passages nearer to each other than this are one


@dataclass(frozen=True, slots=True)
class Passage:
    """A chord across the floor, m, map frame."""

    start: tuple[float, float]
    end: tuple[float, float]

    @property
    def middle(self) -> tuple[float, float]:
        return ((self.start[0] + self.end[0]) / 2, (self.start[1] + self.end[1]) / 2)

    @property
    def width_m(self) -> float:
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    def shape(self, thickness_m: float) -> BaseGeometry:
        """Return a closed door of this thickness, a little longer than the passage is wide."""
        line = shapely.LineString((self.start, self.end))
        return line.buffer(thickness_m / 2, cap_style="square")


def passages(open_floor: BaseGeometry, radius_m: float) -> list[Passage]:
    """Return the passages that a disc of this radius fits through, narrowest first; the same floor gives the same list."""
    edge = open_floor.boundary
    room = shapely.buffer(open_floor, -radius_m)
    x_min, y_min, x_max, y_max = shapely.bounds(open_floor)
    columns, rows = np.arange(x_min, x_max, RASTER_M), np.arange(y_min, y_max, RASTER_M)
    x_m, y_m = (axis.ravel() for axis in np.meshgrid(columns, rows))
    shapely.prepare(room)
    inside = shapely.contains_xy(room, x_m, y_m)
    places = shapely.points(x_m[inside], y_m[inside])
    places = places[shapely.distance(places, edge) <= WIDEST_M / 2]
    found: list[Passage] = []
    for passage in sorted(_chords(places, edge), key=lambda p: (round(p.width_m, 3), p.middle)):
        x, y = passage.middle
        if not 2 * radius_m < passage.width_m <= WIDEST_M:
            continue
        if any(hypot(x - other.middle[0], y - other.middle[1]) < APART_M for other in found):
            continue
        if _parts_the_floor(passage, room, radius_m):
            found.append(passage)
    return found


def _chords(places: "np.typing.NDArray[np.object_]", edge: BaseGeometry) -> list[Passage]:
    """Return for each place the shortest way to the edge, gone on to the other side."""
    chords = []
    for place in places:
        near = shapely.get_coordinates(shapely.shortest_line(place, edge))
        (x, y), (near_x, near_y) = near
        distance = hypot(near_x - x, near_y - y)
        across = shapely.LineString(
            ((x, y), (x - (near_x - x) * WIDEST_M / distance, y - (near_y - y) * WIDEST_M / distance))
        )
        far = shapely.intersection(across, edge)
        if not far.is_empty:
            hit = shapely.get_coordinates(shapely.shortest_line(place, far))[1]
            chords.append(Passage((float(near_x), float(near_y)), (float(hit[0]), float(hit[1]))))
    return chords


def _parts_the_floor(passage: Passage, room: BaseGeometry, radius_m: float) -> bool:
    around = shapely.intersection(room, shapely.buffer(shapely.Point(passage.middle), AROUND_M))
    line = shapely.LineString((passage.start, passage.end))
    here = [part for part in shapely.get_parts(around) if shapely.intersects(part, line)]
    if len(here) != 1:
        return False
    sides = shapely.get_parts(shapely.difference(here[0], shapely.buffer(line, radius_m)))
    return sum(float(side.area) >= SIDE_M2 for side in sides) >= 2
