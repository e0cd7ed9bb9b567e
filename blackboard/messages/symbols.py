"""What the map means: corners, relations of lines, places worth a visit, traps. Map frame."""

from math import pi
from typing import Annotated, Literal

from msgspec import Meta

from blackboard.messages.base import Angle, Count, Length, Message, Name, Text
from blackboard.messages.geometry import Point

Opening = Annotated[float, Meta(ge=0.0, le=pi)]
Correlation = Annotated[float, Meta(ge=-1.0, le=1.0)]
Pair = Annotated[tuple[Name, ...], Meta(min_length=2, max_length=2)]
Extent = tuple[float, float, float, float]


class Corner(Message, frozen=True, kw_only=True):
    """Where two lines meet or nearly meet.

    The lines leave `place` at an angle of `opening_rad`, half way between which `bisector_rad` points. `shape` is as sensed:
    concave where the robot's side lies within that angle (the corner of a room), convex where it lies outside (of a
    cabinet). `gap_m` is how far the lines end short of it; `lines` are the keys of the longest line on either arm.
    """

    place: Point
    sigma_x_m: Length
    sigma_y_m: Length
    correlation: Correlation
    opening_rad: Opening
    bisector_rad: Angle
    shape: Literal["concave", "convex", "unknown"]
    gap_m: Length
    lines: Pair

    def extent(self) -> Extent:
        return self.place.extent()


class LineRelation(Message, frozen=True, kw_only=True):
    """Two lines that run alike: `parallel` ones side by side along `shared_m`, `collinear` ones with `gap_m` between their ends.

    `distance_m` is that between their carriers, at `place`, half way between the lines; `lines` are the keys of the longest
    line of either.
    """

    relation: Literal["parallel", "collinear"]
    place: Point
    angle_rad: Opening
    distance_m: Length
    shared_m: Length = 0.0
    gap_m: Length = 0.0
    lines: Pair

    def extent(self) -> Extent:
        return self.place.extent()


class Target(Message, frozen=True, kw_only=True):
    """A place worth a visit: the centre of a frontier, ends of lines, a corner or an object that rules want looked at.

    From `stand` a robot of its size could look at it.
    """

    place: Point
    stand: Point
    reason: Literal["frontier", "line end", "corner", "object"]
    size_m: Length

    def extent(self) -> Extent:
        return self.place.extent()


class FoundObject(Message, frozen=True, kw_only=True):
    """A round thing of a colour and size that was looked for: where it seems to stand, and how large it seems to be.

    `sightings` counts all, `places` those from places apart, which tell size and place.
    """

    object: Name
    colour: Name
    standing: Literal["suspected", "confirmed"]
    place: Point
    sigma_m: Length
    radius_m: Length
    sightings: Count
    places: Count

    def extent(self) -> Extent:
        return self.place.extent()


class Trap(Message, frozen=True, kw_only=True):
    """Where reflexes alone would stay: a U on the map, a cycle that shows nothing new, or no progress. `size_m` across."""

    trap: Literal["u-shape", "cycling", "no progress"]
    place: Point
    size_m: Length
    detail: Text = ""

    def extent(self) -> Extent:
        return self.place.extent()
