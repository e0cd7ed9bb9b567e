"""How lines lie to each other: parallel pairs (the walls of a corridor) and collinear pairs (a wall with a door in it).

Triggered by  observations/feature/line or hypotheses/feature/model_line    Line, ModelLine: at most once in an interval
Posts         hypotheses/symbol/line_relation/<wall>-<wall>                 LineRelation
              hypotheses/symbol/verdict/line_relation.*                     Verdict

Source: Bou-Ghannam 1992, section 4.4: the object-indexed representation tells features by how they lie to each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import cos, hypot, radians, sin, tan
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.kinds import LINE_RELATION, VERDICT
from blackboard.messages.geometry import Point, wrap_angle
from blackboard.messages.model import ModelLine
from blackboard.messages.symbols import LineRelation
from blackboard.parameters import require
from blackboard.uncertainty.theories import Theory
from knowledge_sources.line_kinds import Lines, line_kind
from knowledge_sources.standing_hypotheses import Found, Reason, StandingHypotheses
from knowledge_sources.verdicts import Verdicts
from knowledge_sources.walls import Wall, WallLimits, Walls

SUPPORTS_A_LINE = 4
CHANGED_M = 0.05  # a smaller change is noise and no revision


@dataclass(frozen=True, slots=True, kw_only=True)
class LineRelationsParams:
    """Which lines, how often, and how alike two must run."""

    lines: Lines = "observed"  # "model" where match/merge keeps a model of lines
    interval_s: float = 10.0
    angle_rad: float = radians(4.0)  # walls of a building differ by less, and short lines are tilted by as much
    least_m: float = 0.5  # shorter lines say too little about their direction
    shared_m: float = 0.5  # of two parallel lines, side by side
    distance_m: float = 4.0  # between parallel lines: a wide corridor; all walls of a house are parallel somehow
    offset_m: float = 0.10  # between the carriers of collinear lines
    gap_m: float = 3.0  # between the ends of collinear lines: a double door
    theory: Theory = "endorsements"  # that weighs the reasons
    wall_limits: WallLimits = field(init=False)

    def __post_init__(self) -> None:
        require(0.0 <= self.interval_s <= 3600.0, "interval_s", self.interval_s, "[0, 3600] seconds")
        require(0.0 < self.angle_rad <= radians(30.0), "angle_rad", self.angle_rad, "(0, 30] degrees")
        for name in ("least_m", "shared_m", "distance_m", "offset_m", "gap_m"):
            require(0.0 <= getattr(self, name) <= 1000.0, name, getattr(self, name), "[0, 1000] metres")
        object.__setattr__(self, "wall_limits", WallLimits())


def relation(a: Wall, b: Wall, params: LineRelationsParams) -> LineRelation | None:
    """Return how two walls lie to each other; None where they are neither parallel nor collinear."""
    angle = abs(wrap_angle(2 * (a.theta_rad - b.theta_rad))) / 2
    if angle > params.angle_rad or 2 * min(a.half_length_m, b.half_length_m) < params.least_m:
        return None
    c, s = cos(a.theta_rad), sin(a.theta_rad)
    dx, dy = b.x_m - a.x_m, b.y_m - a.y_m
    along, half_b = dx * c + dy * s, b.half_length_m * cos(angle)
    low, high = max(-a.half_length_m, along - half_b), min(a.half_length_m, along + half_b)
    # Where they are measured: half way along what they share, or between their ends.
    middle = (low + high) / 2
    out = dy * c - dx * s + (middle - along) * tan(b.theta_rad - a.theta_rad)
    across = abs(out)
    place = Point(x_m=a.x_m + middle * c - out / 2 * s, y_m=a.y_m + middle * s + out / 2 * c)
    keys = (a.entries[0].key, b.entries[0].key)
    if params.offset_m < across <= params.distance_m and high - low >= params.shared_m:
        return LineRelation(
            relation="parallel", place=place, angle_rad=angle, distance_m=across, shared_m=high - low, lines=keys
        )
    if across <= params.offset_m and 0.0 < low - high <= params.gap_m:
        return LineRelation(
            relation="collinear", place=place, angle_rad=angle, distance_m=across, gap_m=low - high, lines=keys
        )
    return None


def relations(walls: Sequence[Wall], params: LineRelationsParams) -> dict[str, tuple[LineRelation, Wall, Wall]]:
    """Return the relations of all pairs, by id."""
    if len(walls) < 2:
        return {}
    theta = np.array([w.theta_rad for w in walls])
    alike = np.abs(np.sin(theta[:, None] - theta[None, :])) <= sin(params.angle_rad) + 1e-9  # leaves few of all pairs
    found = {}
    for i, j in np.argwhere(np.triu(alike, 1)):
        a, b = walls[i], walls[j]
        value = relation(a, b, params)
        if value is not None:
            found[f"{a.number}-{b.number}"] = (value, a, b)
    return found


def differs(a: LineRelation, b: LineRelation) -> bool:
    """Say whether a relation has changed by more than noise."""
    return a.relation != b.relation or any(
        change > CHANGED_M
        for change in (
            abs(a.distance_m - b.distance_m),
            abs(a.shared_m - b.shared_m),
            abs(a.gap_m - b.gap_m),
            hypot(a.place.x_m - b.place.x_m, a.place.y_m - b.place.y_m),
        )
    )


def seen_so(a: Wall, b: Wall) -> Reason:
    """Return what speaks for a relation of two walls: strong where each was seen more than once; one line may be an error."""
    often = min(_times_seen(a), _times_seen(b)) > 1
    why = "either was seen more than once" if often else "one of them was seen only once"
    return Reason(why, "lines", strength="strong" if often else "fair")


def _times_seen(wall: Wall) -> int:
    return sum(e.value.observations if isinstance(e.value, ModelLine) else 1 for e in wall.entries)


class LineRelations(KnowledgeSource[LineRelationsParams]):
    """Keeps a hypothesis for each pair of walls that run alike."""

    Params = LineRelationsParams
    posts = (LINE_RELATION, VERDICT)
    rating = 2.0
    work = 5

    def __init__(self, params: LineRelationsParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._kind = line_kind(params.lines)
        self.triggers = (Trigger(kind=self._kind, min_interval_s=params.interval_s),)
        self._walls = Walls(params.wall_limits)
        self._standing = StandingHypotheses(LINE_RELATION, differs, Verdicts(params.theory))

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        self._standing.resume(board)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        self._look(board)

    def finish(self, board: Access) -> None:
        self._look(board)

    def _look(self, board: Access) -> None:
        found = relations(self._walls.update(board.entries(self._kind)), self.params)
        kept = {
            id_: Found(value, [*a.entries[:SUPPORTS_A_LINE], *b.entries[:SUPPORTS_A_LINE]], [seen_so(a, b)])
            for id_, (value, a, b) in found.items()
        }
        self._standing.keep(board, kept, lambda _: "its lines run so no more, or are pieces of other walls now")
