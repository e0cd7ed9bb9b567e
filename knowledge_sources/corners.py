"""Corner hypotheses: where two lines meet or nearly meet.

Triggered by  observations/feature/line or hypotheses/feature/model_line    Line, ModelLine: at most once in an interval
Reads         hypotheses/feature/grid                                       GridTile: on which side there is room
Posts         hypotheses/symbol/corner/<wall>-<wall>                        Corner
              hypotheses/symbol/verdict/corner.*                            Verdict

A corner stands as long as its lines meet there and the grid shows no way through between them; else it is endorsed against and
retracted. Source: Bou-Ghannam 1992, sections 4.1 (the corner detector, and that corners indoors are the intersection of two walls)
and 5.2.4.
"""

from dataclasses import dataclass, field
from math import hypot, pi
from typing import Any

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.kinds import CORNER, GRID, VERDICT
from blackboard.messages.geometry import Point, wrap_angle
from blackboard.messages.symbols import Corner
from blackboard.parameters import require
from blackboard.uncertainty.theories import Theory
from knowledge_sources.corner_search import CornerLimits, Meeting, corners, sigmas
from knowledge_sources.grid_mirror import GridMirror
from knowledge_sources.line_kinds import Lines, line_kind
from knowledge_sources.standing_hypotheses import Found, Reason, StandingHypotheses
from knowledge_sources.verdicts import Verdicts
from knowledge_sources.walls import WallLimits, Walls

SUPPORTS_AN_ARM = 8  # the longest lines of a wall: more say the same again
MOVED_M = 0.02  # a smaller change is noise and no revision
LOOKED_AT_M = 0.4  # around a corner, in the grid


@dataclass(frozen=True, slots=True, kw_only=True)
class CornersParams:
    """Which lines, how often, and what counts as a corner (see `CornerLimits`) and as one wall (see `WallLimits`)."""

    lines: Lines = "observed"  # "model" where match/merge keeps a model of lines
    interval_s: float = 5.0  # a batch of 500 points takes a ring of twelve sonars about that long
    gap_m: float = CornerLimits().gap_m
    overrun_m: float = CornerLimits().overrun_m
    opening_rad: float = CornerLimits().opening_rad
    arm_m: float = CornerLimits().arm_m
    apart_m: float = CornerLimits().apart_m
    wall_angle_rad: float = WallLimits().angle_rad
    wall_offset_m: float = WallLimits().offset_m
    wall_gap_m: float = WallLimits().gap_m
    theory: Theory = "endorsements"  # that weighs the reasons
    limits: CornerLimits = field(init=False)
    wall_limits: WallLimits = field(init=False)

    def __post_init__(self) -> None:
        require(0.0 <= self.interval_s <= 3600.0, "interval_s", self.interval_s, "[0, 3600] seconds")
        limits = CornerLimits(
            gap_m=self.gap_m,
            overrun_m=self.overrun_m,
            opening_rad=self.opening_rad,
            arm_m=self.arm_m,
            apart_m=self.apart_m,
        )
        walls = WallLimits(angle_rad=self.wall_angle_rad, offset_m=self.wall_offset_m, gap_m=self.wall_gap_m)
        object.__setattr__(self, "limits", limits)
        object.__setattr__(self, "wall_limits", walls)


def as_corner(meeting: Meeting) -> Corner:
    """Return the message."""
    sigma_x, sigma_y, correlation = sigmas(meeting.covariance)
    return Corner(
        place=Point(x_m=meeting.x_m, y_m=meeting.y_m),
        sigma_x_m=sigma_x,
        sigma_y_m=sigma_y,
        correlation=correlation,
        opening_rad=meeting.opening_rad,
        bisector_rad=meeting.bisector_rad,
        shape=meeting.shape,
        gap_m=meeting.gap_m,
        lines=(meeting.first.entries[0].key, meeting.second.entries[0].key),
    )


def _gone(corner: Corner) -> str:
    return "its lines meet there no more, are pieces of other walls now, or the grid is empty where they should meet"


def differs(a: Corner, b: Corner) -> bool:
    """Say whether a corner has changed by more than noise."""
    return (
        a.shape != b.shape
        or hypot(a.place.x_m - b.place.x_m, a.place.y_m - b.place.y_m) > MOVED_M
        or abs(wrap_angle(a.bisector_rad - b.bisector_rad)) > pi / 36
        or abs(a.gap_m - b.gap_m) > MOVED_M
    )


class Corners(KnowledgeSource[CornersParams]):
    """Keeps a hypothesis for each place where two walls meet."""

    Params = CornersParams
    posts = (CORNER, VERDICT)
    rating = 4.0
    work = 5

    def __init__(self, params: CornersParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._kind = line_kind(params.lines)
        self.triggers = (Trigger(kind=self._kind, min_interval_s=params.interval_s),)
        self.reads = (GRID,)
        self._walls = Walls(params.wall_limits)
        self._grid = GridMirror()
        self._standing = StandingHypotheses(CORNER, differs, Verdicts(params.theory))

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        self._standing.resume(board)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        self._look(board)

    def finish(self, board: Access) -> None:
        self._look(board)

    def _look(self, board: Access) -> None:
        grid = self._grid.look(board)
        found = corners(self._walls.update(board.entries(self._kind)), grid, self.params.limits)
        self._standing.keep(board, {m.name: self._found(m) for m in found}, _gone)

    def _found(self, meeting: Meeting) -> Found[Corner]:
        why = {
            "concave": "between its lines the grid is empty",
            "convex": "around its lines the grid is empty",
            "unknown": "",
        }[meeting.shape]
        x, y, reach = meeting.x_m, meeting.y_m, LOOKED_AT_M
        tiles = self._grid.tiles_in(x - reach, y - reach, x + reach, y + reach) if why else []
        lines = [*meeting.first.entries[:SUPPORTS_AN_ARM], *meeting.second.entries[:SUPPORTS_AN_ARM]]
        reasons = [Reason("its lines meet there, or nearly", "lines")]
        if why:
            reasons.append(Reason(why, "room"))
        return Found(as_corner(meeting), [*lines, *tiles], reasons)
