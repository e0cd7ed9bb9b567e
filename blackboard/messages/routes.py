"""Ways over the floor that is known to be empty. Map frame."""

from typing import Annotated, Literal

from msgspec import Meta

from blackboard.messages.base import Length, Message, Metres
from blackboard.messages.geometry import Point


class WayPoint(Message, frozen=True, kw_only=True):
    """A point of a way. `room_m` is how far from the robot's rim the nearest thing lies, at least, from here to the next point;
    what is further than a few decimetres is not measured.
    """

    x_m: Metres
    y_m: Metres
    room_m: Length


class Route(Message, frozen=True, kw_only=True):
    """The shortest safe way to `goal` for a robot of this size, from where it stood; no `way` where none is known."""

    goal: Point
    state: Literal["found", "none"]
    way: Annotated[tuple[WayPoint, ...], Meta(max_length=10_000)] = ()
    length_m: Length = 0.0

    def extent(self) -> tuple[float, float, float, float]:
        xs = [self.goal.x_m, *(point.x_m for point in self.way)]
        ys = [self.goal.y_m, *(point.y_m for point in self.way)]
        return (min(xs), min(ys), max(xs), max(ys))


class Travel(Message, frozen=True, kw_only=True):
    """How far it is to a target, by the target's id, over floor that is known to be empty, from where the robot stood."""

    state: Literal["reachable", "unreachable"]
    stand: Point
    length_m: Length = 0.0

    def extent(self) -> tuple[float, float, float, float]:
        return self.stand.extent()
