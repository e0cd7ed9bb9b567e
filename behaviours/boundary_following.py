"""Wanders along the boundaries of a room: straight on while the way is clear, else the clear way nearest to forward.

Reads  status/robot                     RobotDescription
       observations/signal/odometry     Odometry
       observations/signal/sonar_scan   SonarScan
       observations/signal/laser_scan   LaserScan
       observations/signal/bumper       Bumper

Bou-Ghannam 1992, section 4.2.3. The threshold of each sonar follows from a corridor along the way: ahead it is the length of
the corridor, to the side what keeps its half width. A way once chosen is held, in the odometry frame, until the robot looks
along it. Where a boundary to the side recedes, the robot leans towards it, so that it goes along instead of rebounding. It
answers while a boundary is near, and is silent in the open, where no way is clear, and for a while when it has long gone
along boundaries: random-wander leads on from there, to other boundaries.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, inf, pi, sin

from behaviours.corridor import clear_way_m
from behaviours.near_echoes import READS, Near, NearEchoesParams, around_now, no_echoes, refresh
from blackboard.access import Access
from blackboard.component import Behaviour
from blackboard.kinds import ODOMETRY, ROBOT
from blackboard.messages.geometry import wrap_angle
from blackboard.messages.motion import Response
from blackboard.parameters import require

MEMORY = NearEchoesParams(reach_m=1.6)


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundaryFollowingParams:
    """When a boundary counts as near, and what counts as clear."""

    notice_m: float = 1.5  # answers while something is this near to the rim; must lie within the memory's reach
    front_m: float = 0.5  # goes on while so much is clear ahead: room to stop and to turn away
    choose_m: float = 0.8  # a new way must be clear for so far; more than front_m, so that it does not dither
    side_m: float = 0.1  # room kept to either side: passes doors of 0.8 m
    keep_m: float = 0.4  # leans towards the boundary while further from it than this: sonars see it face on, and well
    lean_rad: float = pi / 18  # by 10 degrees: approaches slower than it goes along
    step_rad: float = pi / 18  # the ways looked at lie 10 degrees apart
    aligned_rad: float = pi / 36  # a chosen way is reached within 5 degrees
    follow_s: float = 90.0  # goes along boundaries for so long: once around a large room
    rest_s: float = 8.0  # then is silent for so long: random-wander crosses the room

    def __post_init__(self) -> None:
        require(0.1 <= self.notice_m <= MEMORY.reach_m, "notice_m", self.notice_m, f"[0.1, {MEMORY.reach_m}]")
        require(0.1 <= self.front_m <= self.choose_m, "front_m", self.front_m, "[0.1, choose_m]")
        require(self.choose_m <= self.notice_m, "choose_m", self.choose_m, "[front_m, notice_m]")
        require(0.0 <= self.side_m <= self.keep_m, "side_m", self.side_m, "[0, keep_m]")
        require(self.keep_m <= self.notice_m, "keep_m", self.keep_m, "[side_m, notice_m]")
        require(0.0 <= self.lean_rad <= pi / 6, "lean_rad", self.lean_rad, "[0, pi/6]")
        require(pi / 180 <= self.step_rad <= pi / 4, "step_rad", self.step_rad, "[pi/180, pi/4]")
        require(0.0 < self.aligned_rad <= pi / 6, "aligned_rad", self.aligned_rad, "(0, pi/6]")
        require(1.0 <= self.follow_s <= 1e6, "follow_s", self.follow_s, "[1, 1e6]")
        require(0.0 <= self.rest_s <= 1e6, "rest_s", self.rest_s, "[0, 1e6]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """What is kept from one answer to the next."""

    way_rad: float | None = None  # the way held, odometry frame
    side: int = 0  # where the boundary is: 1 left, -1 right, 0 not known
    following: bool = False
    tired_s: float = inf  # when it will have gone along boundaries for long enough


LET_GO = 1.06  # a boundary is lost at this multiple of notice_m
BESIDE_RAD = (pi / 12, pi - pi / 6)  # a boundary to one side lies between these bearings


def boundary_side(nears: Sequence[Near], notice_m: float, held: int) -> int:
    """Return the side on which a boundary is followed: the side held while there is one, else that of the nearest echo."""
    nearest = {1: inf, -1: inf}
    for distance_m, bearing_rad, _, _, _ in nears:
        if distance_m <= notice_m and BESIDE_RAD[0] <= abs(bearing_rad) <= BESIDE_RAD[1]:
            side = 1 if bearing_rad > 0 else -1
            nearest[side] = min(nearest[side], distance_m)
    if held and nearest[held] < inf:
        return held
    if nearest[1] == nearest[-1]:
        return 0
    return 1 if nearest[1] < nearest[-1] else -1


def clear_way(nears: Sequence[Near], side: int, radius_m: float, params: BoundaryFollowingParams) -> float | None:
    """Return the clear way nearest to forward, robot frame; of two as near the one on `side`, else the longer one."""
    half_width_m = radius_m + params.side_m
    for needed_m in (params.choose_m, params.front_m):
        for step in range(1, int(pi / params.step_rad) + 1):
            found = []
            for sign in (side, -side) if side else (1, -1):
                way_rad = sign * step * params.step_rad
                clear_m = clear_way_m(nears, way_rad, half_width_m, params.notice_m)
                if clear_m >= needed_m:
                    found.append((clear_m, way_rad))
            if found:
                return found[0][1] if side else max(found, key=lambda f: f[0])[1]
    return None


def boundary_following_response(
    course: Course,
    nears: Sequence[Near],
    heading_rad: float,
    radius_m: float,
    now_s: float,
    params: BoundaryFollowingParams,
) -> tuple[Course, Response | None]:
    """Return the course kept from now on and the response; `heading_rad` is the robot's own, odometry frame."""
    tired_s = min(course.tired_s, now_s + params.follow_s)
    if now_s >= tired_s + params.rest_s:
        tired_s = now_s + params.follow_s
    notice_m = radius_m + params.notice_m * (LET_GO if course.following else 1.0)
    if now_s >= tired_s or not any(near[0] <= notice_m for near in nears):
        return Course(tired_s=tired_s), None
    side = boundary_side(nears, notice_m, course.side)
    held_rad = wrap_angle(course.way_rad - heading_rad) if course.way_rad is not None else 0.0
    way_rad = held_rad if abs(held_rad) > params.aligned_rad else 0.0
    course = Course(side=side, following=True, tired_s=tired_s)
    if clear_way_m(nears, way_rad, radius_m + params.side_m, params.notice_m) < params.front_m:
        chosen = clear_way(nears, (1 if way_rad > 0 else -1) if way_rad else 0, radius_m, params)
        if chosen is None:
            return course, None
        way_rad = chosen
        course = replace(course, side=-1 if chosen > 0 else 1)
    if way_rad:
        course = replace(course, way_rad=wrap_angle(heading_rad + way_rad))
    elif (
        side
        and clear_way_m(nears, side * params.lean_rad, radius_m + params.keep_m, params.notice_m) >= params.choose_m
    ):
        way_rad = side * params.lean_rad
    return course, Response(forward=cos(way_rad), left=sin(way_rad))


