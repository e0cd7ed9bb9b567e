"""A world: the floor, what stands on it, who walks there, and where the robot starts."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry
from shapely.ops import polylabel

from blackboard.component import WorldTruth
from blackboard.errors import MissionError
from blackboard.messages.geometry import Pose
from sim.dock import Dock
from sim.people import Person
from sim.shapes import Bools, Floats, Shapes, shapes_around

FAR_M = 1000.0  # no world reaches further from its origin
OUTER_WALL_M = 0.15  # the floor ends in walls of this thickness
PRECISION_M = 1e-6  # corners are put on this raster, so that things that touch do so exactly


@dataclass(frozen=True, slots=True, eq=False)
class Coloured:
    """A thing of one colour: what lies within `radius_m` of `core` (a round thing's middle, any other thing's outline)."""

    core: BaseGeometry
    radius_m: float
    colour: str


@dataclass(frozen=True, slots=True, eq=False)
class World:
    """Metres, map frame. Circles stand apart from `free`, the floor less all other things, since rays meet them as circles.

    `later` holds what the world becomes when things are put down or taken away: from when on (s), and the world, without people.
    """

    name: str
    floor: BaseGeometry
    free: BaseGeometry
    circles: Floats  # (c, 3): x, y, radius
    shapes: Shapes
    rough_things: BaseGeometry = field(default_factory=shapely.Polygon)  # what of the boundary of `free` is rough
    coloured: tuple[Coloured, ...] = ()
    people: tuple[Person, ...] = ()
    start: Pose | None = None
    later: "tuple[tuple[float, World], ...]" = ()
    docks: tuple[Dock, ...] = ()

    def truth(self) -> WorldTruth:
        """Return what stands still, the walls round the floor included, and the floor."""
        outside = self.floor.buffer(OUTER_WALL_M, join_style="mitre")
        return WorldTruth(solid=outside.difference(self.open_floor()), floor=self.floor)

    def open_floor(self) -> BaseGeometry:
        """Return the floor on which nothing stands."""
        if not len(self.circles):
            return self.free
        round_things = shapely.buffer(shapely.points(self.circles[:, :2]), self.circles[:, 2], quad_segs=16)
        return self.free.difference(shapely.union_all(round_things))

    def with_things(self, solids: Sequence[BaseGeometry], circles: Sequence[tuple[float, float, float]]) -> "World":
        """Return this world with more in it: smooth solids, and rough circles (x, y, radius)."""
        world = self
        if solids:
            free = shapely.difference(self.free, shapely.union_all(solids), grid_size=PRECISION_M)
            shapes = shapes_around(free, self.rough_things, self.circles, self.shapes.circle_rough)
            world = replace(self, free=free, shapes=shapes)
        if circles:
            rows = np.array(circles, dtype=np.float64)
            shapes = world.shapes.with_rough_circles(rows.T)
            world = replace(world, circles=np.concatenate((world.circles, rows)), shapes=shapes)
        return world

    def start_pose(self, wanted: Pose | None, radius_m: float) -> Pose:
        """Return where a robot of this radius starts: where it is wanted, where the world says, or where there is most room.

        Raises MissionError where it does not fit.
        """
        pose = wanted or self.start or free_place(self.open_floor())
        here = shapely.Point(pose.x_m, pose.y_m)
        place = f"{self.name}: a robot of radius {radius_m:g} m at ({pose.x_m:g}, {pose.y_m:g})"
        if not self.floor.contains(here):
            raise MissionError(f"{place} starts outside the floor; move its start{self._hint(radius_m)}")
        distance = self.shapes.distances_m(pose.x_m, pose.y_m)[0]
        gap = float(distance.min(initial=np.inf))
        if gap < 0.0 or not self.free.contains(here):
            raise MissionError(f"{place} starts inside a wall or a thing; move its start{self._hint(radius_m)}")
        if gap < radius_m + 1e-3:
            raise MissionError(f"{place} touches what is {gap:.3f} m away; move its start{self._hint(radius_m)}")
        return pose

    def _hint(self, radius_m: float) -> str:
        """Name a place where the robot fits."""
        pose = free_place(self.open_floor())
        distance = self.shapes.distances_m(pose.x_m, pose.y_m)[0]
        if float(distance.min(initial=np.inf)) < radius_m + 1e-3:
            return " (no place in this world is wide enough)"
        return f", for example to ({pose.x_m:.2f}, {pose.y_m:.2f})"


def make_world(
    name: str,
    *,
    floor: BaseGeometry,
    free: BaseGeometry,
    rough_things: BaseGeometry,
    circles: Floats,
    circle_rough: Bools,
    coloured: tuple[Coloured, ...] = (),
    people: tuple[Person, ...] = (),
    start: Pose | None = None,
) -> World:
    """Return a world whose walls are the boundary of `free`; raise MissionError if no floor is left."""
    if free.is_empty or free.area < 1e-4:
        raise MissionError(f"{name}: no floor is free; take things away or make the floor larger")
    shapes = shapes_around(free, rough_things, circles, circle_rough)
    return World(
        name=name,
        floor=floor,
        free=free,
        circles=circles,
        shapes=shapes,
        rough_things=rough_things,
        coloured=coloured,
        people=people,
        start=start,
    )


def free_place(open_floor: BaseGeometry) -> Pose:
    """Return the place with most room on the largest connected piece of floor."""
    largest = max(shapely.get_parts(open_floor), key=lambda part: float(part.area))
    place = polylabel(largest, tolerance=0.02)
    return Pose(x_m=round(place.x, 3), y_m=round(place.y, 3), heading_rad=0.0)
