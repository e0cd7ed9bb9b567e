"""The 2-D line finder: lines in each batch of points that the grid bears out.

Triggered by  observations/feature/supported_points  PointSet
Reads         status/robot                           RobotDescription, for its diameter
Posts         observations/feature/line/<batch>-<n>  Line, <batch> being the revision of the points

Source: Bou-Ghannam 1992, section 5.2.3, steps 1 to 8; its functions and what goes beyond them are in `line_search`.
"""

from collections import deque
from typing import Any

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry
from blackboard.errors import BoardError
from blackboard.kinds import LINE, ROBOT, SUPPORTED_POINTS
from blackboard.messages.world import PointSet
from knowledge_sources.line_finder_params import LineFinderParams
from knowledge_sources.line_search import find_lines


class LineFinder(KnowledgeSource[LineFinderParams]):
    """Posts the lines of each batch of points, and takes those of old batches back."""

    Params = LineFinderParams
    triggers = (SUPPORTED_POINTS,)
    reads = (ROBOT,)
    posts = (LINE,)
    work = 10

    def __init__(self, params: LineFinderParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._batches: deque[list[str]] = deque()  # ids of the lines that stand

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        points: PointSet = trigger.value
        robot = board.newest(ROBOT)
        if robot is None:
            raise BoardError(f"{self.name} needs the robot's radius, and '{ROBOT.path}' does not stand; post it first")
        lines = find_lines(points, 2.0 * robot.value.radius_m, self.params)
        ids = [f"{trigger.revision}-{number}" for number in range(len(lines))]
        for id_, line in zip(ids, lines, strict=True):
            board.post(LINE, line, id=id_, supports=[trigger], stamp_s=trigger.stamp_s)
        self._batches.append(ids)
        while len(self._batches) > self.params.keep_batches:
            for id_ in self._batches.popleft():
                board.retract(LINE, id_)
