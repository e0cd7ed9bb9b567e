"""Follows a wall on one side: the way nearest to the wall that keeps its distance.

Motivated by  side                                   "left" or "right"; unless given, that of the first wall met
Reads  motivations/motivation/<its name>             Motivation
       status/robot                                  RobotDescription
       observations/signal/odometry                  Odometry
       observations/signal/sonar_scan                SonarScan
       observations/signal/laser_scan                LaserScan
       observations/signal/bumper                    Bumper
       hypotheses/feature/map_from_odom              Pose   where there is one, else the odometry alone
       observations/feature/odom_from_robot          Pose

After Bou-Ghannam 1992, section 4.1 ("follow wall"). Each remembered echo forbids the ways that would bring the robot too near to it
within the next steps; of the others it takes the one furthest to the side of the wall. So it goes round inner corners, where
the wall ahead forbids the way on, and round outer ones, where the end of the wall lets it in. It is done when it comes back to
where it began to follow, having gone all around.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import copysign, cos, pi, sin

from behaviours.near_echoes import READS, Near, NearEchoesParams, around_now, no_echoes, refresh
from behaviours.ways_along import along_wall, first_side, mirrored, wall_beside
from behaviours.whereabouts import POSE_READS, map_from_robot
from blackboard.access import Access
from blackboard.component import Behaviour, Progress
from blackboard.errors import MissionError
from blackboard.kinds import ODOMETRY, ROBOT
from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.messages.motion import Response
from blackboard.parameters import require

MEMORY = NearEchoesParams(reach_m=1.6)
CURVE_RAD = pi / 9  # where the wall ends unseen it curves towards it, with a radius of about half a metre
AROUND_RAD = 1.5 * pi  # turned in all at least, when it has gone all around
LAP_M = 3.0  # and gone at least
SETTLED_M = 1.0  # from where a wall was met it takes so far until the robot goes along it: the lap begins there
STEP_S = 0.5  # time in which it was silenced does not count


@dataclass(frozen=True, slots=True, kw_only=True)
class WallFollowingParams:
    """How near it keeps to the wall, and when it has lost it or come round."""

    keep_m: float = 0.6  # between rim and wall: just more than where avoid-obstacles answers a wall
    side_m: float = 0.1  # room at least on the other side, and on both in narrow places
    look_m: float = 0.6  # the way must be clear for so far
    strength: float = 0.8
    find_m: float = 0.5  # a wall is followed when it is no further than this beyond keep_m
    curve_s: float = 10.0  # where the wall ends unseen: most of a circle
    seek_s: float = 60.0  # goes straight on to find a wall for so long: across a hall
    close_m: float = 0.5  # as near to where it began it has come round: about what poses err on a lap
    patience_s: float = 20.0  # on one spot, then it is blocked

    def __post_init__(self) -> None:
        require(0.05 <= self.keep_m <= 1.0, "keep_m", self.keep_m, "[0.05, 1]")
        require(0.02 <= self.side_m <= self.keep_m, "side_m", self.side_m, "[0.02, keep_m]")
        require(0.2 <= self.look_m <= 2.0, "look_m", self.look_m, "[0.2, 2]")
        require(0.2 <= self.strength <= 1.0, "strength", self.strength, "[0.2, 1]")
        require(0.1 <= self.find_m <= MEMORY.reach_m - self.keep_m, "find_m", self.find_m, "[0.1, 1.6 - keep_m]")
        for name in ("curve_s", "seek_s", "patience_s"):
            require(1.0 <= getattr(self, name) <= 3600.0, name, getattr(self, name), "[1, 3600]")
        require(0.1 <= self.close_m <= 5.0, "close_m", self.close_m, "[0.1, 5]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Lap:
    """What is kept from one answer to the next. Poses are map_from_robot."""

    side: int = 0  # 1 left, -1 right, 0 that of the first wall
    met: bool = False  # a wall, ever
    follows: bool = False
    began: Pose | None = None  # where the lap begins
    pose: Pose | None = None  # at the last answer
    asked_s: float | None = None
    gone_m: float = 0.0  # since it began
    turned_rad: float = 0.0
    without_s: float = 0.0  # without a wall
    spot: Pose | None = None  # where it was when it last got anywhere
    stood_s: float = 0.0  # there
    once_around: bool = False


def wall_following_response(
    lap: Lap, nears: Sequence[Near], pose: Pose, radius_m: float, now_s: float, params: WallFollowingParams
) -> tuple[Lap, Response | None]:
    """Return what is kept from now on and the response; `pose` is map_from_robot."""
    step_s = min(STEP_S, now_s - lap.asked_s) if lap.asked_s is not None else 0.0
    lap = _moved(lap, pose, step_s, now_s)
    within_m = radius_m + params.keep_m + params.find_m
    if not lap.side:
        lap = replace(lap, side=first_side(nears, within_m))
    nears = nears if lap.side >= 0 else mirrored(nears)
    wall = wall_beside(nears, within_m) if lap.side else None
    if wall is not None:
        if not lap.follows:
            lap = replace(lap, follows=True, began=None, gone_m=0.0)
        if lap.began is None and lap.gone_m >= SETTLED_M:
            lap = replace(lap, began=pose, gone_m=0.0, turned_rad=0.0)
        lap = replace(lap, without_s=0.0, met=True)
        if lap.began is not None and came_round(lap, lap.began, params):
            return replace(lap, once_around=True), None
        way_rad = along_wall(nears, wall, radius_m, params.keep_m, params.side_m, params.look_m)
    else:
        lap = replace(lap, without_s=lap.without_s + step_s)
        lap = replace(lap, follows=lap.follows and lap.without_s < params.curve_s)
        way_rad = CURVE_RAD if lap.follows else 0.0
    if way_rad is None:
        return lap, None
    way_rad = copysign(1.0, lap.side) * way_rad
    return lap, Response(forward=params.strength * cos(way_rad), left=params.strength * sin(way_rad))


def _moved(lap: Lap, pose: Pose, step_s: float, now_s: float) -> Lap:
    """Return the lap with the way to `pose` added."""
    gone_m = pose.distance_m(lap.pose) if lap.pose is not None else 0.0
    turned_rad = wrap_angle(pose.heading_rad - lap.pose.heading_rad) if lap.pose is not None else 0.0
    stands = lap.spot is not None and pose.distance_m(lap.spot) < 0.3
    return replace(
        lap,
        pose=pose,
        asked_s=now_s,
        gone_m=lap.gone_m + gone_m,
        turned_rad=lap.turned_rad + turned_rad,
        spot=lap.spot if stands else pose,
        stood_s=lap.stood_s + step_s if stands else 0.0,
    )


def came_round(lap: Lap, began: Pose, params: WallFollowingParams) -> bool:
    """Say whether it is back where it began, the same way round, after a whole turn."""
    if lap.pose is None or lap.gone_m < LAP_M or abs(lap.turned_rad) < AROUND_RAD:
        return False
    near = lap.pose.distance_m(began) <= params.close_m
    return near and abs(wrap_angle(lap.pose.heading_rad - began.heading_rad)) <= pi / 3


class WallFollowing(Behaviour[WallFollowingParams]):
    """Goes along a wall, once around."""

    Params = WallFollowingParams
    motivated = True
    parameters = ("side",)
    optional = 1
    reads = (*READS, *POSE_READS)

    def __init__(self, params: WallFollowingParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._memory = no_echoes()
        self._lap = Lap()

    def select(self, parameters: tuple[float | str, ...]) -> None:
        if len(parameters) > 1 or (parameters and parameters[0] not in ("left", "right")):
            raise MissionError(f"{self.name} takes 'left', 'right' or nothing; it was given {parameters!r}")
        self._lap = Lap(side=0 if not parameters else 1 if parameters[0] == "left" else -1)

    def respond(self, board: Access) -> Response | None:
        self._memory = refresh(self._memory, board, MEMORY)
        robot, odometry = board.newest(ROBOT), board.newest(ODOMETRY)
        if robot is None or odometry is None or self._lap.once_around:
            return None
        nears = around_now(self._memory, board, MEMORY.reach_m)
        pose, radius_m = map_from_robot(board) or odometry.value.pose, robot.value.radius_m
        self._lap, response = wall_following_response(self._lap, nears, pose, radius_m, board.now_s, self.params)
        return response

    def progress(self) -> Progress:
        lap, params = self._lap, self.params
        if lap.once_around:
            return Progress("reached", detail="has gone once around")
        if lap.stood_s >= params.patience_s:
            return Progress("blocked", detail=f"has stood for {params.patience_s:g} s")
        if lap.met and not lap.follows:
            return Progress("blocked", detail="has lost the wall")
        if lap.without_s >= params.seek_s:
            return Progress("blocked", detail="finds no wall")
        return Progress("underway", detail="" if lap.follows else "looks for a wall")

    def done(self) -> bool:
        return self._lap.once_around