class BoundaryFollowing(Behaviour[BoundaryFollowingParams]):
    """Goes along what bounds the free floor."""

    Params = BoundaryFollowingParams
    reads = READS

    def __init__(self, params: BoundaryFollowingParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._memory = no_echoes()
        self._course = Course()
        self._answer: tuple[Response, float] | None = None  # the newest answer and the heading that it was given at

    def select(self, parameters: tuple[float | str, ...]) -> None:
        self._course, self._answer = Course(), None

    def respond(self, board: Access) -> Response | None:
        before, self._memory = self._memory, refresh(self._memory, board, MEMORY)
        robot, odometry = board.newest(ROBOT), board.newest(ODOMETRY)
        if robot is None or odometry is None:
            return None
        heading_rad = odometry.value.pose.heading_rad
        if self._memory is before and self._answer is not None:
            return turned(self._answer[0], self._answer[1] - heading_rad)
        nears = around_now(self._memory, board, LET_GO * self.params.notice_m)
        self._course, response = boundary_following_response(
            self._course, nears, heading_rad, robot.value.radius_m, board.now_s, self.params
        )
        self._answer = (response, heading_rad) if response is not None else None
        return response


def turned(response: Response, angle_rad: float) -> Response:
    """Return the response with its vector turned, counter-clockwise."""
    c, s = cos(angle_rad), sin(angle_rad)
    return Response(forward=c * response.forward - s * response.left, left=s * response.forward + c * response.left)
