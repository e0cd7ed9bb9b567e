"""What is around a simulated robot at each moment: what stands there, what is put down or taken away, who walks."""

from collections.abc import Sequence
from math import inf

import numpy as np

from sim.disturbances import Disturber
from sim.drive import Base
from sim.people import Walker
from sim.shapes import Neighbourhood, Shapes
from sim.world import World


class Surroundings:
    """A world in the course of time. Nothing is put down on the robot or on people, but once they have left."""

    def __init__(self, world: World, walkers: Sequence[Walker], reach_m: float, disturber: Disturber | None) -> None:
        self.world = world
        self.walkers = walkers
        self.disturber = disturber
        self._still, self._later = world, world.later  # as its file says; what it becomes
        self._changes = bool(world.later) or disturber is not None
        self._version = 0  # of the disturber's, the one that stands
        self._reach_m = reach_m
        self._sensed = Neighbourhood(world.shapes, reach_m)

    def pass_time(self, now_s: float, dt_s: float, base: Base, radius_m: float) -> None:
        """Let what is due come and go, and people walk."""
        if self._changes:
            self._change(now_s, base)
        fits = self._fits if self._changes else None  # else every way was checked when the world was read
        for walker in self.walkers:
            walker.walk(dt_s, base.x_m, base.y_m, radius_m, fits)

    def people_at(self) -> list[tuple[float, float, float]]:
        """Return where those who walk are: x m, y m, radius m."""
        return [(w.x_m, w.y_m, w.person.radius_m) for w in self.walkers]

    def seen_from(self, x_m: float, y_m: float) -> Shapes:
        """Return what rays from a place can meet, people included."""
        shapes = self._sensed.at(x_m, y_m)
        return shapes.with_rough_circles(np.array(self.people_at()).T) if self.walkers else shapes

    def _change(self, now_s: float, base: Base) -> None:
        due = bool(self._later) and now_s >= self._later[0][0]
        version = 0
        if self.disturber is not None:
            self.disturber.notice(now_s, base.pose, base.forward_mps, self.world)
            version = self.disturber.version
        if not due and version == self._version:
            return
        still = self._later[0][1] if due else self._still
        world = self.disturber.standing_in(still) if self.disturber is not None else still
        if all(_fits_in(world.shapes, *person) for person in self.people_at()) and base.stand_in(world.shapes):
            self.world, self._still, self._version = world, still, version
            self._later = self._later[1:] if due else self._later
            self._sensed = Neighbourhood(world.shapes, self._reach_m)

    def _fits(self, x_m: float, y_m: float, radius_m: float) -> bool:
        return _fits_in(self.world.shapes, x_m, y_m, radius_m)


def _fits_in(shapes: Shapes, x_m: float, y_m: float, radius_m: float) -> bool:
    """Say whether a person has room at a place; brushing along a wall is no fault."""
    return float(shapes.distances_m(x_m, y_m)[0].min(initial=inf)) >= 0.99 * radius_m
