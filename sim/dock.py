"""Charging stations: a pad in a wall or on the floor, without a body of its own, that charges a robot which stands before it."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import cos, pi, sin

from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.parameters import require


@dataclass(frozen=True)
class Dock:
    """A charging station: where its pad is, and the heading of a robot that stands before it."""

    x_m: float
    y_m: float
    heading_rad: float
    name: str = ""
    reach_m: float = 0.2  # charges a robot whose rim is no further from the pad
    aside_m: float = 0.1  # and whose middle is no further to its side
    askew_rad: float = pi / 9  # and that is turned by no more
    charging_s: float = 3600.0  # from empty to full

    def __post_init__(self) -> None:
        require(abs(self.heading_rad) <= 2 * pi, "heading_rad", self.heading_rad, "[-2 pi, 2 pi]")
        require(0.01 <= self.reach_m <= 1.0, "reach_m", self.reach_m, "[0.01, 1]")
        require(0.005 <= self.aside_m <= 1.0, "aside_m", self.aside_m, "[0.005, 1]")
        require(0.0 < self.askew_rad <= pi, "askew_rad", self.askew_rad, "(0, pi]")
        require(1.0 <= self.charging_s <= 1e6, "charging_s", self.charging_s, "[1, 1e6]")

    def charges(self, pose: Pose, radius_m: float) -> bool:
        """Say whether a robot at `pose` stands so that it is charged."""
        dx, dy = self.x_m - pose.x_m, self.y_m - pose.y_m
        c, s = cos(self.heading_rad), sin(self.heading_rad)
        before_m, aside_m = c * dx + s * dy - radius_m, c * dy - s * dx
        straight = abs(wrap_angle(pose.heading_rad - self.heading_rad)) <= self.askew_rad
        return straight and abs(before_m) <= self.reach_m and abs(aside_m) <= self.aside_m


@dataclass
class Charge:
    """What the battery was given at docks, as a fraction of a full one; less than nothing where it was not full at first."""

    given: float = 0.0

    def stand(self, dt_s: float, pose: Pose, radius_m: float, docks: Iterable[Dock]) -> None:
        """Charge for `dt_s` where the robot stands before a dock."""
        for dock in docks:
            if dock.charges(pose, radius_m):
                self.given += dt_s / dock.charging_s

    def left(self, used: float) -> float:
        """Return the charge after so much was used in all; no more than full is given, and nothing is owed when empty."""
        self.given = max(min(self.given, used), used - 1.0)
        return max(0.0, 1.0 - used + self.given)
