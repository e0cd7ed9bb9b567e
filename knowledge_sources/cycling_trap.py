"""Trap detector: the robot comes to the same places again and again, and the grid shows nothing new.

Triggered by  observations/feature/odom_from_robot    Pose: at most once in an interval
Reads         hypotheses/feature/grid, hypotheses/feature/map_from_odom, status/robot
Posts         hypotheses/symbol/trap/cycling-<n>      Trap

Source: Bou-Ghannam 1992, section 4.1: "the robot gets stuck in a cyclic pattern giving no new information to the map builder".
"""

from collections import deque
from dataclasses import dataclass
from itertools import pairwise
from math import floor, hypot, inf
from typing import NamedTuple

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN
from blackboard.kinds import GRID, ODOM_FROM_ROBOT, ROBOT, TRAP
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.symbols import Trap
from blackboard.parameters import require
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.standing_hypotheses import Episodes, Found, Reason

Place = tuple[int, int]
WHY = "the same places again, and the grid shows nothing new"


@dataclass(frozen=True, slots=True, kw_only=True)
class CyclingTrapParams:
    """How long the robot may go on without learning anything."""

    interval_s: float = 1.0
    window_s: float = 90.0  # looked back upon: a room of 5 x 8 m takes a robot of 0.3 m/s some 80 s to go round
    driven_m: float = 8.0  # in the window: who goes less cycles not, but stands
    place_radii: float = 2.0  # of the robot: the side of what counts as one place
    again_fraction: float = 0.9  # of the window's places, already visited before the window or several times in it
    learnt_m2: float = 0.3  # cells decided in the window: less is flicker at the edges

    def __post_init__(self) -> None:
        require(0.0 < self.interval_s <= 3600.0, "interval_s", self.interval_s, "(0, 3600] seconds")
        require(self.interval_s < self.window_s <= 36_000.0, "window_s", self.window_s, "interval_s to 36000 seconds")
        require(0.1 <= self.place_radii <= 100.0, "place_radii", self.place_radii, "[0.1, 100]")
        require(0.0 <= self.again_fraction <= 1.0, "again_fraction", self.again_fraction, "[0, 1]")
        require(0.0 <= self.driven_m <= 1e5, "driven_m", self.driven_m, "[0, 1e5] metres")
        require(0.0 <= self.learnt_m2 <= 1e6, "learnt_m2", self.learnt_m2, "[0, 1e6] square metres")


class Look(NamedTuple):
    """Where the robot was, and how much of the grid was decided then."""

    stamp_s: float
    x_m: float
    y_m: float
    decided_m2: float


class Wayfarer:
    """Remembers the window's looks and how often each place was entered.

    A place is entered again only by one who has driven two places' width since leaving it: a way along the border between two
    places enters each of them once.
    """

    def __init__(self, params: CyclingTrapParams, place_m: float) -> None:
        self._params = params
        self._place_m = place_m
        self._looks: deque[Look] = deque()
        self._entered: dict[Place, int] = {}
        self._left_m: dict[Place, float] = {}  # the way driven when it was last left
        self._driven_m = 0.0

    def note(self, look: Look) -> Trap | None:
        """Take one look; return the trap if the robot cycles."""
        if self._looks:
            self._driven_m += hypot(look.x_m - self._looks[-1].x_m, look.y_m - self._looks[-1].y_m)
        self._looks.append(look)
        place = self._place(look)
        if self._driven_m - self._left_m.get(place, -inf) >= 2 * self._place_m:
            self._entered[place] = self._entered.get(place, 0) + 1
        self._left_m[place] = self._driven_m
        while look.stamp_s - self._looks[0].stamp_s > self._params.window_s:
            self._looks.popleft()
        return self._trap()

    def _place(self, look: Look) -> Place:
        return floor(look.x_m / self._place_m), floor(look.y_m / self._place_m)

    def _trap(self) -> Trap | None:
        params, looks = self._params, self._looks
        if looks[-1].stamp_s - looks[0].stamp_s < params.window_s - 2 * params.interval_s:
            return None
        learnt = looks[-1].decided_m2 - looks[0].decided_m2
        steps = pairwise(looks)
        driven = sum(hypot(b.x_m - a.x_m, b.y_m - a.y_m) for a, b in steps)
        places = dict.fromkeys(self._place(look) for look in looks)
        again = sum(self._entered[place] > 1 for place in places) / len(places)
        if learnt > params.learnt_m2 or driven < params.driven_m or again < params.again_fraction:
            return None
        xs, ys = [look.x_m for look in looks], [look.y_m for look in looks]
        return Trap(
            trap="cycling",
            place=Point(x_m=sum(xs) / len(xs), y_m=sum(ys) / len(ys)),
            size_m=hypot(max(xs) - min(xs), max(ys) - min(ys)),
            detail=f"in {params.window_s:g} s {driven:.0f} m driven, {again:.0%} of {len(places)} places visited before, "
            f"{max(learnt, 0.0):.1f} m2 of the map new",
        )


class CyclingTrap(KnowledgeSource[CyclingTrapParams]):
    """Keeps a hypothesis as long as the robot cycles without new information."""

    Params = CyclingTrapParams
    reads = (GRID, ROBOT, *READS)
    posts = (TRAP,)
    rating = 3.0

    def __init__(self, params: CyclingTrapParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self.triggers = (Trigger(kind=ODOM_FROM_ROBOT, min_interval_s=params.interval_s),)
        self._wayfarer: Wayfarer | None = None
        self._decided: dict[str, tuple[int, float]] = {}  # by tile: revision, square metres decided
        self._episodes = Episodes(TRAP, "cycling")

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        self._episodes.resume(board)

    def activate(self, trigger: Entry[Pose], board: Access) -> None:
        robot, found = board.newest(ROBOT), map_from_robot_at(board, trigger.stamp_s)
        if robot is None or found is None:
            return
        if self._wayfarer is None:
            self._wayfarer = Wayfarer(self.params, self.params.place_radii * robot.value.radius_m)
        pose, supports = found
        trap = self._wayfarer.note(Look(trigger.stamp_s, pose.x_m, pose.y_m, self._decided_m2(board)))
        kept = None if trap is None else Found(trap, supports, [Reason(WHY)])
        self._episodes.keep(board, kept, "the robot came to new places, or the map grew")

    def _decided_m2(self, board: Access) -> float:
        for entry in board.entries(GRID):
            if self._decided.get(entry.key, (-inf, 0.0))[0] != entry.revision:
                cells = entry.value.cells.unpack()
                decided = int(((cells <= EMPTY_MAX) | (cells >= OCCUPIED_MIN)).sum())
                self._decided[entry.key] = (entry.revision, decided * entry.value.cell_m**2)
        return sum(area for _, area in self._decided.values())
