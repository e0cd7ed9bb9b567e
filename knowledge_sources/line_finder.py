"""The 2-D line finder: lines in each batch of points that the grid bears out.

Triggered by  observations/feature/supported_points  PointSet
Reads         status/robot                           RobotDescription, for its diameter
Posts         observations/feature/line/<batch>-<n>  Line, <batch> being the revision of the points

Source: Bou-Ghannam 1992, section 5.2.3, steps 1 to 8; its functions and what goes beyond them are in `line_search`.
"""

from collections import deque
from collections.abc import Iterator
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry, Support
from blackboard.errors import BoardError
from blackboard.kinds import LINE, ROBOT, SUPPORTED_POINTS
from blackboard.messages.world import Line
from knowledge_sources.leftover_echoes import Leftovers
from knowledge_sources.line_finder_params import LineFinderParams
from knowledge_sources.line_search import as_echoes, as_line, find_pieces


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
        self._leftovers = Leftovers()

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        robot = board.newest(ROBOT)
        if robot is None:
            raise BoardError(f"{self.name} needs the robot's radius, and '{ROBOT.path}' does not stand; post it first")
        ids: list[str] = []
        for line, first, last in self._find(trigger, 2.0 * robot.value.radius_m):
            ids.append(f"{trigger.revision}-{len(ids)}")
            support = Support(trigger.key, first, last)
            board.post(LINE, line, id=ids[-1], supports=[support], stamp_s=trigger.stamp_s)
        self._batches.append(ids)
        while len(self._batches) > self.params.keep_batches:
            for id_ in self._batches.popleft():
                board.retract(LINE, id_)

    def _find(self, trigger: Entry[Any], largest_gap_m: float) -> Iterator[tuple[Line, int, int]]:
        """Give the lines of a batch, then of what waits if it is time, each with the first and last batch of its points."""
        params = self.params
        echoes = as_echoes(trigger.value, params)
        left = echoes.half_cone_rad > 0.0
        for piece in find_pieces(echoes, largest_gap_m, params):
            left[piece.members] = False
            yield as_line(piece), trigger.revision, trigger.revision
        self._leftovers = self._leftovers.with_more(echoes.take(left), trigger.revision, params.leftovers)
        if 2 * self._leftovers.new < params.leftovers or not len(self._leftovers.echoes):
            return
        pieces = find_pieces(self._leftovers.echoes, largest_gap_m, params)
        for piece in pieces:
            batches = self._leftovers.batches[piece.members]
            yield as_line(piece), int(batches.min()), int(batches.max())
        claimed = np.concatenate([np.zeros(0, dtype=np.intp), *(piece.members for piece in pieces)])
        self._leftovers = self._leftovers.after_search(claimed)
