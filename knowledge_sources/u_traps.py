"""Trap detector: U-shapes on the map, in which a robot that heads for something behind them stays.

Triggered by  observations/feature/line or hypotheses/feature/model_line    Line, ModelLine: at most once in an interval
Reads         hypotheses/feature/grid, status/robot                         GridTile, RobotDescription
Posts         hypotheses/symbol/trap/u-<wall>-<wall>-<wall>                 Trap: base and arms

A U is a base with an arm at either end, both on one side, with empty space between them and at the mouth, and deep enough to hold
the robot. Source: Bou-Ghannam 1992, sections 3.4 (trap situations, U-shaped configurations) and 6.3 (a priori knowledge of trap
shapes applied to the map).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, pi, radians, sin
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, Grid
from blackboard.kinds import GRID, ROBOT, TRAP
from blackboard.messages.geometry import Point, wrap_angle
from blackboard.messages.symbols import Trap
from blackboard.parameters import require
from knowledge_sources.corner_search import CornerLimits, Meeting, meetings
from knowledge_sources.grid_mirror import GridMirror
from knowledge_sources.line_kinds import Lines, line_kind
from knowledge_sources.standing_hypotheses import Found, Reason, StandingHypotheses
from knowledge_sources.walls import Wall, WallLimits, Walls

SUPPORTS_A_WALL = 4
LOOKS = 7  # rows and columns of cells looked at inside
MOVED_M = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class UTrapsParams:
    """Which lines, how often, and what counts as a U."""

    lines: Lines = "observed"  # "model" where match/merge keeps a model of lines
    interval_s: float = 10.0
    narrowest_radii: float = 2.0  # of the robot: into a narrower one it does not get
    widest_m: float = 4.0  # a wider one it sees out of: its sonars reach 3 m at useful certainty
    depth_radii: float = 2.0  # a shallower one does not hold it
    lean_rad: float = radians(35.0)  # of an arm from the square to the base
    empty_fraction: float = 0.6  # of the cells inside: something else may stand there
    open_fraction: float = 0.6  # of the mouth that is known to be empty
    gap_m: float = 0.4  # between base and arm: narrower than the robot

    def __post_init__(self) -> None:
        require(0.0 <= self.interval_s <= 3600.0, "interval_s", self.interval_s, "[0, 3600] seconds")
        require(0.0 < self.lean_rad < pi / 2, "lean_rad", self.lean_rad, "(0, pi/2), less than 90 degrees")
        for name in ("narrowest_radii", "depth_radii", "widest_m", "gap_m"):
            require(0.0 <= getattr(self, name) <= 100.0, name, getattr(self, name), "[0, 100]")
        for name in ("empty_fraction", "open_fraction"):
            require(0.0 <= getattr(self, name) <= 1.0, name, getattr(self, name), "[0, 1]")


@dataclass(frozen=True, slots=True, kw_only=True)
class UShape:
    """A base and its arms; the inside reaches `depth_m` from the base, in the direction of the mouth."""

    base: Wall
    arms: tuple[Wall, Wall]
    corners: tuple[tuple[float, float], tuple[float, float]]
    mouth_rad: float
    depth_m: float

    @property
    def width_m(self) -> float:
        (ax, ay), (bx, by) = self.corners
        return hypot(bx - ax, by - ay)

    @property
    def name(self) -> str:
        first, second = sorted(arm.number for arm in self.arms)
        return f"u-{self.base.number}-{first}-{second}"

    @property
    def middle(self) -> tuple[float, float]:
        (ax, ay), (bx, by) = self.corners
        half = self.depth_m / 2
        return (ax + bx) / 2 + half * cos(self.mouth_rad), (ay + by) / 2 + half * sin(self.mouth_rad)

    def inside(self) -> "np.ndarray[Any, np.dtype[np.float64]]":
        """Return places (LOOKS + 1, LOOKS, 2) between the arms: a row across each depth, the last one at the mouth."""
        a, b = np.array(self.corners)
        across = (np.arange(LOOKS) + 0.5) / LOOKS
        deep = np.append((np.arange(LOOKS) + 0.5) / LOOKS, 1.0) * self.depth_m
        out = np.array([cos(self.mouth_rad), sin(self.mouth_rad)])
        return np.asarray(a + across[None, :, None] * (b - a) + deep[:, None, None] * out)

    def holds(self, x_m: float, y_m: float) -> bool:
        """Say whether a place lies between base and mouth, and between the arms."""
        (ax, ay), (bx, by) = self.corners
        width = self.width_m
        across = ((x_m - ax) * (bx - ax) + (y_m - ay) * (by - ay)) / width
        deep = (x_m - ax) * cos(self.mouth_rad) + (y_m - ay) * sin(self.mouth_rad)
        return 0.0 < across < width and 0.0 < deep < self.depth_m


def u_shapes(walls: Sequence[Wall], grid: Grid, radius_m: float, params: UTrapsParams) -> list[UShape]:
    """Return the U-shapes that these walls make on the grid."""
    limits = CornerLimits(gap_m=params.gap_m, overrun_m=params.gap_m, opening_rad=pi / 2 - params.lean_rad)
    at_base: dict[int, list[tuple[Meeting, Wall, float]]] = {}
    for meeting in meetings(walls, limits):
        if abs(meeting.opening_rad - pi / 2) <= params.lean_rad:
            at_base.setdefault(meeting.first.number, []).append((meeting, meeting.second, meeting.arms_rad[1]))
            at_base.setdefault(meeting.second.number, []).append((meeting, meeting.first, meeting.arms_rad[0]))
    found = []
    for base in walls:
        arms = at_base.get(base.number, [])
        for i, one in enumerate(arms):
            for other in arms[i + 1 :]:
                shape = _shape(base, one, other)
                if shape is not None and _is_trap(shape, grid, radius_m, params):
                    found.append(shape)
    kept: list[UShape] = []
    for shape in sorted(found, key=lambda u: (u.width_m, u.name)):  # of both faces of its walls, the inner ones
        if not any(other.holds(*shape.middle) and shape.holds(*other.middle) for other in kept):
            kept.append(shape)
    return kept


def _shape(base: Wall, one: tuple[Meeting, Wall, float], other: tuple[Meeting, Wall, float]) -> UShape | None:
    (m1, arm1, away1), (m2, arm2, away2) = one, other
    along = (m2.x_m - m1.x_m) * cos(base.theta_rad) + (m2.y_m - m1.y_m) * sin(base.theta_rad)
    left = [sin(away - base.theta_rad) > 0 for away in (away1, away2)]
    if arm1.number == arm2.number or left[0] != left[1] or abs(along) < 1e-6:
        return None
    mouth = wrap_angle(base.theta_rad + (pi / 2 if left[0] else -pi / 2))
    c, s = cos(mouth), sin(mouth)
    depths = [max((x - m.x_m) * c + (y - m.y_m) * s for x, y in arm.ends) for m, arm in ((m1, arm1), (m2, arm2))]
    return UShape(
        base=base,
        arms=(arm1, arm2),
        corners=((m1.x_m, m1.y_m), (m2.x_m, m2.y_m)),
        mouth_rad=mouth,
        depth_m=min(depths),
    )


def _is_trap(shape: UShape, grid: Grid, radius_m: float, params: UTrapsParams) -> bool:
    if not params.narrowest_radii * radius_m <= shape.width_m <= params.widest_m:
        return False
    if shape.depth_m < params.depth_radii * radius_m:
        return False
    places = shape.inside()
    values = grid.values_at(places.reshape(-1, 2)).reshape(places.shape[:2])
    inside, mouth = values[:-1] <= EMPTY_MAX, values[-1]
    open_ = (mouth <= EMPTY_MAX).mean() >= params.open_fraction and not (mouth[1:-1] >= OCCUPIED_MIN).any()
    return bool(inside.mean() >= params.empty_fraction and open_)


def as_trap(shape: UShape) -> Trap:
    """Return the message; its place is the middle of the inside."""
    x_m, y_m = shape.middle
    mouth_deg = round(shape.mouth_rad * 180 / pi)
    return Trap(
        trap="u-shape",
        place=Point(x_m=x_m, y_m=y_m),
        size_m=shape.width_m,
        detail=f"{shape.width_m:.1f} m wide, {shape.depth_m:.1f} m deep, open towards {mouth_deg} degrees",
    )


def differs(a: Trap, b: Trap) -> bool:
    """Say whether a trap has changed by more than noise."""
    moved_m = hypot(a.place.x_m - b.place.x_m, a.place.y_m - b.place.y_m)
    return moved_m > MOVED_M or abs(a.size_m - b.size_m) > MOVED_M


class UTraps(KnowledgeSource[UTrapsParams]):
    """Keeps a hypothesis for each U-shape on the map."""

    Params = UTrapsParams
    reads = (GRID, ROBOT)
    posts = (TRAP,)
    rating = 3.0
    work = 5

    def __init__(self, params: UTrapsParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._kind = line_kind(params.lines)
        self.triggers = (Trigger(kind=self._kind, min_interval_s=params.interval_s),)
        self._walls = Walls(WallLimits())
        self._grid = GridMirror()
        self._standing = StandingHypotheses(TRAP, differs)

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        self._standing.resume(board)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        self._look(board)

    def finish(self, board: Access) -> None:
        self._look(board)

    def _look(self, board: Access) -> None:
        robot, grid = board.newest(ROBOT), self._grid.look(board)
        if robot is None or grid is None:
            return
        walls = self._walls.update(board.entries(self._kind))
        shapes = u_shapes(walls, grid, robot.value.radius_m, self.params)
        why = "a base with two arms on one side, empty between them and at the mouth"
        found = {
            shape.name: Found(
                as_trap(shape),
                [line for wall in (shape.base, *shape.arms) for line in wall.entries[:SUPPORTS_A_WALL]],
                [Reason(why)],
            )
            for shape in shapes
        }
        self._standing.keep(board, found, lambda _: "its walls make no open U any more")
