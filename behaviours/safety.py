"""The reflexes below every behaviour: nothing goes to the wheels that could drive the robot into what it has heard.

Reads  status/robot                     RobotDescription
       observations/signal/odometry     Odometry
       observations/signal/sonar_scan   SonarScan
       observations/signal/laser_scan   LaserScan
       observations/signal/bumper       Bumper

Speed is limited so that the robot stands before it touches anything on its way, also if what was heard only just now walks
towards it. It stops on stale readings, when commands stop coming, and on the bumper, from which it may only move away.
Turning on the spot moves no part of a round robot outwards, so it stays allowed while readings are fresh. Parameters have
hard limits: no mission can switch this off.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import copysign, cos, inf, pi, sqrt
from typing import Literal

from behaviours.corridor import free_travel_m, off_course
from behaviours.near_echoes import READS, Near, NearEchoesParams, around_now, no_echoes, refresh
from blackboard.access import Access
from blackboard.component import SafetyLayer
from blackboard.kinds import BUMPER, LASER_SCAN, ODOMETRY, ROBOT
from blackboard.messages.motion import Drive, Velocity
from blackboard.messages.sensing import LaserScan, RobotDescription
from blackboard.parameters import require

MEMORY = NearEchoesParams(
    reach_m=1.2,  # three times the stopping distance at the default limit of speed
    gap_s=60.0,  # it is asked every cycle: where the sensors were silent what was there may still be there
)
WATCHED_RAD = (
    pi / 5
)  # a sonar watches the way if its axis lies within this of it; rings have 30 to 40 degrees between axes
AWAY = -0.2  # cosine between the way and a contact below which the robot leaves it
MEETING_RAD = 0.6 * pi  # what walks into the robot from further behind is not met by it
WALKER_HEARD_S = 0.5  # who walks is heard again within this, elsewhere: two scans and one lost echo
FRESH_S = 0.3  # younger echoes may lie anywhere in their cone; of older ones the axis is the best guess
SLOWEST_MPS = 0.02  # slower is standing still


@dataclass(frozen=True, slots=True, kw_only=True)
class ReflexSafetyParams:
    """Margins. Every default may be made more careful; the limits keep the layer awake."""

    margin_m: float = 0.06  # kept from the rim: range noise and the width of a remembered cell
    reaction_s: float = 0.2  # two control cycles: one until the next answer, one for the wheels to hear it
    braking_fraction: float = 0.7  # of the robot's acceleration that braking counts on: floors are smooth
    walking_mps: float = 1.0  # what was heard only just now may come on this fast
    fastest_mps: float = 0.5  # whatever was wanted: what comes out of a blind gap is heard late
    creep_mps: float = 0.08  # away from a contact
    stale_after_s: float = 0.5  # older readings count as none

    def __post_init__(self) -> None:
        require(0.02 <= self.margin_m <= 0.5, "margin_m", self.margin_m, "[0.02, 0.5]")
        require(0.1 <= self.reaction_s <= 2.0, "reaction_s", self.reaction_s, "[0.1, 2]")
        require(0.1 <= self.braking_fraction <= 0.9, "braking_fraction", self.braking_fraction, "[0.1, 0.9]")
        require(0.5 <= self.walking_mps <= 3.0, "walking_mps", self.walking_mps, "[0.5, 3]")
        require(0.02 <= self.fastest_mps <= 1.0, "fastest_mps", self.fastest_mps, "[0.02, 1]")
        require(0.01 <= self.creep_mps <= 0.1, "creep_mps", self.creep_mps, "[0.01, 0.1]")
        require(0.2 <= self.stale_after_s <= 1.0, "stale_after_s", self.stale_after_s, "[0.2, 1]")


def stopping_speed_mps(
    room_m: float, closing_mps: float, age_s: float, braking_mps2: float, reaction_s: float
) -> float:
    """Return the highest speed from which the robot stands within `room_m`, while what it meets comes closer.

    Solves v t + v^2 / (2 a) + w (t + v / a + age) = room for v: reaction time t, braking a, closing speed w since the reading.
    """
    b = reaction_s + closing_mps / braking_mps2
    c = room_m - closing_mps * (reaction_s + age_s)
    return 0.0 if c <= 0.0 else braking_mps2 * (sqrt(b * b + 2.0 * c / braking_mps2) - b)


def limit_by_clearance(
    nears: Iterable[Near],
    forward_mps: float,
    turn_radps: float,
    now_s: float,
    robot: RobotDescription,
    params: ReflexSafetyParams,
) -> tuple[float, float]:
    """Return how fast the robot may go the way of `forward_mps` (forward or back), and how much room it has there.

    Until it stands it may be displaced in any direction between its way now and half the turn it makes meanwhile (a
    chord of its arc): the room is the least over these directions. What stands still matters in the corridor that the robot
    sweeps; what may walk matters wherever it would meet the robot's front.
    """
    speed_mps = abs(forward_mps)
    braking_mps2 = params.braking_fraction * robot.max_acceleration_mps2
    half_turn_rad = 0.5 * turn_radps * (params.reaction_s + speed_mps / braking_mps2)
    half_turn_rad = max(-0.5 * pi, min(0.5 * pi, half_turn_rad))
    middle_rad = 0.5 * half_turn_rad + (0.0 if forward_mps >= 0.0 else pi)
    spread_rad = 0.5 * abs(half_turn_rad)
    half_width_m = robot.radius_m + params.margin_m
    limit_mps, clearance_m = inf, inf
    for distance_m, bearing_rad, half_cone_rad, heard_s, settled in nears:
        age_s = now_s - heard_s
        off_rad = off_course(bearing_rad, middle_rad) - spread_rad
        if age_s <= FRESH_S:
            off_rad -= half_cone_rad
        if settled or age_s > WALKER_HEARD_S:
            closing_mps, room_m = 0.0, free_travel_m(distance_m, max(0.0, off_rad), half_width_m)
        elif off_rad <= MEETING_RAD:
            closing_mps, room_m = params.walking_mps, distance_m - half_width_m
        else:
            continue
        if room_m == inf:
            continue
        clearance_m = min(clearance_m, max(0.0, room_m))
        may_mps = stopping_speed_mps(room_m, closing_mps, age_s, braking_mps2, params.reaction_s)
        limit_mps = min(limit_mps, may_mps)
    return limit_mps, clearance_m


def watched(
    direction_rad: float,
    sonars_s: dict[int, float],
    laser: LaserScan | None,
    robot: RobotDescription,
    oldest_s: float,
) -> bool:
    """Say whether a sensor heard from since `oldest_s` looks along a direction; `laser` is a scan as young as that."""
    for index, heard_s in sonars_s.items():
        fresh = heard_s >= oldest_s and index < len(robot.sonars)
        if fresh and off_course(robot.sonars[index].mount.heading_rad, direction_rad) <= WATCHED_RAD:
            return True
    if laser is None or laser.laser >= len(robot.lasers):
        return False
    sweep_rad = laser.angle_step_rad * (len(laser.ranges_m) - 1)
    middle_rad = robot.lasers[laser.laser].mount.heading_rad + laser.angle_min_rad + 0.5 * sweep_rad
    return len(laser.ranges_m) > 0 and off_course(middle_rad, direction_rad) <= 0.5 * abs(sweep_rad)


def leads_away(direction_rad: float, bearings_rad: Iterable[float]) -> bool:
    """Say whether a direction leads away from every contact."""
    return all(cos(bearing_rad - direction_rad) <= AWAY for bearing_rad in bearings_rad)


def standing(limited_by: Literal["no command", "stale readings"]) -> Drive:
    """Return the command to stand still."""
    return Drive(forward_mps=0.0, turn_radps=0.0, limited_by=limited_by)


def reflex_limit(
    wanted: Velocity | None,
    nears: Iterable[Near],
    touched_rad: Sequence[float],
    way_is_watched: bool,
    robot: RobotDescription,
    now_s: float,
    params: ReflexSafetyParams,
) -> Drive:
    """Return what may go to the wheels; `touched_rad` are the bumper's contacts, robot frame."""
    if wanted is None or now_s > wanted.valid_until_s:
        return standing("no command")
    turn_radps = max(-robot.max_turn_radps, min(robot.max_turn_radps, wanted.turn_radps))
    fastest_mps = min(params.fastest_mps, robot.max_speed_mps)
    forward_mps = max(-fastest_mps, min(fastest_mps, wanted.forward_mps))
    if forward_mps == 0.0:
        return Drive(forward_mps=0.0, turn_radps=turn_radps, limited_by="nothing")
    if touched_rad:
        if not leads_away(0.0 if forward_mps > 0 else pi, touched_rad):
            return Drive(forward_mps=0.0, turn_radps=turn_radps, limited_by="bumper")
        forward_mps = max(-params.creep_mps, min(params.creep_mps, forward_mps))
    if not way_is_watched:
        return Drive(forward_mps=0.0, turn_radps=turn_radps, limited_by="stale readings")
    limit_mps, clearance_m = limit_by_clearance(nears, forward_mps, turn_radps, now_s, robot, params)
    if limit_mps < abs(forward_mps):
        slow_mps = limit_mps if limit_mps >= SLOWEST_MPS else 0.0
        return Drive(
            forward_mps=copysign(slow_mps, forward_mps),
            turn_radps=turn_radps,
            limited_by="clearance",
            clearance_m=clearance_m,
        )
    limited_by: Literal["bumper", "nothing"] = "bumper" if touched_rad else "nothing"
    return Drive(
        forward_mps=forward_mps,
        turn_radps=turn_radps,
        limited_by=limited_by,
        clearance_m=clearance_m if clearance_m < inf else None,
    )


