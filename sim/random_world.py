"""Floor plans that nobody has seen before: rooms with doors and furniture, drawn from a seed.

The floor is parted again and again by walls, each with one door, so that all rooms hang together. Furniture stands against
walls or free; none of it cuts a place off for a robot of up to ROBOT_M radius. The same seed gives the same world.
"""

from dataclasses import dataclass, field
from math import pi

import numpy as np
import shapely
from shapely.affinity import rotate
from shapely.geometry.base import BaseGeometry

from sim.world import PRECISION_M, World, make_world

WIDTH_M, DEPTH_M = (8.0, 16.0), (6.0, 12.0)  # of the floor, at least and at most
WALL_M = 0.12
DOOR_M = (0.85, 1.2)
NARROWEST_M = 2.4  # side of a room
LARGEST_M2 = 30.0  # a larger room is parted
SMALLEST_M2 = 12.0  # a smaller one is not
PARTED_FRACTION = 0.7  # of those between
BESIDE_DOOR_M = 0.3  # from a door to the next wall
M2_A_THING = 6.0
ROBOT_M = 0.4  # a robot of this radius still gets everywhere where a narrower one does
TRIES = 20
Rectangle = tuple[float, float, float, float]  # x and y at least, x and y at most


@dataclass
class _Plan:
    """What has been drawn so far."""

    rng: np.random.Generator
    walls: list[BaseGeometry] = field(default_factory=list)
    doors: list[tuple[float, float]] = field(default_factory=list)  # their middles
    rooms: list[Rectangle] = field(default_factory=list)

    def part(self, room: Rectangle) -> None:
        """Part a room by a wall with a door, and its halves in turn; or leave it as it is."""
        x0, y0, x1, y1 = room
        area = (x1 - x0) * (y1 - y0)
        upright = x1 - x0 > y1 - y0
        wanted = area > LARGEST_M2 or (area > SMALLEST_M2 and self.rng.random() < PARTED_FRACTION)
        at = self._place(room, upright) if wanted else None
        if at is None:
            self.rooms.append(room)
            return
        low, high = (y0, y1) if upright else (x0, x1)
        width = float(self.rng.uniform(*DOOR_M))
        start = float(self.rng.uniform(low + BESIDE_DOOR_M, high - BESIDE_DOOR_M - width))
        for a, b in ((low, start), (start + width, high)):
            line = ((at, a), (at, b)) if upright else ((a, at), (b, at))
            self.walls.append(shapely.LineString(line).buffer(WALL_M / 2, cap_style="flat"))
        middle = start + width / 2
        self.doors.append((at, middle) if upright else (middle, at))
        for half in ((x0, y0, at, y1), (at, y0, x1, y1)) if upright else ((x0, y0, x1, at), (x0, at, x1, y1)):
            self.part(half)

    def _place(self, room: Rectangle, upright: bool) -> float | None:
        """Return where a wall may part a room: it must not end in a door. None where it would be too narrow."""
        low, high = (room[0], room[2]) if upright else (room[1], room[3])
        ends = (room[1], room[3]) if upright else (room[0], room[2])
        if high - low < 2 * NARROWEST_M or ends[1] - ends[0] < 2 * BESIDE_DOOR_M + DOOR_M[1]:
            return None
        clear = DOOR_M[1] / 2 + BESIDE_DOOR_M
        for at in self.rng.uniform(low + NARROWEST_M, high - NARROWEST_M, TRIES).tolist():
            doors = [(x, y) if upright else (y, x) for x, y in self.doors]
            if all(abs(x - at) > clear or min(abs(y - end) for end in ends) > WALL_M for x, y in doors):
                return float(at)
        return None


def random_world(seed: int) -> World:
    """Return a floor plan drawn from a seed."""
    rng = np.random.default_rng([seed, 20])
    width, depth = float(rng.uniform(*WIDTH_M)), float(rng.uniform(*DEPTH_M))
    floor = shapely.box(0.0, 0.0, width, depth)
    plan = _Plan(rng)
    plan.part((0.0, 0.0, width, depth))
    free = shapely.difference(floor, shapely.union_all(plan.walls, grid_size=PRECISION_M), grid_size=PRECISION_M)
    rough: list[BaseGeometry] = []
    circles: list[tuple[float, float, float]] = []
    open_floor = free
    for room in plan.rooms:
        for _ in range(int((room[2] - room[0]) * (room[3] - room[1]) / M2_A_THING)):
            thing, circle = _thing(room, rng)
            left = shapely.difference(open_floor, thing)
            if not _hangs_together(left):
                continue
            open_floor = left
            if circle is not None:
                circles.append(circle)
                continue
            free = shapely.difference(free, thing, grid_size=PRECISION_M)
            if rng.random() < 0.5:
                rough.append(thing)
    return make_world(
        f"random world {seed}",
        floor=floor,
        free=free,
        rough_things=shapely.union_all(rough),
        circles=np.array(circles, dtype=np.float64).reshape(-1, 3),
        circle_rough=rng.random(len(circles)) < 0.5,
    )


def _thing(room: Rectangle, rng: np.random.Generator) -> tuple[BaseGeometry, tuple[float, float, float] | None]:
    """Return a piece of furniture in a room: against one of its walls, anywhere and askew, or round."""
    x0, y0, x1, y1 = room
    kind, u, v = rng.random(3).tolist()
    long, deep = float(rng.uniform(0.5, 1.8)), float(rng.uniform(0.35, 0.8))
    if kind < 0.25:
        radius = float(rng.uniform(0.1, 0.35))
        x, y = x0 + radius + u * (x1 - x0 - 2 * radius), y0 + radius + v * (y1 - y0 - 2 * radius)
        return shapely.Point(x, y).buffer(radius), (x, y, radius)
    if kind < 0.75:
        side = int(4 * v)
        if side < 2:
            x, y = x0 + u * (x1 - x0 - long), y0 if side else y1 - deep
            return shapely.box(x, y, x + long, y + deep), None
        x, y = x0 if side == 2 else x1 - deep, y0 + u * (y1 - y0 - long)
        return shapely.box(x, y, x + deep, y + long), None
    x, y = x0 + u * (x1 - x0), y0 + v * (y1 - y0)
    box = rotate(
        shapely.box(x - long / 2, y - deep / 2, x + long / 2, y + deep / 2), rng.uniform(0, pi), use_radians=True
    )
    return shapely.intersection(box, shapely.box(*room)), None


def _hangs_together(floor: BaseGeometry) -> bool:
    """Say whether a robot gets everywhere where it fits."""
    room = shapely.buffer(floor, -ROBOT_M, quad_segs=4)
    return not room.is_empty and len(shapely.get_parts(room)) == 1
