"""What is around simulated robots at each moment: what stands there, what is put down or taken away, who walks, other robots."""

from collections.abc import Sequence
from math import hypot, inf

import numpy as np
import shapely

from sim.disturbances import Disturber
from sim.drive import APART_M, TOUCH_M, Base
from sim.kept_state import as_record
from sim.people import RoundBody, Walker
from sim.shapes import Neighbourhood, Shapes
from sim.world import World


class Surroundings:
    """A world in the course of time, and the robots in it. Nothing is put down on a robot or on people, but once they have left.

    What is put in a robot's way is put in the way of the one that came first.
    """

    def __init__(self, world: World, walkers: Sequence[Walker], disturber: Disturber | None) -> None:
        self.world = world
        self.walkers = walkers
        self.disturber = disturber
        self.meetings: list[int] = []  # of each robot: how often another and it came to touch
        self._bodies: list[Base] = []
        self._reaches_m: list[float] = []
        self._sensed: list[Neighbourhood] = []  # of each robot
        self._touching: set[frozenset[int]] = set()
        self._first = world
        self._still, self._later = world, world.later  # as its file says; what it becomes
        self._changes = bool(world.later) or disturber is not None
        self._version = 0  # of the disturber's, the one that stands

    def enter(self, body: Base, reach_m: float) -> int:
        """Let a robot in, whose sensors meet nothing further off than this; return its number."""
        self._bodies.append(body)
        self.meetings.append(0)
        self._reaches_m.append(reach_m)
        self._sensed.append(Neighbourhood(self.world.shapes, reach_m))
        return len(self._bodies) - 1

    def state(self) -> object:
        """Return what has come, gone and walked, and who touches whom, to be pickled at once."""
        return {
            "passed": len(self._first.later) - len(self._later),
            "version": self._version,
            "walkers": [walker.state() for walker in self.walkers],
            "disturber": None if self.disturber is None else self.disturber.state(),
            "meetings": self.meetings,
            "touching": self._touching,
        }

    def resume(self, state: object) -> None:
        """Go on from a state."""
        record = as_record(state)
        for walker, kept in zip(self.walkers, record["walkers"], strict=True):
            walker.resume(kept)
        if self.disturber is not None:
            self.disturber.resume(record["disturber"])
        passed, self._version = record["passed"], record["version"]
        self.meetings, self._touching = record["meetings"], record["touching"]
        self._still = self._first.later[passed - 1][1] if passed else self._first
        self._later = self._first.later[passed:]
        stands = self.disturber is not None and self._version > 0
        self._stand(self.disturber.standing_in(self._still) if self.disturber and stands else self._still)

    def pass_time(self, now_s: float, dt_s: float) -> None:
        """Let what is due come and go, and people walk."""
        if self._changes:
            self._change(now_s)
        fits = self._fits if self._changes else None  # else every way was checked when the world was read
        for walker in self.walkers:
            walker.walk(dt_s, self._bodies, fits)

    def meet(self, number: int) -> None:
        """Let the robots that one has just driven up to feel it, and count those that it did not touch before."""
        mover = self._bodies[number]
        for other_number, other in enumerate(self._bodies):
            if other_number == number:
                continue
            pair = frozenset((number, other_number))
            gap_m = hypot(other.x_m - mover.x_m, other.y_m - mover.y_m) - mover.radius_m - other.radius_m
            if gap_m >= APART_M:
                self._touching.discard(pair)
                continue
            other.feel(self.others(other_number))
            if gap_m < TOUCH_M and pair not in self._touching:
                self._touching.add(pair)
                self.meetings[number] += 1
                self.meetings[other_number] += 1

    def people_at(self) -> list[tuple[float, float, float]]:
        """Return where those who walk are: x m, y m, radius m."""
        return [(w.x_m, w.y_m, w.radius_m) for w in self.walkers]

    def others(self, number: int) -> list[RoundBody]:
        """Return what moves beside a robot: people and other robots."""
        return [*self.walkers, *self._bodies[:number], *self._bodies[number + 1 :]]

    def seen_by(self, number: int) -> Shapes:
        """Return what rays from a robot can meet, people and other robots included."""
        body = self._bodies[number]
        shapes = self._sensed[number].at(body.x_m, body.y_m)
        moving = [(other.x_m, other.y_m, other.radius_m) for other in self.others(number)]
        return shapes.with_rough_circles(np.array(moving).T) if moving else shapes

    def _change(self, now_s: float) -> None:
        due = bool(self._later) and now_s >= self._later[0][0]
        version = 0
        if self.disturber is not None:
            first = self._bodies[0]
            self.disturber.notice(now_s, first.pose, first.forward_mps, self.world)
            version = self.disturber.version
        if not due and version == self._version:
            return
        still = self._later[0][1] if due else self._still
        world = self.disturber.standing_in(still) if self.disturber is not None else still
        places = [(x, y) for x, y, _ in self.people_at()] + [(body.x_m, body.y_m) for body in self._bodies]
        have_room = all(_fits_in(world.shapes, *person) for person in self.people_at())
        have_room &= all(body.fits_in(world.shapes) for body in self._bodies)
        if have_room and bool(
            shapely.contains_xy(world.free, places).all()
        ):  # else something larger stands over somebody
            self._still, self._version = still, version
            self._later = self._later[1:] if due else self._later
            self._stand(world)

    def _stand(self, world: World) -> None:
        self.world = world
        self._sensed = [Neighbourhood(world.shapes, reach_m) for reach_m in self._reaches_m]
        for body in self._bodies:
            body.stand_in(world.shapes)

    def _fits(self, x_m: float, y_m: float, radius_m: float) -> bool:
        return _fits_in(self.world.shapes, x_m, y_m, radius_m)


def _fits_in(shapes: Shapes, x_m: float, y_m: float, radius_m: float) -> bool:
    """Say whether a person has room at a place; brushing along a wall is no fault."""
    return float(shapes.distances_m(x_m, y_m)[0].min(initial=inf)) >= 0.99 * radius_m
