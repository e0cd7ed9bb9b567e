"""Keeps the global model of lines: matches what is seen with it, merges, admits what is new, drops what has gone.

Triggered by  observations/feature/line_set             LineSet: match
              hypotheses/feature/re_reference           ReReference: merge what was matched, at the corrected pose
Reads         observations/feature/line, observations/feature/supported_points, hypotheses/feature/pose_estimate,
              hypotheses/feature/expected_lines
Posts         hypotheses/feature/line_matches           LineMatches
              hypotheses/feature/model_line/<n>         ModelLine
              hypotheses/symbol/new_area_visited/<n>    NewAreaVisited: confirmed, it becomes model line <n>
              hypotheses/symbol/verdict/new_area_visited.*  Verdict

Source: Bou-Ghannam 1992, sections 5.2.4.1 and 3.3; functions in `line_estimates`, `line_match`, `line_model`. With
`wait_for_re_reference = false` it merges at once, where odometry says. Anyone may speak against a line (`line_doubts` does):
what is denied by all that was said of it, is taken back.
"""

from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.kinds import (
    EXPECTED_LINES,
    LINE,
    LINE_MATCHES,
    LINE_SET,
    MODEL_LINE,
    NEW_AREA_VISITED,
    POSE_ESTIMATE,
    RE_REFERENCE,
    SUPPORTED_POINTS,
    VERDICT,
)
from blackboard.messages.model import LineMatches, LineSet, ModelLine, NewAreaVisited, PoseEstimate, ReReference
from blackboard.uncertainty.matrices import Array
from knowledge_sources.line_estimates import as_model_line, from_model_line
from knowledge_sources.line_match import merge_lines
from knowledge_sources.line_model import Observed, best_match, match_lines
from knowledge_sources.lines_in_question import LinesInQuestion, not_missing, seen_at_s, with_another
from knowledge_sources.match_merge_params import MatchMergeParams
from knowledge_sources.observed_lines import observed_line
from knowledge_sources.pose_correction import pose_error_seen


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Batch:
    """A batch of observed lines that waits for its re-reference."""

    number: int
    observed: tuple[Observed, ...]


