"""What can stand in a world file: the records of its tables, in metres and seconds."""

from dataclasses import dataclass
from math import pi
from typing import Literal

from blackboard.key_expressions import is_chunk
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.parameters import require
from sim.world import FAR_M

Surface = Literal["smooth", "rough"]
Points = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Floor:
    """The outline of the floor: its edge is a wall."""

    outline: Points
    surface: Surface = "smooth"


@dataclass(frozen=True)
class Start:
    """Where the robot starts."""

    x_m: float
    y_m: float
    heading_rad: float = 0.0

    def __post_init__(self) -> None:
        for key in ("x_m", "y_m"):
            require(abs(getattr(self, key)) <= FAR_M, key, getattr(self, key), f"[-{FAR_M:g}, {FAR_M:g}]")
        require(abs(self.heading_rad) <= 2 * pi, "heading_rad", self.heading_rad, "[-2 pi, 2 pi]")

    def pose(self) -> Pose:
        return Pose(x_m=self.x_m, y_m=self.y_m, heading_rad=wrap_angle(self.heading_rad))


def _check_stay(from_s: float, until_s: float | None) -> None:
    require(0.0 <= from_s <= 1e7, "from_s", from_s, "[0, 1e7] seconds")
    if until_s is not None:
        require(from_s < until_s <= 1e7, "until_s", until_s, f"({from_s:g}, 1e7] seconds, after from_s")


def _check_colour(colour: str) -> None:
    require(not colour or is_chunk(colour), "colour", colour, "words of letters, digits, '_', '-' and '.'")


@dataclass(frozen=True)
class Wall:
    """A wall along a line; one that ends where it began is closed."""

    line: Points
    name: str = ""
    thickness_m: float = 0.02  # a thin partition
    surface: Surface = "smooth"
    from_s: float = 0.0  # there from then on: put down, or closed
    until_s: float | None = None  # and taken away then

    def __post_init__(self) -> None:
        _check_stay(self.from_s, self.until_s)
        require(0.001 <= self.thickness_m <= 10.0, "thickness_m", self.thickness_m, "[0.001, 10]")


@dataclass(frozen=True)
class Polygon:
    """A solid thing: cabinet, table, pillar."""

    outline: Points
    name: str = ""
    surface: Surface = "smooth"
    colour: str = ""  # what a camera tells of it; without one it only hides what is behind it
    from_s: float = 0.0  # there from then on: put down, or closed
    until_s: float | None = None  # and taken away then

    def __post_init__(self) -> None:
        _check_stay(self.from_s, self.until_s)
        _check_colour(self.colour)


@dataclass(frozen=True)
class Box:
    """A rectangle, turned by its heading about its centre."""

    centre: tuple[float, ...]
    size: tuple[float, ...]
    name: str = ""
    heading_rad: float = 0.0
    surface: Surface = "smooth"
    colour: str = ""  # what a camera tells of it; without one it only hides what is behind it
    from_s: float = 0.0  # there from then on: put down, or closed
    until_s: float | None = None  # and taken away then

    def __post_init__(self) -> None:
        _check_stay(self.from_s, self.until_s)
        _check_colour(self.colour)


@dataclass(frozen=True)
class Circle:
    """Round things of one radius: drums, pillars, the legs of a chair."""

    centres: Points
    radius_m: float
    name: str = ""
    surface: Surface = "smooth"
    colour: str = ""  # what a camera tells of it; without one it only hides what is behind it
    from_s: float = 0.0  # there from then on: put down, or closed
    until_s: float | None = None  # and taken away then

    def __post_init__(self) -> None:
        _check_stay(self.from_s, self.until_s)
        _check_colour(self.colour)
        require(0.005 <= self.radius_m <= 100.0, "radius_m", self.radius_m, "[0.005, 100]")
