"""Targets at the ends of lines: what lies where a wall stops being known? Ends near each other are one target.

Triggered by  observations/feature/line or hypotheses/feature/model_line    Line, ModelLine: at most once in an interval
Reads         hypotheses/feature/grid, status/robot                         GridTile, RobotDescription
Posts         hypotheses/symbol/target/line_end-<n>                         Target
              hypotheses/symbol/verdict/target.*                            Verdict

Source: Bou-Ghannam 1992, section 6.1: "curious" locations at the end points of the lines, those in close vicinity regarded as one.
Here an end is curious only while something is unknown around it, unless `only_where_unknown` is false.
"""

from collections.abc import Sequence
from dataclasses import dataclass
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
from knowledge_sources.frontier_targets import differs
from knowledge_sources.frontiers import frontier_mask, merged, place_to_stand, unknown_near
from knowledge_sources.grid_mirror import GridMirror
from knowledge_sources.line_kinds import Lines, line_kind
from knowledge_sources.standing_hypotheses import Found, Names, Reason, StandingHypotheses
from knowledge_sources.verdicts import Verdicts
from knowledge_sources.walls import Wall, WallLimits, Walls

SUPPORTS_AN_END = 2
WALL_M = 0.2  # the end lies in the band of its own wall, some four cells wide
WHY = "lines end there"
WHY_UNKNOWN = "lines end there, and empty cells around border on unknown ones"
GONE = "no line ends there where the robot could come near"
GONE_KNOWN = "no line ends there with anything unknown around it"


@dataclass(frozen=True, slots=True, kw_only=True)
class LineEndTargetsParams:
    """Which lines, how often, and which of their ends are worth a visit."""

    lines: Lines = "observed"  # "model" where match/merge keeps a model of lines
    interval_s: float = 5.0
    merge_radii: float = 2.0  # of the robot: ends nearer to each other are seen from one place
    reach_radii: float = 3.0  # from the end to where the robot could stand; it cannot stand at the wall itself
    least_m: float = 0.5  # shorter walls have no certain ends
    only_where_unknown: bool = True  # false: every end, as in the thesis
    unknown_reach_m: float = 0.5  # a frontier within that makes an end curious
    unknown_least_m: float = 0.45  # and so long must it be: a sonar leaves some 0.35 m undecided in any corner
    depth_cells: int = 3  # of unknown cells behind that frontier, as in `frontier_targets`
    theory: Theory = "endorsements"  # that weighs the reasons
    same_m: float = 0.5  # a target that moves by less is the same

    def __post_init__(self) -> None:
        require(0.0 <= self.interval_s <= 3600.0, "interval_s", self.interval_s, "[0, 3600] seconds")
        for name in ("merge_radii", "reach_radii"):
            require(0.0 <= getattr(self, name) <= 100.0, name, getattr(self, name), "[0, 100]")
        for name in ("least_m", "unknown_reach_m", "unknown_least_m", "same_m"):
            require(0.0 <= getattr(self, name) <= 100.0, name, getattr(self, name), "[0, 100] metres")
        require(1 <= self.depth_cells <= 50, "depth_cells", self.depth_cells, "[1, 50]")


def line_end_targets(
    walls: Sequence[Wall], grid: Grid, radius_m: float, params: LineEndTargetsParams
) -> list[tuple[Target, list[Wall]]]:
    """Return a target for each place where walls end and a robot of this radius could come near, with those walls."""
    of_end = {end: wall for wall in walls if 2 * wall.half_length_m >= params.least_m for end in wall.ends}
    mask = frontier_mask(grid.cells, params.depth_cells)
    found = []
    for group in merged(of_end, params.merge_radii * radius_m):
        x_m, y_m = sum(p[0] for p in group) / len(group), sum(p[1] for p in group) / len(group)
        unknown_m = max(unknown_near(mask, grid, x, y, params.unknown_reach_m) for x, y in group)
        if params.only_where_unknown and unknown_m < params.unknown_least_m:
            continue
        reach_m = (1.0 + params.reach_radii) * radius_m
        stand = place_to_stand(grid, x_m, y_m, radius_m, reach_m, wall_m=WALL_M)
        if stand is not None:
            target = Target(
                place=Point(x_m=x_m, y_m=y_m),
                stand=Point(x_m=stand.x_m, y_m=stand.y_m),
                reason="line end",
                size_m=unknown_m,
            )
            found.append((target, [of_end[end] for end in group]))
    return found


class LineEndTargets(KnowledgeSource[LineEndTargetsParams]):
    """Keeps a target for each place where lines end that is worth a visit."""

    Params = LineEndTargetsParams
    reads = (GRID, ROBOT)
    posts = (TARGET, VERDICT)
    rating = 3.0
    work = 5

    def __init__(self, params: LineEndTargetsParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._kind = line_kind(params.lines)
        self.triggers = (
            Trigger(kind=self._kind, min_interval_s=params.interval_s),
            Trigger(kind=GRID, min_interval_s=2 * params.interval_s),  # what was unknown may have become known
        )
        self._walls = Walls(WallLimits())
        self._grid = GridMirror()
        self._names = Names("line_end", params.same_m)
        self._standing = StandingHypotheses(TARGET, differs, Verdicts(params.theory))

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        places = {str(t.id): (t.value.place.x_m, t.value.place.y_m) for t in self._standing.resume(board)}
        self._names.resume(places, board.last_number(TARGET, "line_end-"))

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        self._look(board)

    def finish(self, board: Access) -> None:
        self._look(board)

    def _look(self, board: Access) -> None:
        robot, grid = board.newest(ROBOT), self._grid.look(board)
        if robot is None or grid is None:
            return
        walls = self._walls.update(board.entries(self._kind))
        targets = line_end_targets(walls, grid, robot.value.radius_m, self.params)
        names = self._names.name([(t.place.x_m, t.place.y_m) for t, _ in targets])
        unknown = self.params.only_where_unknown
        why, gone = (WHY_UNKNOWN, GONE_KNOWN) if unknown else (WHY, GONE)
        found = {
            name: Found(
                target,
                [line for wall in ended for line in wall.entries[:SUPPORTS_AN_END]],
                [Reason(why, strength="strong")],
            )
            for name, (target, ended) in zip(names, targets, strict=True)
        }
        self._standing.keep(board, found, lambda _: gone)