class MatchMerge(KnowledgeSource[MatchMergeParams]):
    """Holds the model together."""

    Params = MatchMergeParams
    reads = (LINE, SUPPORTED_POINTS, POSE_ESTIMATE, EXPECTED_LINES)
    posts = (LINE_MATCHES, MODEL_LINE, NEW_AREA_VISITED, VERDICT)
    rating = 8.0
    work = 5

    def __init__(self, params: MatchMergeParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._batch: Batch | None = None
        self._made = 0  # lines that were new
        self._in_question = LinesInQuestion(params.question)
        if params.wait_for_re_reference:
            self.triggers = (LINE_SET, Trigger(kind=RE_REFERENCE, when=self._awaited))
        else:
            self.triggers = (LINE_SET,)

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        self._made = max(self._made, board.last_number(MODEL_LINE), board.last_number(NEW_AREA_VISITED))
        self._in_question.resume(board)

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        if isinstance(trigger.value, LineSet):
            self._match(trigger, board)
            if not self.params.wait_for_re_reference:
                self._merge(None, trigger, board)
        else:
            self._merge(trigger.value, trigger, board)

    def _awaited(self, entry: Entry[ReReference]) -> bool:
        return self._batch is not None and entry.value.batch == self._batch.number

    def _match(self, trigger: Entry[LineSet], board: Access) -> None:
        lines = [entry for id_ in trigger.value.lines if (entry := board.newest(LINE, id_)) is not None]
        observed = tuple(observed_line(entry, board, self.params.floor) for entry in lines)
        at, pose = _pose(board.newest(POSE_ESTIMATE))
        model = {str(entry.id): entry.value for entry in board.entries(MODEL_LINE)}
        found = match_lines(observed, model, at, pose, self.params.limits)
        value = LineMatches(batch=trigger.value.batch, matches=found)
        supports: list[Entry[Any]] = [trigger, *lines]
        board.post(LINE_MATCHES, value, supports=supports, stamp_s=trigger.stamp_s)
        self._batch = Batch(number=trigger.value.batch, observed=observed)

    def _merge(self, correction: ReReference | None, trigger: Entry[Any], board: Access) -> None:
        batch, self._batch = self._batch, None
        if batch is None or (correction is not None and not correction.applied):
            return  # where the robot is has become doubtful: these lines would only spoil the model
        observed = [_moved(seen, correction) for seen in batch.observed]
        at, pose = _pose(board.newest(POSE_ESTIMATE))
        known = {str(entry.id): entry for entry in board.entries(MODEL_LINE)}
        first = not known
        doubtful = {str(entry.id): entry for entry in board.entries(NEW_AREA_VISITED)}
        seen_ids: list[str] = []
        for seen in observed:
            found = best_match(seen.line, {i: e.value for i, e in known.items()}, at, pose, self.params.limits)
            if found is not None:
                known[found[0]] = self._merge_into(known[found[0]], seen, trigger, board)
                seen_ids.append(found[0])
                continue
            found = best_match(seen.line, {i: e.value.line for i, e in doubtful.items()}, at, pose, self.params.limits)
            if found is not None:
                self._look_again(doubtful.pop(found[0]), seen, trigger, board, doubtful, known)
                seen_ids.append(found[0])
                continue
            id_, line = self._new(seen, at, pose)
            if first:
                known[id_] = board.post(MODEL_LINE, line, id=id_, supports=[trigger], stamp_s=trigger.stamp_s)
            else:
                doubtful[id_] = self._in_question.open(board, id_, line, seen, trigger)
            seen_ids.append(id_)
        self._in_question.deny(board, seen_ids, known, doubtful)

    def _new(self, seen: Observed, at: tuple[float, float], pose: Array) -> tuple[str, ModelLine]:
        self._made += 1
        error = pose_error_seen(seen.line.theta_rad, seen.line.x_m, seen.line.y_m, at, pose)
        return str(self._made), as_model_line(seen.line, sqrt(float(error[0, 0])), sqrt(float(error[1, 1])), 1)

    def _merged(self, old: ModelLine, seen: Observed) -> ModelLine:
        line = merge_lines(from_model_line(old), seen.line, self.params.floor)
        inherited = old.inherited_sigma_theta_rad, old.inherited_sigma_rho_m
        return as_model_line(line, *inherited, old.observations + 1)

    def _merge_into(
        self, entry: Entry[ModelLine], seen: Observed, trigger: Entry[Any], board: Access
    ) -> Entry[ModelLine]:
        line, entry = self._merged(entry.value, seen), not_missing(entry, board)
        supports, stamp_s = with_another(entry, trigger), seen_at_s(entry, trigger)
        return board.post(MODEL_LINE, line, id=entry.id, supports=supports, stamp_s=stamp_s)

    def _look_again(
        self,
        entry: Entry[NewAreaVisited],
        seen: Observed,
        trigger: Entry[Any],
        board: Access,
        doubtful: dict[str, Entry[NewAreaVisited]],
        known: dict[str, Entry[ModelLine]],
    ) -> None:
        """A line in question was seen once more: where that makes it sure, it joins the model."""
        line, id_ = self._merged(entry.value.line, seen), str(entry.id)
        entry, sure = self._in_question.look_again(board, entry, line, seen, trigger)
        if not sure:
            doubtful[id_] = entry
            return
        known[id_] = board.post(MODEL_LINE, line, id=id_, supports=[entry], stamp_s=trigger.stamp_s)
        self._in_question.close(board, entry)


def _pose(entry: Entry[PoseEstimate] | None) -> tuple[tuple[float, float], Array]:
    """Return where the robot is, and the covariance (3, 3) of its pose; without an estimate the pose counts as exact."""
    if entry is None:
        return (0.0, 0.0), np.zeros((3, 3))
    pose, covariance = entry.value.map_from_robot, np.zeros((3, 3))
    covariance[np.triu_indices(3)] = entry.value.covariance
    return (pose.x_m, pose.y_m), covariance + np.triu(covariance, 1).T


def _moved(seen: Observed, correction: ReReference | None) -> Observed:
    if correction is None:
        return seen
    centre, shift = correction.centre, correction.shift
    line = seen.line.turned(centre.x_m, centre.y_m, shift.x_m, shift.y_m, correction.turn_rad)
    return Observed(id=seen.id, line=line, from_x_m=seen.from_x_m, from_y_m=seen.from_y_m)