class ReflexSafety(SafetyLayer[ReflexSafetyParams]):
    """Lets through what cannot do harm."""

    Params = ReflexSafetyParams
    reads = READS

    def __init__(self, params: ReflexSafetyParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._memory = no_echoes()

    def limit(self, wanted: Velocity | None, board: Access) -> Drive:
        now_s = board.now_s
        oldest_s = now_s - self.params.stale_after_s
        self._memory = refresh(self._memory, board, MEMORY)
        robot, odometry, laser, bumper = (board.newest(kind) for kind in (ROBOT, ODOMETRY, LASER_SCAN, BUMPER))
        if robot is None or odometry is None or odometry.stamp_s < oldest_s:
            return standing("stale readings")
        scan = laser.value if laser is not None and laser.stamp_s >= oldest_s else None
        sonars_s = self._memory.sonars_s
        if scan is None and not any(heard_s >= oldest_s for heard_s in sonars_s.values()):
            return standing("stale readings")
        way_rad = pi if wanted is not None and wanted.forward_mps < 0 else 0.0
        way_is_watched = watched(way_rad, sonars_s, scan, robot.value, oldest_s)
        touched_rad = bumper.value.bearings_rad if bumper is not None else ()
        nears = around_now(self._memory, board, MEMORY.reach_m) if wanted is not None and wanted.forward_mps else []
        return reflex_limit(wanted, nears, touched_rad, way_is_watched, robot.value, now_s, self.params)
