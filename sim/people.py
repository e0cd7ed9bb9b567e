"""People who walk: along waypoints, with pauses, and with the manners that people have.

A courteous person stops an arm's length before a robot that is in the way, waits, and turns round when it does not give way.
A person without manners walks until they touch, and then does the same; both stop before what was put in their way. Nobody ever
stands inside a robot; nobody minds other people.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Protocol

import numpy as np

from blackboard.parameters import require
from sim.kept_state import as_record

ARM_M = 0.5  # a courteous person keeps this from the robot's surface to their own
PASSING_M = 0.3  # and passes it where this much is left between them
SKIN_M = 1e-4  # gap that stays when two bodies touch


class RoundBody(Protocol):
    """A person or a robot, seen from above; metres, map frame."""

    @property
    def x_m(self) -> float: ...

    @property
    def y_m(self) -> float: ...

    @property
    def radius_m(self) -> float: ...


@dataclass(frozen=True)
class Person:
    """How somebody walks. A path that ends where it began is walked round and round, others there and back."""

    path: tuple[tuple[float, ...], ...]  # (x m, y m) waypoints
    name: str = ""
    speed_mps: float = 0.8  # an easy indoor walk
    pause_s: float = 2.0  # mean stay at a waypoint; each is 0.5 to 1.5 times it
    stays_s: tuple[
        float, ...
    ] = ()  # how long exactly at each waypoint, the first at the start too, in place of pause_s
    radius_m: float = 0.25
    patience_s: float = 4.0  # waits this long for the robot before turning round
    courteous: bool = True

    def __post_init__(self) -> None:
        require(0.0 < self.speed_mps <= 3.0, "speed_mps", self.speed_mps, "(0, 3]")
        require(0.0 <= self.pause_s <= 3600.0, "pause_s", self.pause_s, "[0, 3600]")
        require(0.05 <= self.radius_m <= 1.0, "radius_m", self.radius_m, "[0.05, 1]")
        require(0.0 <= self.patience_s <= 3600.0, "patience_s", self.patience_s, "[0, 3600]")
        require(all(0.0 <= stay <= 1e6 for stay in self.stays_s), "stays_s", self.stays_s, "[0, 1e6] seconds each")
        if self.stays_s:
            limit = f"{len(self.path)}, one for each waypoint"
            require(len(self.stays_s) == len(self.path), "number of stays_s", len(self.stays_s), limit)
        require(2 <= len(self.path) <= 1000, "number of waypoints in path", len(self.path), "[2, 1000]")

    @property
    def goes_round(self) -> bool:
        return len(self.path) > 3 and self.path[0] == self.path[-1]


class Walker:
    """A person on the way."""

    def __init__(self, person: Person, rng: np.random.Generator) -> None:
        self.person = person
        self._rng = rng
        self.x_m, self.y_m = person.path[0]
        self._from = 0  # index of the waypoint that was left
        self._step = 1
        self._pause_s = person.stays_s[0] if person.stays_s else 0.0
        self._waited_s = 0.0

    @property
    def radius_m(self) -> float:
        return self.person.radius_m

    @property
    def waiting(self) -> bool:
        """Say whether a robot is in the way."""
        return self._waited_s > 0.0

    def state(self) -> object:
        """Return how far somebody has come, to be pickled at once."""
        return {name: value for name, value in vars(self).items() if name != "person"}

    def resume(self, state: object) -> None:
        """Go on from a state."""
        vars(self).update(as_record(state))

    def walk(
        self,
        dt_s: float,
        robots: Sequence[RoundBody],
        fits: Callable[[float, float, float], bool] | None = None,
    ) -> None:
        """Let `dt_s` pass; what `fits` says no to, of a place and a radius, is in the way as a robot may be."""
        if self._pause_s > 0.0:
            self._pause_s -= dt_s
            return
        to_x, to_y = self._next()
        dx, dy = to_x - self.x_m, to_y - self.y_m
        left_m = hypot(dx, dy)
        go_m = min(self.person.speed_mps * dt_s, left_m)
        if left_m > 0.0:
            dx, dy = dx / left_m, dy / left_m
        way_m = min((self._way_m(dx, dy, go_m, robot) for robot in robots), default=go_m)
        if way_m and fits and not fits(self.x_m + way_m * dx, self.y_m + way_m * dy, self.person.radius_m):
            way_m = 0.0
        self.x_m += way_m * dx
        self.y_m += way_m * dy
        if way_m < go_m:
            self._waited_s += dt_s
            if self._waited_s > self.person.patience_s:
                self._turn_round()
            return
        self._waited_s = 0.0
        if go_m >= left_m:
            self._arrive()

    def _way_m(self, dx: float, dy: float, go_m: float, robot: RoundBody) -> float:
        """Return how far one goes along (dx, dy), at most `go_m`, because of a robot."""
        robot_dx, robot_dy = robot.x_m - self.x_m, robot.y_m - self.y_m
        touching_m = robot.radius_m + self.person.radius_m + SKIN_M
        distance = hypot(robot_dx, robot_dy)
        ahead = robot_dx * dx + robot_dy * dy
        if ahead <= 0.0 or distance > touching_m + ARM_M + go_m:
            return go_m
        aside = abs(robot_dx * dy - robot_dy * dx)
        if self.person.courteous and aside < touching_m + PASSING_M and distance < touching_m + ARM_M:
            return 0.0
        if aside >= touching_m:
            return go_m
        return min(go_m, max(0.0, ahead - sqrt(touching_m * touching_m - aside * aside)))

    def _next(self) -> tuple[float, ...]:
        return self.person.path[self._from + self._step]

    def _arrive(self) -> None:
        path = self.person.path
        self._from += self._step
        if self.person.goes_round:
            if self._step > 0 and self._from == len(path) - 1:
                self._from = 0
            elif self._step < 0 and self._from == 0:
                self._from = len(path) - 1
        elif not 0 <= self._from + self._step < len(path):
            self._step = -self._step
        if self.person.stays_s:
            self._pause_s = self.person.stays_s[self._from]
        else:
            self._pause_s = self.person.pause_s * float(self._rng.uniform(0.5, 1.5))

    def _turn_round(self) -> None:
        self._from += self._step  # now on the way back from the waypoint that was ahead
        self._step = -self._step
        self._waited_s = 0.0
