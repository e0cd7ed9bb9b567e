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

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Any, TypeVar

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry, Strength, Support
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
from blackboard.messages.base import Message
from blackboard.messages.geometry import Point
from blackboard.messages.model import LineMatches, LineSet, ModelLine, NewAreaVisited, PoseEstimate, ReReference
from blackboard.messages.world import Line, PointSet
from blackboard.uncertainty.endorsements import reasons, standing
from blackboard.uncertainty.matrices import Array
from blackboard.uncertainty.theories import judge
from knowledge_sources.line_estimates import as_model_line, from_line, from_model_line
from knowledge_sources.line_match import merge_lines
from knowledge_sources.line_model import Observed, best_match, match_lines
from knowledge_sources.line_sightings import Missed
from knowledge_sources.match_merge_params import MatchMergeParams
from knowledge_sources.pose_correction import pose_error_seen
from knowledge_sources.stretches import Stretches
from knowledge_sources.verdicts import Verdicts

M = TypeVar("M", bound=Message)
NEAR_LINE_M = 0.3  # points this near to a line say from which side it was sensed


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Batch:
    """A batch of observed lines that waits for its re-reference."""

    number: int
    observed: tuple[Observed, ...]
    matches: Entry[LineMatches]


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
        self._missed = Missed()
        self._verdicts = Verdicts(params.theory, needs=("elsewhere",))
        self._viewed = 0  # the last revision of the expected lines that has counted
        if params.wait_for_re_reference:
            self.triggers = (LINE_SET, Trigger(kind=RE_REFERENCE, when=self._awaited))
        else:
            self.triggers = (LINE_SET,)

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
        observed = tuple(self._as_observed(entry, board) for entry in lines)
        at, pose = _pose(board.newest(POSE_ESTIMATE))
        model = {str(entry.id): entry.value for entry in board.entries(MODEL_LINE)}
        found = match_lines(observed, model, at, pose, self.params.limits)
        value = LineMatches(batch=trigger.value.batch, matches=found)
        supports: list[Entry[Any]] = [trigger, *lines]
        posted = board.post(LINE_MATCHES, value, supports=supports, stamp_s=trigger.stamp_s)
        self._batch = Batch(number=trigger.value.batch, observed=observed, matches=posted)

    def _as_observed(self, entry: Entry[Line], board: Access) -> Observed:
        points = [e.value for support in entry.supports for e in board.revisions(support)]
        sensed_from = _sensed_from([p for p in points if isinstance(p, PointSet)], entry.value)
        line = from_line(entry.value, sensed_from, self.params.floor)
        mean = sensed_from.mean(axis=0).tolist() if len(sensed_from) else [line.x_m, line.y_m]
        return Observed(id=str(entry.id), line=line, from_x_m=mean[0], from_y_m=mean[1])

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
                area = NewAreaVisited(line=line, seen_from=Point(x_m=seen.from_x_m, y_m=seen.from_y_m))
                new = board.post(NEW_AREA_VISITED, area, id=id_, supports=[trigger], stamp_s=trigger.stamp_s)
                new = board.endorse(new, "for", "a line that matches none known", about="seen", strength="weak")
                self._verdicts.judge(board, new)
                doubtful[id_] = new
            seen_ids.append(id_)
        self._deny(seen_ids, known, doubtful, board)

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
        line, entry = self._merged(entry.value, seen), _not_missing(entry, board)
        return board.post(
            MODEL_LINE, line, id=entry.id, supports=_with(entry, trigger), stamp_s=_stamp_s(entry, trigger)
        )

    def _look_again(
        self,
        entry: Entry[NewAreaVisited],
        seen: Observed,
        trigger: Entry[Any],
        board: Access,
        doubtful: dict[str, Entry[NewAreaVisited]],
        known: dict[str, Entry[ModelLine]],
    ) -> None:
        """A line in question was seen once more: from elsewhere that confirms it, and it joins the model."""
        id_, old, entry = str(entry.id), entry.value, _not_missing(entry, board)
        area = NewAreaVisited(line=self._merged(old.line, seen), seen_from=old.seen_from)
        stamp_s = _stamp_s(entry, trigger)
        entry = board.post(NEW_AREA_VISITED, area, id=id_, supports=_with(entry, trigger), stamp_s=stamp_s)
        away = hypot(seen.from_x_m - old.seen_from.x_m, seen.from_y_m - old.seen_from.y_m)
        if away >= self.params.elsewhere_m and not any(e.about == "elsewhere" for e in entry.endorsements):
            why = f"seen again {away:.1f} m from where it was first seen"
            entry = board.endorse(entry, "for", why, about="elsewhere", strength="strong")
        sure = self._verdicts.judge(board, entry).outcome == "confirmed"
        if not sure or reasons(standing(entry.endorsements), "against"):  # while anybody has a doubt, it waits
            doubtful[id_] = entry
            return
        known[id_] = board.post(MODEL_LINE, area.line, id=id_, supports=[entry], stamp_s=trigger.stamp_s)
        self._verdicts.close(board, entry)
        board.retract(NEW_AREA_VISITED, id_)

    def _deny(
        self,
        seen: Sequence[str],
        known: dict[str, Entry[ModelLine]],
        doubtful: dict[str, Entry[NewAreaVisited]],
        board: Access,
    ) -> None:
        """Speak against what was in view and not seen too often, and take back what is denied."""
        self._count_missed(seen, known, doubtful, board)
        for kind, lines in ((MODEL_LINE, known), (NEW_AREA_VISITED, doubtful)):
            for id_ in [i for i in lines if i not in seen]:
                entry: Entry[Any] | None = board.newest(kind, id_)
                if entry is None or not entry.endorsements:
                    continue
                if kind is NEW_AREA_VISITED:
                    outcome = self._verdicts.judge(board, entry).outcome
                else:
                    outcome = judge(self.params.theory, entry.endorsements).outcome
                if outcome == "denied":
                    self._verdicts.close(board, entry)
                    board.retract(kind, id_)
                    self._missed.forget(id_)

    def _count_missed(
        self,
        seen: Sequence[str],
        known: dict[str, Entry[ModelLine]],
        doubtful: dict[str, Entry[NewAreaVisited]],
        board: Access,
    ) -> None:
        newest = board.newest(EXPECTED_LINES)
        if newest is None or newest.revision <= self._viewed:
            return
        support = Support(newest.key, self._viewed + 1, newest.revision)
        views = [entry.value for entry in board.revisions(support)]
        self._viewed = newest.revision
        if not any(id_ in known for id_ in seen):
            return  # where nothing known was seen, the pose is in doubt before the lines are
        ids = [(*view.model, *view.new_areas) for view in views]
        for id_, times in self._missed.note(ids, self.params.least_views, seen):
            entry: Entry[Any] | None = known.get(id_) or doubtful.get(id_)
            if entry is None:
                self._missed.forget(id_)
                continue
            last = self.params.misses_of_new if id_ in doubtful else self.params.misses
            if times >= last and any(e.about == "elsewhere" for e in entry.endorsements):
                entry = board.withdraw(entry, "elsewhere", "it is not seen any more")
            if times in (max(last // 2, 1), last):
                why = f"in view and not seen in {times} sets of lines, one after the other"
                strength: Strength = "strong" if times >= last else "fair"
                board.endorse(entry, "against", why, about="missing", strength=strength)


def _not_missing(entry: Entry[M], board: Access) -> Entry[M]:
    """Take back that a line was in view and not seen, where that was said: here it is."""
    said = [e for e in entry.endorsements if (e.who, e.about) == (board.name, "missing")]
    if said and said[-1].verdict != "withdrawn":
        return board.withdraw(entry, "missing", "seen again")
    return entry


def _stamp_s(entry: Entry[Any], trigger: Entry[Any]) -> float:
    """Return when it was seen again: at the trigger's stamp, but not before anybody's last word about it."""
    return max(entry.stamp_s, trigger.stamp_s)


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


def _sensed_from(points: Sequence[PointSet], line: Line) -> Array:
    """Return (n, 2) where those points were sensed from that lie near a line; where none does, where all were."""
    if not points:
        return np.zeros((0, 2))
    places = np.concatenate([p.points.unpack() for p in points]).astype(np.float64)
    origins = np.concatenate([p.sensed_from.unpack() for p in points]).astype(np.float64)
    start = np.array([line.start.x_m, line.start.y_m])
    way = np.array([line.end.x_m, line.end.y_m]) - start
    length = max(float(np.hypot(*way)), 1e-9)
    c, s = way / length
    along = (places - start) @ np.array([c, s])
    out = (places - start) @ np.array([s, -c])
    near = (np.abs(out) <= NEAR_LINE_M) & (along >= 0.0) & (along <= length)
    return origins[near] if near.any() else origins


def _with(entry: Entry[Any], trigger: Entry[Any]) -> list[Support]:
    """Return what a line stands on that stood already, and was seen once more."""
    stretches = Stretches()
    stretches.merge(entry.supports)
    stretches.add((trigger,))
    return stretches.supports()
