"""How far it is to each target from where the robot is, over floor that is known to be empty; or that no way leads there.

Triggered by  hypotheses/symbol/target/*                Target
              hypotheses/feature/grid                   GridTile: at most once in an interval
Reads         status/robot, observations/feature/odom_from_robot, hypotheses/feature/map_from_odom
Posts         hypotheses/feature/travel/<target>        Travel

One wavefront serves all targets. Where a target's own place to stand cannot be reached, another from which it could be looked at is
sought near it. A length is posted anew when it has changed noticeably, so that nobody is woken for nothing.
"""

from dataclasses import dataclass
from math import hypot, inf
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.grid import Grid
from blackboard.kinds import GRID, ROBOT, TARGET, TRAVEL
from blackboard.messages.geometry import Point
from blackboard.messages.routes import Travel
from blackboard.messages.symbols import Target
from blackboard.parameters import require
from knowledge_sources.frontiers import in_sight
from knowledge_sources.grid_mirror import GridMirror
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.ways import Place, Wavefront, wavefront
from knowledge_sources.ways_params import WaysParams

WALL_M = 0.2  # a target may lie in the band of its own wall, some four cells wide
SAME_STAND_M = 0.1
MOST_LOOKS = 20  # places near a target that are asked whether it can be seen from there


@dataclass(frozen=True, slots=True, kw_only=True)
class TravelParams(WaysParams):
    """How often ways are measured, from how far off a target may be looked at, and what change is news."""

    check_s: float = 1.0  # how often it is looked whether there is something to measure
    interval_s: float = 5.0  # between two measurements for a robot that moves; new targets do not wait so long
    moved_m: float = 1.0  # a robot that has moved by less measures again only because the map may have changed
    map_s: float = 10.0  # and that so often
    look_radii: float = 3.0  # beyond the rim: from so far off a frontier is well within a sonar's range
    change_m: float = 0.5  # a length that changes by less is no news
    change_fraction: float = 0.2  # nor one that changes by less than so much of it

    def __post_init__(self) -> None:
        WaysParams.__post_init__(self)
        for name in ("check_s", "interval_s", "map_s"):
            require(0.0 <= getattr(self, name) <= 3600.0, name, getattr(self, name), "[0, 3600] seconds")
        require(0.0 <= self.moved_m <= 100.0, "moved_m", self.moved_m, "[0, 100] metres")
        require(0.0 <= self.look_radii <= 100.0, "look_radii", self.look_radii, "[0, 100]")
        require(0.0 <= self.change_m <= 100.0, "change_m", self.change_m, "[0, 100] metres")
        require(0.0 <= self.change_fraction <= 1.0, "change_fraction", self.change_fraction, "[0, 1]")


def travel_to(target: Target, front: Wavefront, grid: Grid, radius_m: float, params: TravelParams) -> Travel:
    """Return how far it is to where a target can be looked at: to its own place to stand, or else to one near the target."""
    places = front.places()
    reachable = np.isfinite(front.cost)
    stand = (target.stand.x_m, target.stand.y_m)
    own = np.where(reachable, np.hypot(*(places - stand).T), inf)
    if len(own) and own.min() <= front.room.cell_m * 3:  # blocks' cells lie so far apart
        return Travel(state="reachable", stand=target.stand, length_m=float(front.length_m[int(own.argmin())]))
    place = (target.place.x_m, target.place.y_m)
    near = np.where(reachable, np.hypot(*(places - place).T), inf)
    for node in np.argsort(near, kind="stable")[:MOST_LOOKS].tolist():
        away_m = float(near[node])
        if away_m > (1.0 + params.look_radii) * radius_m:
            break
        eye: Place = (float(places[node, 0]), float(places[node, 1]))
        if in_sight(grid, eye, place, away_m - WALL_M):
            point = Point(x_m=round(eye[0], 3), y_m=round(eye[1], 3))
            return Travel(state="reachable", stand=point, length_m=float(front.length_m[node]))
    return Travel(state="unreachable", stand=target.stand)


def is_news(told: Travel, now: Travel, params: TravelParams) -> bool:
    """Say whether a travel has changed noticeably."""
    if told.state != now.state:
        return True
    if hypot(told.stand.x_m - now.stand.x_m, told.stand.y_m - now.stand.y_m) > SAME_STAND_M:
        return True
    return abs(told.length_m - now.length_m) > max(params.change_m, params.change_fraction * told.length_m)


class TravelToTargets(KnowledgeSource[TravelParams]):
    """Keeps the travel to every target that stands."""

    Params = TravelParams
    reads = (ROBOT, *READS)
    posts = (TRAVEL,)
    rating = 2.0  # after the sources of targets
    work = 5

    def __init__(self, params: TravelParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self.triggers = (
            Trigger(kind=TARGET, min_interval_s=params.check_s),
            Trigger(kind=GRID, min_interval_s=params.check_s),
        )
        self._grid = GridMirror()
        self._measured: dict[str, Target] = {}  # by id, as of the last measurement
        self._measured_s = -inf
        self._measured_at: Place = (inf, inf)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        targets = {str(entry.id): entry for entry in board.entries(TARGET)}
        for told in board.entries(TRAVEL):
            if told.id not in targets:
                board.retract(TRAVEL, told.id)
                self._measured.pop(str(told.id), None)
        robot, found = board.newest(ROBOT), map_from_robot_at(board, board.now_s)
        if not targets or robot is None or found is None:
            return
        here = (found[0].x_m, found[0].y_m)
        if not self._is_due(board.now_s, here, targets):
            return
        grid = self._grid.look(board)
        known = None if grid is None else grid.known_part()
        if grid is None or known is None:
            return
        front = wavefront(known, robot.value.radius_m, here, self.params)
        self._measured = {name: entry.value for name, entry in targets.items()}
        self._measured_s, self._measured_at = board.now_s, here
        for name, entry in targets.items():
            travel = travel_to(entry.value, front, grid, robot.value.radius_m, self.params)
            standing = board.newest(TRAVEL, name)
            if standing is None or is_news(standing.value, travel, self.params):
                board.post(TRAVEL, travel, id=name, supports=[entry, robot, *found[1]])

    def _is_due(self, now_s: float, here: Place, targets: dict[str, Entry[Target]]) -> bool:
        """Say whether a target is new, or, after a while, one has changed, the robot has gone on or the map may have changed."""
        if not targets.keys() <= self._measured.keys():
            return True
        since_s = now_s - self._measured_s
        if since_s >= self.params.interval_s and any(e.value != self._measured[name] for name, e in targets.items()):
            return True
        moved_m = hypot(here[0] - self._measured_at[0], here[1] - self._measured_at[1])
        return since_s >= self.params.map_s or (since_s >= self.params.interval_s and moved_m >= self.params.moved_m)
