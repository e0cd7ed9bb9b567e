"""What gets in the way of a robot in any world, drawn with the run's seed: a chair, a person who stands there, a door that closes.

A chair is put down close ahead of the robot, where it is going, and stays. A person stands in a passage for a minute. The
door of a passage closes for good, on whichever side the robot then is. Each comes once, as early as its time says and there
is room: nothing comes upon the robot. A world without passages has no door, and its person stands where a chair would.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, inf, sin
from typing import Literal

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from blackboard.messages.geometry import Pose
from sim.kept_state import as_record
from sim.passages import Passage, passages
from sim.world import World

Disturbance = Literal["chair", "person", "door"]
KINDS: tuple[Disturbance, ...] = ("chair", "person", "door")

EARLIEST_S = 20.0  # the robot has looked around by then
S_PER_M2 = 2.0  # the latest time, after the earliest, for each square metre of floor: well before it is explored
STANDS_S = 60.0  # a person stays so long
CHAIR_M, PERSON_M = 0.22, 0.25  # radii
DOOR_M = 0.05  # thickness
AHEAD_M = 0.8  # from the robot's rim to the chair's: it can stop, and has been on its way
MANNERS_M = 0.5  # a person does not step nearer to the robot's rim
GAP_M = 0.05  # what is put down touches nothing


@dataclass
class _Event:
    kind: Disturbance
    due_s: float
    passage: Passage | None
    came_s: float | None = None
    left: bool = False
    place: tuple[float, float] = (0.0, 0.0)


class Disturber:
    """Draws what will happen, and says what stands there now."""

    def __init__(
        self,
        kinds: Sequence[Disturbance],
        world: World,
        radius_m: float,
        max_speed_mps: float,
        rng: np.random.Generator,
    ) -> None:
        self.version = 0  # counts what came and went
        self._radius_m = radius_m
        self._going_mps = max_speed_mps / 2.0
        self._events: list[_Event] = []
        places = passages(world.open_floor(), radius_m) if kinds else []
        latest_s = EARLIEST_S + S_PER_M2 * float(world.floor.area)
        for kind in KINDS:
            due_s, number = float(rng.uniform(EARLIEST_S, latest_s)), int(rng.integers(2**31))
            passage = places[number % len(places)] if places and kind != "chair" else None
            if kind in kinds and (kind != "door" or passage is not None):
                self._events.append(_Event(kind, due_s, passage))
        _keep_apart(self._events)

    def state(self) -> object:
        """Return what came and went, to be pickled at once; what is still to come is drawn the same again."""
        return {"version": self.version, "came": [(e.due_s, e.came_s, e.left, e.place) for e in self._events]}

    def resume(self, state: object) -> None:
        """Go on from a state."""
        record = as_record(state)
        self.version = record["version"]
        for event, came in zip(self._events, record["came"], strict=True):
            event.due_s, event.came_s, event.left, event.place = came

    def notice(self, now_s: float, robot: Pose, forward_mps: float, world: World) -> None:
        """Let what is due come or go, given where the robot is and how fast it drives."""
        for event in self._events:
            if event.came_s is None:
                if now_s >= event.due_s and self._comes(event, robot, forward_mps, world):
                    event.came_s = now_s
                    self.version += 1
            elif event.kind == "person" and not event.left and now_s >= event.came_s + STANDS_S:
                event.left = True
                self.version += 1

    def standing_in(self, world: World) -> World:
        """Return the world with what stands there now."""
        solids: list[BaseGeometry] = []
        circles = []
        for event in self._events:
            if event.came_s is None or event.left:
                continue
            if event.kind == "door" and event.passage is not None:
                solids.append(event.passage.shape(DOOR_M))
            else:
                circles.append((*event.place, CHAIR_M if event.kind == "chair" else PERSON_M))
        return world.with_things(solids, circles)

    def told(self) -> str:
        """Return what came, when and where, for the table at the end."""
        parts = []
        for event in self._events:
            when = "did not come" if event.came_s is None else f"{event.came_s:.1f} s"
            where = "" if event.came_s is None else f" ({event.place[0]:.1f}, {event.place[1]:.1f})"
            parts.append(f"{event.kind} {when}{where}")
        return "; ".join(parts) or "none"

    def _comes(self, event: _Event, robot: Pose, forward_mps: float, world: World) -> bool:
        if event.passage is None:
            radius_m = CHAIR_M if event.kind == "chair" else PERSON_M
            away_m = self._radius_m + AHEAD_M + radius_m
            x_m, y_m = robot.x_m + away_m * cos(robot.heading_rad), robot.y_m + away_m * sin(robot.heading_rad)
            event.place = (x_m, y_m)
            gap_m = float(world.shapes.distances_m(x_m, y_m)[0].min(initial=inf)) - radius_m
            way = shapely.LineString(((robot.x_m, robot.y_m), event.place))
            return bool(forward_mps >= self._going_mps and gap_m >= GAP_M and world.free.contains(way))
        event.place = x_m, y_m = event.passage.middle
        if event.kind == "person":
            return hypot(x_m - robot.x_m, y_m - robot.y_m) >= self._radius_m + PERSON_M + MANNERS_M
        if any(other.passage == event.passage and not other.left for other in self._events if other.kind == "person"):
            return False
        door = event.passage.shape(DOOR_M)
        return float(shapely.distance(door, shapely.Point(robot.x_m, robot.y_m))) >= self._radius_m + GAP_M


def _keep_apart(events: Sequence[_Event]) -> None:
    """Let a person come before a door closes in the same passage."""
    for person in events:
        for door in events:
            if (person.kind, door.kind) == ("person", "door") and person.passage == door.passage:
                person.due_s, door.due_s = sorted((person.due_s, door.due_s))
