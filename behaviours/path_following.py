"""Follows the route to a place: a vector towards a point of the way a little ahead of the robot.

Motivated by  x_m, y_m                               the goal, map frame
Reads  motivations/motivation/<its name>             Motivation
       hypotheses/feature/route                      Route
       hypotheses/feature/map_from_odom              Pose
       observations/feature/odom_from_robot          Pose

Bou-Ghannam 1992, section 4.2 (path-following). The vector is no longer than target-nav's, so that avoid-obstacles outweighs it near
an obstacle; where somebody stands in the way the robot waits, and after a while it is blocked. Whether to wait on, go
elsewhere or give up is for rules to say.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan2, cos, hypot, sin

from behaviours.asked import numbers
from behaviours.target_nav import LONGEST_STEP_S, SHORTEST, Approach, approached
from behaviours.whereabouts import POSE_READS, map_from_robot
from blackboard.access import Access
from blackboard.component import Behaviour, Progress
from blackboard.entry import Entry
from blackboard.kinds import ROUTE
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Response, Switch
from blackboard.messages.routes import Route, WayPoint
from blackboard.parameters import require

SAME_GOAL_M = 1e-6
NO_WAY = "no way there is known"
NO_ROUTE = "nobody says a way"

Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Left:
    """What of a way is left: its point nearest to the robot and the points after it, and the room from each to the next."""

    places: tuple[Place, ...]
    room_m: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class PathFollowingParams:
    """How strongly it goes along the way, how closely, and when it has arrived or is blocked."""

    amplitude: float = 0.8  # of full speed: avoid-obstacles answers one echo at its balance distance with 1
    ahead_m: float = 0.4  # to the point that it goes for: cuts corners by less than a third of that
    slow_m: float = 0.5  # within this of the end the vector gets shorter
    reached_m: float = 0.3  # about the robot's own radius: nearer, it fights over centimetres with what stands there
    narrow_m: float = 0.3  # where things lie so near to the rim, avoid-obstacles may let nobody through
    narrow_ahead_m: float = 0.6  # begins so far before a narrow place: from there its sides push back
    narrow_gain: float = 0.1  # of avoid-obstacles there: it still keeps to the middle, and the safety layer keeps off
    avoid: str = "avoid_obstacles"  # whose gain that is; "" for nobody's
    nearer_m: float = 0.25  # so much less of the way left than ever before is progress
    patience_s: float = 20.0  # without progress or without a way for so long it is blocked: longer than people pass by

    def __post_init__(self) -> None:
        require(0.4 <= self.amplitude < 1.0, "amplitude", self.amplitude, "[0.4, 1)")
        require(0.1 <= self.ahead_m <= 5.0, "ahead_m", self.ahead_m, "[0.1, 5]")
        require(0.01 <= self.slow_m <= 10.0, "slow_m", self.slow_m, "[0.01, 10]")
        require(0.02 <= self.reached_m <= 5.0, "reached_m", self.reached_m, "[0.02, 5]")
        require(0.0 <= self.narrow_m <= 2.0, "narrow_m", self.narrow_m, "[0, 2]")
        require(0.0 <= self.narrow_ahead_m <= 5.0, "narrow_ahead_m", self.narrow_ahead_m, "[0, 5]")
        require(0.0 <= self.narrow_gain <= 1.0, "narrow_gain", self.narrow_gain, "[0, 1]")
        require(0.05 <= self.nearer_m <= 10.0, "nearer_m", self.nearer_m, "[0.05, 10]")
        require(1.0 <= self.patience_s <= 3600.0, "patience_s", self.patience_s, "[1, 3600]")


def left_of_way(way: tuple[WayPoint, ...], place: Place) -> Left:
    """Return what of a way is left from the point of it that lies nearest to a place."""
    best_m2 = float("inf")
    best: Place = (way[-1].x_m, way[-1].y_m)
    after = len(way)
    for i, (a, b) in enumerate(pairwise(way)):
        dx, dy = b.x_m - a.x_m, b.y_m - a.y_m
        square = dx * dx + dy * dy
        along = ((place[0] - a.x_m) * dx + (place[1] - a.y_m) * dy) / square if square > 0.0 else 0.0
        along = max(0.0, min(1.0, along))
        x, y = a.x_m + along * dx, a.y_m + along * dy
        away_m2 = (x - place[0]) ** 2 + (y - place[1]) ** 2
        if away_m2 <= best_m2:  # of two that are as near the later one: ways do not lead back
            best_m2, best, after = away_m2, (x, y), i + 1
    rest = way[after:]
    return Left((best, *((p.x_m, p.y_m) for p in rest)), tuple(p.room_m for p in way[after - 1 :]))


def point_ahead(left: tuple[Place, ...], ahead_m: float) -> Place:
    """Return the point of a way that lies `ahead_m` along it, or its end."""
    for (ax, ay), (bx, by) in pairwise(left):
        step_m = hypot(bx - ax, by - ay)
        if step_m >= ahead_m > 0.0:
            share = ahead_m / step_m
            return ax + share * (bx - ax), ay + share * (by - ay)
        ahead_m -= step_m
    return left[-1]


def length_m(left: tuple[Place, ...]) -> float:
    """Return how long a way is."""
    return sum(hypot(bx - ax, by - ay) for (ax, ay), (bx, by) in pairwise(left))


def along(pose: Pose, ahead: Place, remaining_m: float, params: PathFollowingParams) -> Response:
    """Return the vector from `pose` (map_from_robot) towards a point of the way, shorter near the way's end."""
    length = params.amplitude * max(SHORTEST, min(1.0, remaining_m / params.slow_m))
    bearing_rad = atan2(ahead[1] - pose.y_m, ahead[0] - pose.x_m) - pose.heading_rad
    return Response(forward=length * cos(bearing_rad), left=length * sin(bearing_rad))


