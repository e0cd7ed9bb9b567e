"""The 2-D line finder: lines in each batch of points that the grid bears out.

Triggered by  observations/feature/supported_points  PointSet
Reads         status/robot                           RobotDescription, for its diameter
Posts         observations/feature/line/<batch>-<n>  Line, <batch> being the revision of the points
              observations/feature/line_set          LineSet: after all lines of a batch

Echoes of sonars that no line claimed wait, and are searched together when there are enough of them: a line's supports name the
stretch of batches that its echoes came in. Source: Bou-Ghannam 1992, section 5.2.3, steps 1 to 8; its functions and what goes
beyond them are in `line_search` and `place_search`.
"""

from collections import deque

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry, Support
from blackboard.errors import BoardError
from blackboard.kinds import LINE, LINE_SET, ROBOT, SUPPORTED_POINTS
from blackboard.messages.model import LineSet
from blackboard.messages.world import Line, PointSet
from knowledge_sources.leftover_echoes import Leftovers
from knowledge_sources.line_finder_params import LineFinderParams
from knowledge_sources.line_methods import as_echoes, find_pieces
from knowledge_sources.line_search import as_line


class LineFinder(KnowledgeSource[LineFinderParams]):
    """Posts the lines of each batch of points, and takes those of old batches back."""

    Params = LineFinderParams
    triggers = (SUPPORTED_POINTS,)
    reads = (ROBOT,)
    posts = (LINE, LINE_SET)
    work = 10

    def __init__(self, params: LineFinderParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._batches: deque[list[str]] = deque()  # ids of the lines that stand
        self._leftovers = Leftovers()
        self._last: Entry[PointSet] | None = None
        self._done = 0  # the batch that was searched last

    def resume(self, state: object, board: Access) -> None:
        """Go on with the lines that stand; those of a batch that was not searched to its end are taken back."""
        super().resume(state, board)
        done = board.newest(LINE_SET)
        self._done = done.value.batch if done is not None else 0
        batches: dict[int, list[str]] = {}
        for entry in board.own(LINE):
            batches.setdefault(int(str(entry.id).partition("-")[0]), []).append(str(entry.id))
        for id_ in batches.pop(max(batches, default=0), []) if max(batches, default=0) > self._done else []:
            board.retract(LINE, id_)
        self._batches = deque(batches[number] for number in sorted(batches))

    def activate(self, trigger: Entry[PointSet], board: Access) -> None:
        if trigger.revision <= self._done:
            return  # a process before this one has searched it
        self._last, self._done = trigger, trigger.revision
        self._batches.append([])
        echoes = as_echoes(trigger.value, self.params)
        pieces = find_pieces(echoes, self._largest_gap_m(board), self.params)
        left = echoes.half_cone_rad > 0.0  # a beam says where it ended: more of them tell no more of it
        for piece in pieces:
            left[piece.members] = False
            self._post(board, trigger, as_line(piece), trigger.as_support())
        self._leftovers = self._leftovers.with_more(echoes.take(left), trigger.revision, self.params.leftovers)
        if 2 * self._leftovers.new >= self.params.leftovers:
            self._search_leftovers(board, trigger)
        lines = LineSet(batch=trigger.revision, lines=tuple(self._batches[-1]))
        board.post(LINE_SET, lines, supports=[trigger], stamp_s=trigger.stamp_s)
        while len(self._batches) > self.params.keep_batches:
            for id_ in self._batches.popleft():
                board.retract(LINE, id_)

    def finish(self, board: Access) -> None:
        if self._last is not None:
            self._search_leftovers(board, self._last)

    def _search_leftovers(self, board: Access, trigger: Entry[PointSet]) -> None:
        pieces = find_pieces(self._leftovers.echoes, self._largest_gap_m(board), self.params)
        for piece in pieces:
            batches = self._leftovers.batches[piece.members]
            support = Support(trigger.key, int(batches.min()), int(batches.max()))
            self._post(board, trigger, as_line(piece), support)
        claimed = np.concatenate([np.zeros(0, dtype=np.intp), *(piece.members for piece in pieces)])
        self._leftovers = self._leftovers.after_search(claimed)

    def _post(self, board: Access, trigger: Entry[PointSet], line: Line, support: Support) -> None:
        ids = self._batches[-1]
        ids.append(f"{trigger.revision}-{len(ids)}")
        board.post(LINE, line, id=ids[-1], supports=[support], stamp_s=trigger.stamp_s)

    def _largest_gap_m(self, board: Access) -> float:
        robot = board.newest(ROBOT)
        if robot is None:
            raise BoardError(f"{self.name} needs the robot's radius, and '{ROBOT.path}' does not stand; post it first")
        return 2.0 * robot.value.radius_m
