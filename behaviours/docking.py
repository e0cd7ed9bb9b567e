"""Docks: the last piece to a charging station, slow, straight and aligned, until the battery is charged.

Motivated by  x_m, y_m, heading_rad                  the station, and the heading of a robot that charges there, map frame
Reads  motivations/motivation/<its name>             Motivation
       status/robot                                  RobotDescription
       observations/signal/battery                   Battery
       observations/signal/bumper                    Bumper
       hypotheses/feature/map_from_odom              Pose
       observations/feature/odom_from_robot          Pose
Posts  control/switch/avoid_obstacles.<its name>     Switch   while it answers

After Bou-Ghannam 1992, section 4.2.1. It lines up before the station, turns, and goes on until it goes no further; the safety
layer below decides how near that is. Where nothing charges it tries again a little to the side, since the pose is known no better.
While the battery charges it stands still, and avoid-obstacles stays silent, until another motivation stops it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import atan2, cos, hypot, pi, sin
from typing import Literal

from behaviours.asked import numbers
from behaviours.whereabouts import POSE_READS, map_from_robot
from blackboard.access import Access
from blackboard.component import Behaviour, Progress
from blackboard.kinds import BATTERY, BUMPER, ROBOT
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.motion import Response, Switch
from blackboard.parameters import require

SIDES = (0, 1, -1, 2, -2)  # where it tries, in steps to the side
FULL = 0.999  # a full battery's charge rises no more
LOST = 0.005  # a charge that falls by so much is charged no more
GOT_ON_M = 0.02  # less is standing
STAND = Response()
TURN_GAIN_PER_S = 2.0

Phase = Literal["line up", "turn", "approach", "wait", "charge", "give up"]


@dataclass(frozen=True, slots=True, kw_only=True)
class DockingParams:
    """How it goes, and when it tries again."""

    tunes: str = "avoid_obstacles"  # the behaviour whose threshold it raises
    lining_threshold: float = 1.0  # while it lines up, as charge-battery left it
    docking_threshold: float = 20.0  # on the last piece and while it charges: no answer of avoid-obstacles is longer
    before_m: float = 0.5  # it lines up so far before the station, from its rim
    lined_m: float = 0.06  # so near to that place, or to the line on from there
    facing_rad: float = 0.05
    turn_radps: float = 0.6
    strength: float = 0.25  # of full speed on the last piece
    look_m: float = 0.4  # steers for a point so far ahead on the line
    aside_m: float = 0.12  # further from the line it tries again
    askew_rad: float = pi / 9  # turned by more likewise
    over_m: float = 0.15  # its rim goes on so far past the place of the station: the pose is known no better
    stop_s: float = 5.0  # it stands when it gained nothing for so long: what safety heard but once is forgotten by then
    wait_s: float = 25.0  # for the charge to rise: two readings of a slow battery
    side_m: float = 0.12  # between one try and the next

    def __post_init__(self) -> None:
        for name in ("lining_threshold", "docking_threshold"):
            require(0.0 <= getattr(self, name) <= 1000.0, name, getattr(self, name), "[0, 1000]")
        for name in ("lined_m", "look_m", "aside_m", "over_m", "side_m"):
            require(0.01 <= getattr(self, name) <= 2.0, name, getattr(self, name), "[0.01, 2]")
        require(0.1 <= self.before_m <= 5.0, "before_m", self.before_m, "[0.1, 5]")
        for name in ("facing_rad", "askew_rad"):
            require(0.01 <= getattr(self, name) <= 1.0, name, getattr(self, name), "[0.01, 1]")
        require(0.05 <= self.turn_radps <= 3.0, "turn_radps", self.turn_radps, "[0.05, 3]")
        require(0.15 <= self.strength <= 0.5, "strength", self.strength, "[0.15, 0.5]")
        for name in ("stop_s", "wait_s"):
            require(0.5 <= getattr(self, name) <= 600.0, name, getattr(self, name), "[0.5, 600]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """How far docking is: the phase, since when, and which try it is."""

    phase: Phase = "line up"
    number: int = 0
    since_s: float = 0.0
    nearest_m: float = 0.0  # how near to the pad its rim has come on the last piece
    charge: float | None = None  # at the last look
    best: float = 0.0  # while it charges


def before_station(pose: Pose, station: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return how far before the pad a robot is (m), how far left of the line that leads there (m), and how far turned (rad)."""
    x_m, y_m, heading_rad = station
    dx, dy, c, s = pose.x_m - x_m, pose.y_m - y_m, cos(heading_rad), sin(heading_rad)
    return -(c * dx + s * dy), c * dy - s * dx, wrap_angle(pose.heading_rad - heading_rad)


def again(attempt: Attempt, now_s: float) -> Attempt:
    """Return the next try, a step to the side, or the last word."""
    number = attempt.number + 1
    phase: Phase = "line up" if number < len(SIDES) else "give up"
    return Attempt(phase=phase, number=number, since_s=now_s, charge=attempt.charge)


