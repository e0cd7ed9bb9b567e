"""The way to where path-following goes, from where the robot is: planned when asked, kept while it is good, planned anew when not.

Triggered by  motivations/motivation/<behaviour>        Motivation: of path_following
              hypotheses/feature/grid                   GridTile: at most once in an interval
Reads         status/robot, observations/feature/odom_from_robot, hypotheses/feature/map_from_odom
Posts         hypotheses/feature/route                  Route

It is planned anew when something stands on it, when the robot has been pushed off it, and every now and then, to be taken if it
is clearly cheaper: a way that changed with every look would lead nowhere. Retracted when nobody asks.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.grid import OCCUPIED_MIN, Grid
from blackboard.kinds import GRID, MOTIVATION, ROBOT, ROUTE
from blackboard.messages.geometry import Point
from blackboard.messages.motion import Motivation
from blackboard.messages.routes import Route, WayPoint
from blackboard.parameters import require
from knowledge_sources.grid_mirror import GridMirror
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.room_to_move import Floats, Room
from knowledge_sources.ways import Place, Wavefront, Way, cost_of, nearest_on, wavefront, way_to, with_room
from knowledge_sources.ways_params import WaysParams

BODY_FRACTION = 0.8  # of the radius: what stands so near to the way is on it; the rest is blur, which comes and goes
WAY_STEP_M = 0.25  # between the points of a way, so that they say where it is narrow
STEP_M = 0.1  # between the places along a way that are looked at
NOBODY_ASKED = -1  # no motivation has this number


@dataclass(frozen=True, slots=True, kw_only=True)
class RoutesParams(WaysParams):
    """Whose ways, how often they are looked at, and when another is taken."""

    behaviour: str = "path_following"  # whose motivation asks
    interval_s: float = 1.0  # the grid is posted as often
    again_s: float = 5.0  # how often another way is sought while this one is free, and where there is none
    cheaper_fraction: float = 0.8  # another way must cost less than so much of what is left of this one
    strayed_m: float = 0.5  # so far off its way the robot gets a new one: more than avoiding a thing takes

    def __post_init__(self) -> None:
        WaysParams.__post_init__(self)
        require(0.0 <= self.interval_s <= 60.0, "interval_s", self.interval_s, "[0, 60] seconds")
        require(0.0 <= self.again_s <= 3600.0, "again_s", self.again_s, "[0, 3600] seconds")
        require(0.0 <= self.cheaper_fraction <= 1.0, "cheaper_fraction", self.cheaper_fraction, "[0, 1]")
        require(0.1 <= self.strayed_m <= 10.0, "strayed_m", self.strayed_m, "[0.1, 10] metres")


def stands_on(grid: Grid, corners: Floats, radius_m: float) -> bool:
    """Say whether the grid has something occupied where a robot's body passes on a way with these corners."""
    places = [corners[:1]]
    for a, b in pairwise(corners):
        count = max(1, round(float(np.hypot(*(b - a))) / STEP_M))
        places.append(a + np.linspace(0.0, 1.0, count + 1)[1:, None] * (b - a))
    reach_m = BODY_FRACTION * radius_m
    across = np.arange(-reach_m, reach_m + grid.cell_m, grid.cell_m)
    dx, dy = np.meshgrid(across, across)
    disc = np.stack([dx, dy], axis=-1)[np.hypot(dx, dy) <= reach_m]  # (n, 2)
    swept = (np.concatenate(places)[:, None] + disc).reshape(-1, 2)
    return bool((grid.values_at(swept) >= OCCUPIED_MIN).any())