def waited(approach: Approach, now_s: float) -> Approach:
    """Return the approach after waiting for a way until now."""
    step_s = 0.0 if approach.asked_s is None else min(now_s - approach.asked_s, LONGEST_STEP_S)
    return replace(approach, asked_s=now_s, waited_s=approach.waited_s + step_s, remaining_m=None)


def least_room_m(left: Left, ahead_m: float) -> float:
    """Return the least room on the next `ahead_m` of a way."""
    least_m, gone_m = left.room_m[0], 0.0
    for (a, b), room_m in zip(pairwise(left.places), left.room_m, strict=False):
        if gone_m > ahead_m:
            break
        least_m = min(least_m, room_m)
        gone_m += hypot(b[0] - a[0], b[1] - a[1])
    return least_m


class PathFollowing(Behaviour[PathFollowingParams]):
    """Goes along the route that the board holds for its goal."""

    Params = PathFollowingParams
    motivated = True
    parameters = ("x_m", "y_m")
    reads = (ROUTE, *POSE_READS)

    def __init__(self, params: PathFollowingParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._goal: Place | None = None
        self._approach = Approach()
        self._followed: Route | None = None
        self._detail = ""
        self._narrow = False

    def select(self, parameters: tuple[float | str, ...]) -> None:
        self._goal = None
        x_m, y_m = numbers(self.name, self.parameters, parameters)
        self._goal, self._approach, self._followed, self._detail = (x_m, y_m), Approach(), None, NO_ROUTE

    def respond(self, board: Access) -> Response | None:
        pose = map_from_robot(board)
        if pose is None or self._goal is None:
            return None
        params, now_s = self.params, board.now_s
        route = self._route(board.newest(ROUTE), self._goal)
        if route is None or not route.way:
            self._detail = NO_ROUTE if route is None else NO_WAY
            self._approach = waited(self._approach, now_s)
            return None
        left = left_of_way(route.way, (pose.x_m, pose.y_m))
        foot = left.places[0]
        remaining_m = hypot(foot[0] - pose.x_m, foot[1] - pose.y_m) + length_m(left.places)
        self._narrow = least_room_m(left, params.narrow_ahead_m) < params.narrow_m
        if route is not self._followed:
            self._followed = route  # another way may be longer: what was left of the last one is no measure
            self._approach = replace(self._approach, nearest_m=max(self._approach.nearest_m, remaining_m))
        self._detail = f"came no further for {params.patience_s:g} s"
        self._approach = approached(self._approach, remaining_m, now_s, params.reached_m, params.nearer_m)
        if self._approach.reached:
            return None
        return along(pose, point_ahead(left.places, params.ahead_m), remaining_m, params)

    def adjusts(self) -> Mapping[str, Switch]:
        return {self.params.avoid: Switch(gain=self.params.narrow_gain)} if self._narrow and self.params.avoid else {}

    def progress(self) -> Progress:
        if self._goal is None:
            return Progress()
        progress = self._approach.progress(self.params.patience_s)
        return replace(progress, detail=self._detail) if progress.outcome == "blocked" else progress

    def done(self) -> bool:
        return self._approach.reached

    @staticmethod
    def _route(entry: Entry[Route] | None, goal: Place) -> Route | None:
        """Return the route on the board if it leads to this goal; another's is an old one."""
        if entry is None:
            return None
        there = entry.value.goal
        return entry.value if hypot(there.x_m - goal[0], there.y_m - goal[1]) <= SAME_GOAL_M else None
