"""What the robot should be seeing now: the lines of the model, and those in question, that are in view (model-driven).

Triggered by  observations/feature/odom_from_robot     Pose: once the robot has moved, at most once in an interval
Reads         hypotheses/feature/model_line, hypotheses/symbol/new_area_visited, hypotheses/feature/map_from_odom
Posts         hypotheses/feature/expected_lines        ExpectedLines

Source: Bou-Ghannam 1992, section 5.2, the expected local scene; what counts as in view is in `lines_in_view`.
"""

from dataclasses import dataclass, field
from typing import Any

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.kinds import EXPECTED_LINES, MODEL_LINE, NEW_AREA_VISITED, ODOM_FROM_ROBOT
from blackboard.messages.geometry import Pose
from blackboard.messages.model import ExpectedLines
from blackboard.parameters import require
from knowledge_sources.line_estimates import from_model_line
from knowledge_sources.lines_in_view import ViewLimits, lines_in_view
from knowledge_sources.poses import READS, map_from_robot_at, moved_on


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedLinesParams:
    """How often the view is looked at, and what counts as in view (see `ViewLimits`)."""

    interval_s: float = 1.0
    step_m: float = 0.2  # from nearly the same place nearly the same is in view
    turn_rad: float = 0.5  # a ring of sonars sees the same whichever way it turns, but for the gaps between its cones
    range_m: float = ViewLimits().range_m
    incidence_rad: float = ViewLimits().incidence_rad
    least_m: float = ViewLimits().least_m
    limits: ViewLimits = field(init=False)

    def __post_init__(self) -> None:
        for name in ("interval_s", "step_m", "turn_rad"):
            require(getattr(self, name) >= 0.0, name, getattr(self, name), "0 and more")
        limits = ViewLimits(range_m=self.range_m, incidence_rad=self.incidence_rad, least_m=self.least_m)
        object.__setattr__(self, "limits", limits)


class ExpectedLinesSource(KnowledgeSource[ExpectedLinesParams]):
    """Posts what should be in view, again each time that the robot has moved."""

    Params = ExpectedLinesParams
    reads = (MODEL_LINE, NEW_AREA_VISITED, *READS)
    posts = (EXPECTED_LINES,)
    rating = 5.0

    def __init__(self, params: ExpectedLinesParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._looked_from: Pose | None = None  # odometry frame
        moved = Trigger(kind=ODOM_FROM_ROBOT, min_interval_s=params.interval_s, when=self._has_moved)
        self.triggers = (moved,)

    def activate(self, trigger: Entry[Pose], board: Access) -> None:
        self._looked_from = trigger.value
        found = map_from_robot_at(board, trigger.stamp_s)
        if found is None:
            return
        pose, supports = found
        reach = self.params.range_m
        area = (pose.x_m - reach, pose.y_m - reach, pose.x_m + reach, pose.y_m + reach)
        model, new = board.entries(MODEL_LINE, area=area), board.entries(NEW_AREA_VISITED, area=area)
        walls = [from_model_line(entry.value) for entry in model]
        doubtful = [from_model_line(entry.value.line) for entry in new]
        seen = [model[i] for i in lines_in_view(walls, pose.x_m, pose.y_m, self.params.limits)]
        seen_new = [new[i] for i in lines_in_view(doubtful, pose.x_m, pose.y_m, self.params.limits, walls)]
        value = ExpectedLines(model=_ids(seen), new_areas=_ids(seen_new))
        board.post(EXPECTED_LINES, value, supports=[*supports, *seen, *seen_new], stamp_s=trigger.stamp_s)

    def _has_moved(self, entry: Entry[Pose]) -> bool:
        return moved_on(self._looked_from, entry.value, self.params.step_m, self.params.turn_rad)


def _ids(entries: list[Entry[Any]]) -> tuple[str, ...]:
    return tuple(str(entry.id) for entry in entries)
