"""What becomes of a jump of the pose that was refused: the batches of lines that follow confirm it or deny it.

Triggered by  hypotheses/symbol/pose_conflict/<batch>     PoseConflict
              hypotheses/feature/re_reference             ReReference: of the batches that follow
Posts         hypotheses/symbol/verdict/pose_conflict.*   Verdict

A later batch that finds the pose within its bound denies it: the lines that asked for the jump were wrong ones. Others that ask
for much the same jump confirm it: the robot is not where it believes to be. Source: Bou-Ghannam 1992, section 3.3.
"""

from dataclasses import dataclass
from math import hypot, radians
from typing import Any

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry
from blackboard.kinds import POSE_CONFLICT, RE_REFERENCE, VERDICT
from blackboard.messages.geometry import wrap_angle
from blackboard.messages.model import PoseConflict, ReReference
from blackboard.parameters import require
from blackboard.uncertainty.endorsements import standing
from blackboard.uncertainty.theories import Theory
from knowledge_sources.standing_hypotheses import Reason, give
from knowledge_sources.verdicts import Verdicts


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseConflictsParams:
    """Which jumps are the same, and how many must agree."""

    same_m: float = 0.3  # two jumps that differ by less ask for the same: some three sigma of what a few lines give
    same_rad: float = radians(5.0)
    agreeing: int = 3  # batches in all: the same wrong match twice may be chance
    theory: Theory = "endorsements"  # that weighs the reasons

    def __post_init__(self) -> None:
        require(0.0 < self.same_m <= 10.0, "same_m", self.same_m, "(0, 10] metres")
        require(0.0 < self.same_rad <= radians(90.0), "same_rad", self.same_rad, "(0, 90] degrees")
        require(2 <= self.agreeing <= 100, "agreeing", self.agreeing, "[2, 100]")


def alike(a: ReReference, b: ReReference, params: PoseConflictsParams) -> bool:
    """Say whether two batches ask for much the same jump."""
    apart_m = hypot(a.shift.x_m - b.shift.x_m, a.shift.y_m - b.shift.y_m)
    return apart_m <= params.same_m and abs(wrap_angle(a.turn_rad - b.turn_rad)) <= params.same_rad


@dataclass
class _Open:
    """A conflict that is in doubt, and how many batches ask for its jump."""

    refused: ReReference
    agreeing: int = 1


class PoseConflicts(KnowledgeSource[PoseConflictsParams]):
    """Follows each refused jump until it is confirmed or denied."""

    Params = PoseConflictsParams
    triggers = (POSE_CONFLICT, RE_REFERENCE)
    posts = (VERDICT,)
    rating = 3.0

    def __init__(self, params: PoseConflictsParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._open: dict[str, _Open] = {}  # by id
        self._newest = -1  # batch of the newest conflict
        self._verdicts = Verdicts(params.theory)

    def resume(self, state: object, board: Access) -> None:
        """Go on with the conflicts that nobody has settled, also those that came after the state was kept."""
        super().resume(state, board)
        stand = {str(entry.id): entry for entry in board.entries(POSE_CONFLICT)}
        for id_, entry in stand.items():
            refused = entry.value.refused
            if refused.batch > self._newest:
                self._newest = refused.batch
                self._open[id_] = _Open(refused)
            if any(e.who == self.name and e.about == "later" for e in entry.endorsements):
                self._open.pop(id_, None)
        self._open = {id_: open_ for id_, open_ in self._open.items() if id_ in stand}
        self._verdicts.resume(board, POSE_CONFLICT)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        if isinstance(trigger.value, PoseConflict):
            self._begin(trigger, board)
        else:
            self._go_on(trigger.value, board)

    def _begin(self, conflict: Entry[PoseConflict], board: Access) -> None:
        refused = conflict.value.refused
        if refused.batch <= self._newest:
            return  # known: somebody endorsed it
        self._newest = refused.batch
        self._open[str(conflict.id)] = _Open(refused)
        for_ = Reason(f"{len(refused.lines)} lines ask for it", "lines")
        against = Reason("it is larger than the pose's uncertainty allows", "bound", "against")
        self._say(str(conflict.id), [for_, against], board)

    def _go_on(self, batch: ReReference, board: Access) -> None:
        for id_, open_ in list(self._open.items()):
            if batch.batch == open_.refused.batch:
                continue
            if batch.applied and batch.lines:
                why = f"the {len(batch.lines)} lines of batch {batch.batch} find the pose within its bound"
                self._end(id_, Reason(why, "later", "against", "strong"), board)
            elif not batch.applied and alike(open_.refused, batch, self.params):
                open_.agreeing += 1
                if open_.agreeing >= self.params.agreeing:
                    why = f"{open_.agreeing} batches ask for the same jump"
                    self._end(id_, Reason(why, "later", strength="strong"), board)

    def _end(self, id_: str, reason: Reason, board: Access) -> None:
        del self._open[id_]
        entry = board.newest(POSE_CONFLICT, id_)
        if entry is not None:
            own = [e for e in standing(entry.endorsements) if e.who == board.name]
            said = [Reason(e.why, e.about, e.verdict, e.strength) for e in own if e.verdict != "withdrawn"]
            self._say(id_, [*said, reason], board)

    def _say(self, id_: str, reasons: list[Reason], board: Access) -> None:
        entry = board.newest(POSE_CONFLICT, id_)
        if entry is not None:
            self._verdicts.judge(board, give(board, entry, reasons), place=entry.value.refused.centre)
