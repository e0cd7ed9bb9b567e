"""A round body on two driven wheels: speeds that change at limited rates, arcs, and contact with what is in the way."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, sin

import numpy as np

from blackboard.messages.geometry import Pose, wrap_angle
from sim.kept_state import as_record
from sim.people import SKIN_M, RoundBody
from sim.sensor_models import Body
from sim.shapes import Neighbourhood, Shapes

TOUCH_M = 1e-3  # nearer than this is contact
APART_M = 5e-3  # and beyond this contact has ended
SAME_CONTACT_RAD = 0.7  # bearings nearer to each other than this are one contact
PUSHING_MPS = 0.01  # slower than this towards the contact, the robot did not cause it
LOOK_M = 2.0  # how far from its rim obstacles are looked up; only what is within one step can matter
HALVINGS = 7


@dataclass
class Contacts:
    """What is touched (directions in the map frame) and how often contact was made, by whom."""

    bearings_rad: tuple[float, ...] = ()
    caused: int = 0
    by_others: int = 0


def arc(x_m: float, y_m: float, heading_rad: float, distance_m: float, turn_rad: float) -> tuple[float, float, float]:
    """Return the pose after driving an arc of this length and turn; exact for constant speeds."""
    half = turn_rad / 2.0
    chord = distance_m * (sin(half) / half if abs(half) > 1e-9 else 1.0)
    return (
        x_m + chord * cos(heading_rad + half),
        y_m + chord * sin(heading_rad + half),
        wrap_angle(heading_rad + turn_rad),
    )


def approach(speed: float, wanted: float, most: float) -> float:
    """Return `speed` moved towards `wanted` by at most `most`."""
    return min(wanted, speed + most) if wanted > speed else max(wanted, speed - most)


class Base:
    """Moves the body, and stops it where it touches."""

    def __init__(self, body: Body, shapes: Shapes, start: Pose) -> None:
        self._body = body
        self._look_m = body.radius_m + LOOK_M
        self._near = Neighbourhood(shapes, self._look_m)
        self.x_m, self.y_m, self.heading_rad = start.x_m, start.y_m, start.heading_rad
        self.forward_mps = 0.0
        self.turn_radps = 0.0
        self.contacts = Contacts()
        self.distance_m = 0.0  # the way driven, forwards and backwards
        self.turned_rad = 0.0
        self._room_m = 0.0  # this far nothing that stands still can be touched

    @property
    def radius_m(self) -> float:
        return self._body.radius_m

    @property
    def pose(self) -> Pose:
        return Pose(x_m=self.x_m, y_m=self.y_m, heading_rad=self.heading_rad)

    def state(self) -> object:
        """Return where it is and how it moves, to be pickled at once."""
        return {name: value for name, value in vars(self).items() if name not in ("_body", "_look_m", "_near")}

    def resume(self, state: object) -> None:
        """Go on from a state."""
        vars(self).update(as_record(state))
        self._room_m = 0.0

    def put(self, pose: Pose) -> bool:
        """Stand at a pose, if there is room among what stands still; say whether there is."""
        here = self.x_m, self.y_m
        self.x_m, self.y_m, self._room_m = pose.x_m, pose.y_m, 0.0
        if not self.fits_in(self._near.at(pose.x_m, pose.y_m)):
            self.x_m, self.y_m = here
            return False
        self.heading_rad = pose.heading_rad
        return True

    def fits_in(self, shapes: Shapes) -> bool:
        """Say whether the body, where it is, fits between these things."""
        distance = shapes.distances_m(self.x_m, self.y_m)[0]
        return float(distance.min(initial=self._look_m)) >= self._body.radius_m + APART_M

    def stand_in(self, shapes: Shapes) -> None:
        """Let other things stand round the body from now on."""
        self._near = Neighbourhood(shapes, self._look_m)
        self._room_m = 0.0

    def step(self, dt_s: float, forward_mps: float, turn_radps: float, others: Sequence[RoundBody]) -> None:
        """Drive for `dt_s` towards the wanted speeds, cut to what the robot can do; `others` are those who move: people, robots."""
        body = self._body
        wanted = min(max(forward_mps, -body.max_speed_mps), body.max_speed_mps)
        wanted_turn = min(max(turn_radps, -body.max_turn_radps), body.max_turn_radps)
        before, before_turn = self.forward_mps, self.turn_radps
        self.forward_mps = approach(before, wanted, body.max_acceleration_mps2 * dt_s)
        self.turn_radps = approach(before_turn, wanted_turn, body.max_turn_acceleration_radps2 * dt_s)
        mean = (before + self.forward_mps) / 2.0
        way, turn = mean * dt_s, (before_turn + self.turn_radps) / 2.0 * dt_s
        if way or turn:
            self.distance_m += self._move(way, turn, others)
            self.turned_rad += abs(turn)
        near = way != 0.0 and self._room_m < APART_M
        if near or self.contacts.bearings_rad or any(self._gap_m(other) < APART_M for other in others):
            self._feel(mean, others)

    def feel(self, others: Sequence[RoundBody]) -> None:
        """Feel what has come near, between two steps."""
        self._feel(self.forward_mps, others)

    def _move(self, way_m: float, turn_rad: float, others: Sequence[RoundBody]) -> float:
        """Turn, and go along the arc as far as nothing is in the way; return how far that was."""
        pose = arc(self.x_m, self.y_m, self.heading_rad, way_m, turn_rad)
        if not self._free(pose[0], pose[1], abs(way_m), others):
            free, blocked = 0.0, 1.0
            for _ in range(HALVINGS):
                middle = (free + blocked) / 2.0
                x, y, _heading = arc(self.x_m, self.y_m, self.heading_rad, middle * way_m, middle * turn_rad)
                free, blocked = (middle, blocked) if self._free(x, y, None, others) else (free, middle)
            way_m *= free
            self.forward_mps = 0.0
            self._room_m = 0.0
            x, y, _heading = arc(self.x_m, self.y_m, self.heading_rad, way_m, free * turn_rad)
            pose = (x, y, wrap_angle(self.heading_rad + turn_rad))  # a round body can still turn
        self.x_m, self.y_m, self.heading_rad = pose
        return abs(way_m)

    def _free(self, x_m: float, y_m: float, way_m: float | None, others: Sequence[RoundBody]) -> bool:
        """Say whether the body fits at a place; `way_m`, the way there, is taken off the room that is known to be free."""
        for other in others:
            if hypot(other.x_m - x_m, other.y_m - y_m) < self._touching_m(other) and self._nears(other, x_m, y_m):
                return False
        if way_m is not None:
            self._room_m -= way_m
            if self._room_m > 0.0:
                return True
        distance = self._near.at(x_m, y_m).distances_m(x_m, y_m)[0]
        room = float(distance.min(initial=self._look_m)) - self._body.radius_m - SKIN_M
        self._room_m = max(room, 0.0)
        return room >= 0.0

    def _touching_m(self, other: RoundBody) -> float:
        return self._body.radius_m + other.radius_m + SKIN_M

    def _nears(self, other: RoundBody, x_m: float, y_m: float) -> bool:
        return hypot(other.x_m - x_m, other.y_m - y_m) < hypot(other.x_m - self.x_m, other.y_m - self.y_m)

    def _gap_m(self, other: RoundBody) -> float:
        return hypot(other.x_m - self.x_m, other.y_m - self.y_m) - self._body.radius_m - other.radius_m

    def _feel(self, forward_mps: float, others: Sequence[RoundBody]) -> None:
        """Find what is touched now, and count what was not touched before."""
        distance, to_x, to_y = self._near.at(self.x_m, self.y_m).distances_m(self.x_m, self.y_m)
        gaps = distance - self._body.radius_m
        found = [(float(gaps[i]), atan2(to_y[i], to_x[i]), True) for i in np.nonzero(gaps < APART_M)[0].tolist()]
        for other in others:
            gap = self._gap_m(other)
            if gap < APART_M:
                found.append((gap, atan2(other.y_m - self.y_m, other.x_m - self.x_m), False))
        touched: list[float] = []
        for gap, bearing, stands in sorted(found):
            known = any(_same(bearing, b) for b in self.contacts.bearings_rad)
            if any(_same(bearing, b) for b in touched) or (gap >= TOUCH_M and not known):
                continue
            touched.append(bearing)
            if known:
                continue
            if stands or forward_mps * cos(bearing - self.heading_rad) > PUSHING_MPS:
                self.contacts.caused += 1
            else:
                self.contacts.by_others += 1
        self.contacts.bearings_rad = tuple(touched)


def _same(a_rad: float, b_rad: float) -> bool:
    return abs(wrap_angle(a_rad - b_rad)) < SAME_CONTACT_RAD
