"""Targets at the centres of sizable frontiers between empty and unknown space.

Triggered by  hypotheses/feature/grid                  GridTile: at most once in an interval
Reads         status/robot                             RobotDescription, for its radius
              observations/feature/odom_from_robot, hypotheses/feature/map_from_odom
Posts         hypotheses/symbol/target/frontier-<n>    Target
              hypotheses/symbol/verdict/target.*       Verdict

Only what a robot of its size could come near in known empty space, and not what it covers itself. Source: Bou-Ghannam 1992,
sections 4.1 and 6.1: "the center of a sizable boundary between empty and unknown space in the EOU representation".
"""

from dataclasses import dataclass
from math import hypot
from typing import Any

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.grid import Grid
from blackboard.kinds import GRID, ROBOT, TARGET, VERDICT
from blackboard.messages.geometry import Point
from blackboard.messages.symbols import Target
from blackboard.parameters import require
from blackboard.uncertainty.theories import Theory
from knowledge_sources.frontiers import (
    BESIDE_M,
    could_be_reached,
    frontier_mask,
    frontiers,
    open_place_near,
    within_reach,
)
from knowledge_sources.grid_mirror import GridMirror
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.room_to_move import Room, room_to_move
from knowledge_sources.standing_hypotheses import Found, Names, Reason, StandingHypotheses
from knowledge_sources.verdicts import Verdicts
from knowledge_sources.ways_params import WaysParams

WHY = Reason("empty cells border on unknown ones over more than the robot is wide", strength="strong")
WAYS = WaysParams()  # where a robot may be is the same for all
MOVED_M = 0.1
GREW_FRACTION = 0.25
LOOKED_AT_M = 0.5  # the tiles around a frontier's centre support its target


@dataclass(frozen=True, slots=True, kw_only=True)
class FrontierTargetsParams:
    """How often the grid is looked at, and which frontiers are worth a visit."""

    interval_s: float = 5.0
    least_radii: float = 1.0  # of the robot, long; whether it could go through is asked of the whole map
    least_m2: float = 0.1  # of new places for the robot's centre behind it, were all that is unknown empty
    reach_radii: float = 0.5  # from the robot's rim to the frontier: what it cannot come near it cannot cover either
    depth_cells: int = 3  # of unknown cells behind the frontier: thinner strips are a wall's blurred front
    theory: Theory = "endorsements"  # that weighs the reasons
    same_m: float = (
        0.5  # a frontier whose centre has moved by more since it was first seen is another: the robot has shifted it
    )

    def __post_init__(self) -> None:
        require(0.0 <= self.interval_s <= 3600.0, "interval_s", self.interval_s, "[0, 3600] seconds")
        for name in ("least_radii", "reach_radii"):
            require(0.0 <= getattr(self, name) <= 100.0, name, getattr(self, name), "[0, 100]")
        require(0.0 <= self.least_m2 <= 1000.0, "least_m2", self.least_m2, "[0, 1000] square metres")
        require(1 <= self.depth_cells <= 50, "depth_cells", self.depth_cells, "[1, 50]")
        require(0.0 <= self.same_m <= 10.0, "same_m", self.same_m, "[0, 10] metres")


def frontier_targets(grid: Grid, room: Room, radius_m: float, params: FrontierTargetsParams) -> list[Target]:
    """Return a target for each sizable frontier that a robot of this radius could come near."""
    found = []
    reach_m = (1.0 + params.reach_radii) * radius_m
    mask = frontier_mask(room.cells, params.depth_cells)
    fresh = could_be_reached(room, radius_m, params.least_m2)
    mask = within_reach(within_reach(mask, room.open, reach_m, room.cell_m), fresh, BESIDE_M, room.cell_m)
    for frontier in frontiers(mask, room, params.least_radii * radius_m):
        stand = open_place_near(grid, room, frontier.x_m, frontier.y_m, reach_m)
        if stand is not None:
            found.append(
                Target(
                    place=Point(x_m=frontier.x_m, y_m=frontier.y_m),
                    stand=Point(x_m=stand.x_m, y_m=stand.y_m),
                    reason="frontier",
                    size_m=frontier.length_m,
                )
            )
    return found


def differs(a: Target, b: Target) -> bool:
    """Say whether a target has changed by more than the grid's own flicker."""
    moved_m = hypot(a.place.x_m - b.place.x_m, a.place.y_m - b.place.y_m)
    return moved_m > MOVED_M or abs(a.size_m - b.size_m) > GREW_FRACTION * max(a.size_m, b.size_m)


class FrontierTargets(KnowledgeSource[FrontierTargetsParams]):
    """Keeps a target for each frontier that is worth a visit."""

    Params = FrontierTargetsParams
    reads = (ROBOT, *READS)
    posts = (TARGET, VERDICT)
    rating = 3.0
    work = 5

    def __init__(self, params: FrontierTargetsParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self.triggers = (Trigger(kind=GRID, min_interval_s=params.interval_s),)
        self._grid = GridMirror()
        self._names = Names("frontier", params.same_m, anchored=True)
        self._standing = StandingHypotheses(TARGET, differs, Verdicts(params.theory))

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        places = {str(t.id): (t.value.place.x_m, t.value.place.y_m) for t in self._standing.resume(board)}
        self._names.resume(places, board.last_number(TARGET, "frontier-"))

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        self._look(board)

    def finish(self, board: Access) -> None:
        self._look(board)

    def _look(self, board: Access) -> None:
        robot, grid = board.newest(ROBOT), self._grid.look(board)
        known, found = None if grid is None else grid.known_part(), map_from_robot_at(board, board.now_s)
        if robot is None or grid is None or known is None:
            return
        here = None if found is None else (found[0].x_m, found[0].y_m)
        room = room_to_move(known, robot.value.radius_m, here, WAYS)
        targets = frontier_targets(grid, room, robot.value.radius_m, self.params)
        names = self._names.name([(t.place.x_m, t.place.y_m) for t in targets])
        now = {name: Found(target, self._tiles(target), [WHY]) for name, target in zip(names, targets, strict=True)}
        self._standing.keep(board, now, lambda _: "no sizable frontier is left there that the robot could come near")

    def _tiles(self, target: Target) -> list[Entry[Any]]:
        x, y, reach = target.place.x_m, target.place.y_m, LOOKED_AT_M
        return [*self._grid.tiles_in(x - reach, y - reach, x + reach, y + reach)]