def docking_response(
    attempt: Attempt,
    pose: Pose,
    station: tuple[float, float, float],
    radius_m: float,
    charge: float | None,
    touched: bool,
    now_s: float,
    params: DockingParams,
) -> tuple[Attempt, Response | None]:
    """Return how far docking is now and the response; `pose` is map_from_robot, `charge` the newest reading of the battery."""
    rises = charge is not None and attempt.charge is not None and charge > attempt.charge
    attempt = replace(attempt, charge=charge)
    before_m, left_m, turned_rad = before_station(pose, station)
    aside_m = left_m - SIDES[min(attempt.number, len(SIDES) - 1)] * params.side_m
    full = charge is not None and charge >= FULL and attempt.phase == "wait"
    if charge is not None and attempt.phase in ("approach", "wait") and (rises or full):
        return replace(attempt, phase="charge", since_s=now_s, best=charge), STAND
    if attempt.phase == "line up":
        ahead_m = before_m - radius_m - params.before_m
        if hypot(ahead_m, aside_m) > params.lined_m:
            return attempt, _towards(ahead_m, aside_m, turned_rad)
        attempt = replace(attempt, phase="turn", since_s=now_s)
    if attempt.phase == "turn":
        if abs(turned_rad) > params.facing_rad:
            rate_radps = max(-params.turn_radps, min(params.turn_radps, -TURN_GAIN_PER_S * turned_rad))
            return attempt, Response(turn_radps=rate_radps)
        attempt = replace(attempt, phase="approach", since_s=now_s, nearest_m=before_m - radius_m)
    if attempt.phase == "approach":
        return _last_piece(attempt, before_m - radius_m, aside_m, turned_rad, touched, now_s, params)
    if attempt.phase == "wait":
        return (again(attempt, now_s) if now_s - attempt.since_s >= params.wait_s else attempt), STAND
    if attempt.phase == "charge" and charge is not None:
        if charge < attempt.best - LOST:
            return Attempt(since_s=now_s, charge=charge), STAND
        return replace(attempt, best=max(attempt.best, charge)), STAND
    return attempt, None


def _last_piece(
    attempt: Attempt,
    rim_before_m: float,
    aside_m: float,
    turned_rad: float,
    touched: bool,
    now_s: float,
    params: DockingParams,
) -> tuple[Attempt, Response]:
    """Go on along the line; wait where it goes no further, try again where it is off the line."""
    if abs(aside_m) > params.aside_m or abs(turned_rad) > params.askew_rad:
        return again(attempt, now_s), STAND
    if rim_before_m <= attempt.nearest_m - GOT_ON_M:
        attempt = replace(attempt, since_s=now_s, nearest_m=rim_before_m)
    if touched or now_s - attempt.since_s >= params.stop_s or rim_before_m <= -params.over_m:
        return replace(attempt, phase="wait", since_s=now_s), STAND
    bearing_rad = atan2(-aside_m, params.look_m) - turned_rad
    return attempt, Response(forward=params.strength * cos(bearing_rad), left=params.strength * sin(bearing_rad))


def _towards(ahead_m: float, aside_m: float, turned_rad: float) -> Response:
    """Return the vector, shorter near its goal, towards a place that lies `ahead_m` on and `aside_m` to the right."""
    length = max(0.25, min(0.6, hypot(ahead_m, aside_m)))
    bearing_rad = atan2(-aside_m, ahead_m) - turned_rad
    return Response(forward=length * cos(bearing_rad), left=length * sin(bearing_rad))


class Docking(Behaviour[DockingParams]):
    """Goes up to a charging station and stands there."""

    Params = DockingParams
    motivated = True
    parameters = ("x_m", "y_m", "heading_rad")
    reads = (*POSE_READS, ROBOT, BATTERY, BUMPER)

    def __init__(self, params: DockingParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._station: tuple[float, float, float] | None = None
        self._attempt = Attempt()

    def select(self, parameters: tuple[float | str, ...]) -> None:
        self._station = None
        x_m, y_m, heading_rad = numbers(self.name, self.parameters, parameters)
        self._station, self._attempt = (x_m, y_m, heading_rad), Attempt()

    def respond(self, board: Access) -> Response | None:
        pose, robot, battery, bumper = map_from_robot(board), *(board.newest(k) for k in (ROBOT, BATTERY, BUMPER))
        if pose is None or robot is None or self._station is None:
            return None
        charge = battery.value.charge_fraction if battery is not None else None
        touched = bumper is not None and bool(bumper.value.bearings_rad)
        radius_m = robot.value.radius_m
        self._attempt, response = docking_response(
            self._attempt, pose, self._station, radius_m, charge, touched, board.now_s, self.params
        )
        return response

    def adjusts(self) -> Mapping[str, Switch]:
        last = self._attempt.phase in ("approach", "wait", "charge")
        threshold = self.params.docking_threshold if last else self.params.lining_threshold
        return {self.params.tunes: Switch(threshold=threshold)}

    def progress(self) -> Progress:
        phase, number = self._attempt.phase, self._attempt.number
        if self._station is None:
            return Progress()
        if phase == "charge":
            return Progress("reached", detail="the battery charges")
        if phase == "give up":
            return Progress("blocked", detail=f"nothing charges there; tried {len(SIDES)} times")
        return Progress("underway", detail=f"{phase}, try {number + 1} of {len(SIDES)}")