class Routes(KnowledgeSource[RoutesParams]):
    """Keeps the way for path-following while its motivation is on."""

    Params = RoutesParams
    reads = (ROBOT, *READS)
    posts = (ROUTE,)
    rating = 30.0
    work = 5

    def __init__(self, params: RoutesParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self.triggers = (
            Trigger(kind=MOTIVATION, when=lambda entry: entry.id == params.behaviour),
            Trigger(kind=GRID, min_interval_s=params.interval_s, when=lambda _: self._asked is not None),
        )
        self._grid = GridMirror()
        self._asked: int | None = None  # the number of the motivation that is answered
        self._way: Way | None = None
        self._sought_s = 0.0

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        motivation = board.newest(MOTIVATION, self.params.behaviour)
        asks = motivation is not None and motivation.value.on
        if self._asked is None and (asks or board.newest(ROUTE) is not None):
            self._asked = NOBODY_ASKED  # so that the next tile brings the way up to date

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        motivation = board.newest(MOTIVATION, self.params.behaviour)
        goal = None if motivation is None else goal_of(motivation.value)
        if motivation is None or goal is None:
            if board.newest(ROUTE) is not None:
                board.retract(ROUTE)
            self._asked = self._way = None
            return
        robot, found = board.newest(ROBOT), map_from_robot_at(board, board.now_s)
        if robot is None or found is None:
            self._asked = NOBODY_ASKED if self._asked is None else self._asked  # the next tile asks again
            return
        pose, poses = found
        here = (pose.x_m, pose.y_m)
        anew = motivation.value.number != self._asked
        if not anew and board.now_s - self._sought_s < self.params.again_s and self._is_good(board, here):
            return
        grid = self._grid.look(board)
        known = None if grid is None else grid.known_part()
        front = None if known is None else wavefront(known, robot.value.radius_m, here, self.params)
        way = None if front is None else way_to(front, goal, self.params.goal_reach_m)
        self._sought_s, self._asked = board.now_s, motivation.value.number
        if anew or self._is_better(way, front, here):
            room = None if front is None else front.room
            self._post(board, goal, way, room, [motivation, robot, *poses])

    def _is_good(self, board: Access, here: Place) -> bool:
        """Say whether the way that stands may stay: nothing on it, and the robot near it. Where there is none, that stays too."""
        if self._way is None:
            return True
        strayed_m, ahead = nearest_on(self._way.corners, here)
        grid, robot = self._grid.look(board), board.newest(ROBOT)
        if grid is None or robot is None or strayed_m > self.params.strayed_m:
            return False
        return not stands_on(grid, ahead, robot.value.radius_m)

    def _is_better(self, way: Way | None, front: Wavefront | None, here: Place) -> bool:
        """Say whether a way takes the place of the one that stands."""
        if self._way is None or way is None or front is None:
            return self._way is not way
        strayed_m, ahead = nearest_on(self._way.corners, here)
        if strayed_m > self.params.strayed_m:
            return True
        return cost_of(front.room, way.corners) < self.params.cheaper_fraction * cost_of(front.room, ahead)

    def _post(self, board: Access, goal: Place, way: Way | None, room: Room | None, supports: list[Entry[Any]]) -> None:
        self._way = way
        place = Point(x_m=goal[0], y_m=goal[1])
        robot = board.newest(ROBOT)
        if way is None or room is None or robot is None:
            board.post(ROUTE, Route(goal=place, state="none"), supports=supports)
            return
        corners = way.corners
        tiles = self._grid.tiles_in(*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist())
        points = np.round(with_room(room, corners, robot.value.radius_m, WAY_STEP_M), 3).tolist()
        route = Route(
            goal=place,
            state="found",
            way=tuple(WayPoint(x_m=x, y_m=y, room_m=room_m) for x, y, room_m in points),
            length_m=way.length_m,
        )
        board.post(ROUTE, route, supports=[*supports, *tiles])


def goal_of(motivation: Motivation) -> Place | None:
    """Return where a motivation wants the robot to go; None where it is off or names no place."""
    if not motivation.on or len(motivation.parameters) < 2:
        return None
    x_m, y_m = motivation.parameters[:2]
    if isinstance(x_m, str) or isinstance(y_m, str):
        return None
    return float(x_m), float(y_m)
