"""What becomes of observed lines: known ones grow, new ones are in question until they are seen from elsewhere, missed ones go."""

from math import hypot
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.entry import Entry
from blackboard.kinds import MODEL_LINE, NEW_AREA_VISITED
from blackboard.messages.model import ModelLine, NewAreaVisited
from blackboard.uncertainty.chi_square import chi_square_quantile
from knowledge_sources.joint_estimate.line_association import LinePair, badly_seen, estimate_of, pair_lines
from knowledge_sources.joint_estimate.line_uniting import longer, unite
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import PAST, JointState, LineExtent, X, Y
from knowledge_sources.joint_estimate.window import Window
from knowledge_sources.line_estimates import LineEstimate, as_model_line, from_model_line
from knowledge_sources.line_match import MatchLimits, merge_lines
from knowledge_sources.line_model import Observed, best_match
from knowledge_sources.lines_in_question import LinesInQuestion, not_missing, seen_at_s, with_another

RECENT = np.diag([0.05**2, 0.05**2, 0.02**2])  # how far odometry goes wrong between two looks at a line in question
SHOWN_M = 1e-3  # a line whose ends moved by less is not posted anew


class LineKeeper:
    """Keeps the lines of the state and those in question."""

    def __init__(self, params: JointLinesParams, window: Window) -> None:
        self._params = params
        self._window = window
        self._made = 0
        self._in_question = LinesInQuestion(params.question)
        self._shown: dict[str, ModelLine] = {}
        self._limits = MatchLimits(gap_m=params.gap_m)

    def resume(self, state: JointState, board: Access) -> None:
        """After a restart: the lines of the state are those that stand; one that it does not know is taken in by itself."""
        self._made = max(self._made, board.last_number(MODEL_LINE), board.last_number(NEW_AREA_VISITED))
        standing = {str(entry.id): entry.value for entry in board.own(MODEL_LINE)}
        for extent in list(state.lines):
            if extent.id not in standing:
                state.drop(state.number(extent.id))
        known = {extent.id for extent in state.lines}
        for id_, value in standing.items():
            if id_ not in known:
                line = from_model_line(value)
                state.add(_extent(id_, line), line.theta_rad, line.covariance, np.zeros((2, PAST)))
        self._shown = standing
        self._in_question.resume(board)

    def take_in(self, state: JointState, seen: list[Observed], trigger: Entry[Any], board: Access) -> None:
        """Take in a batch of observed lines; what changed is posted."""
        doubtful = {str(entry.id): entry for entry in board.entries(NEW_AREA_VISITED)}
        first = not state.lines
        touched: list[str] = []  # lines of the state
        ids: list[str] = []  # and those in question
        for line in seen:
            id_ = self._known(state, line)
            if id_ is not None:
                touched.append(id_)
            else:
                id_ = badly_seen(state, line.line, self._params) or self._another(doubtful, line, state)
            if id_ is None:
                self._made += 1
                id_ = str(self._made)
                if first:
                    self._admit(state, id_, line)
                    touched.append(id_)
                else:
                    new = as_model_line(line.line, 0.0, 0.0, 1)
                    doubtful[id_] = self._in_question.open(board, id_, new, line, trigger)
            elif id_ in doubtful and self._confirms(doubtful, id_, line, trigger, board):
                self._admit(state, id_, line)
                touched.append(id_)
            ids.append(id_)
        for gone in unite(state, touched, self._params):
            self._forget(gone)
            if board.newest(MODEL_LINE, gone) is not None:
                board.retract(MODEL_LINE, gone)
        known = self._post(state, touched, trigger, board)
        for gone in self._in_question.deny(board, ids, known, doubtful):
            self._forget(gone)
            state.drop(state.number(gone))
        state.begin_batch()

    def _known(self, state: JointState, seen: Observed) -> str | None:
        """Return the id of the line of the state that was seen, which may be longer now."""
        pairs = pair_lines(state, seen.line, self._params.gap_m)
        bound = chi_square_quantile(self._params.match_confidence, 2)
        if not pairs or pairs[0].distance > bound:
            return None
        pair = pairs[0]
        if pair.to_m - pair.from_m >= self._params.least_m:
            self._relocate(state, pair)
        state.lines[pair.number] = longer(state.lines[pair.number], pair)
        return state.lines[pair.number].id

    def _relocate(self, state: JointState, pair: LinePair) -> None:
        """Let the line as a whole say where the robot is, and how the known one runs.

        Where echoes can still be told apart they have said most of it already, so that it counts as a quarter of a look.
        """
        own = pair.h @ state.covariance @ pair.h.T
        shares = own[1, 1] <= self._params.unsure_m**2 / 4.0
        state.update(pair.difference, -pair.h, pair.noise * (4.0 if shares else 1.0))

    def _another(self, doubtful: dict[str, Entry[NewAreaVisited]], seen: Observed, state: JointState) -> str | None:
        """Return the id of the line in question that was seen once more."""
        lines = {id_: entry.value.line for id_, entry in doubtful.items()}
        found = best_match(seen.line, lines, (float(state.mean[X]), float(state.mean[Y])), RECENT, self._limits)
        return None if found is None else found[0]

    def _confirms(
        self,
        doubtful: dict[str, Entry[NewAreaVisited]],
        id_: str,
        seen: Observed,
        trigger: Entry[Any],
        board: Access,
    ) -> bool:
        """Say whether a line in question is sure after another look; then it is in question no more."""
        old = doubtful[id_].value.line
        merged = merge_lines(from_model_line(old), seen.line, self._params.floor)
        line = as_model_line(merged, 0.0, 0.0, old.observations + 1)
        doubtful[id_], sure = self._in_question.look_again(board, doubtful[id_], line, seen, trigger)
        if sure:
            self._in_question.close(board, doubtful.pop(id_))
        return sure

    def _admit(self, state: JointState, id_: str, seen: Observed) -> None:
        line = seen.line
        state.add(_extent(id_, line), line.theta_rad, line.covariance, state.seen(line.x_m, line.y_m, line.theta_rad))
        self._window.look_back(state, self._params)

    def _post(
        self, state: JointState, touched: list[str], trigger: Entry[Any], board: Access
    ) -> dict[str, Entry[ModelLine]]:
        """Post the lines that were seen or have moved; return all that stand."""
        known = {}
        for number, extent in enumerate(state.lines):
            line = as_model_line(estimate_of(state, number), 0.0, 0.0, extent.observations)
            shown, entry = self._shown.get(extent.id), board.newest(MODEL_LINE, extent.id)
            if entry is None:
                entry = board.post(MODEL_LINE, line, id=extent.id, supports=[trigger], stamp_s=trigger.stamp_s)
            elif extent.id in touched or shown is None or not _alike(line, shown):
                entry = not_missing(entry, board) if extent.id in touched else entry
                supports, stamp_s = with_another(entry, trigger), seen_at_s(entry, trigger)
                entry = board.post(MODEL_LINE, line, id=extent.id, supports=supports, stamp_s=stamp_s)
            else:
                line = shown
            self._shown[extent.id] = line
            known[extent.id] = entry
        return known

    def _forget(self, id_: str) -> None:
        self._shown.pop(id_, None)


def _extent(id_: str, line: LineEstimate) -> LineExtent:
    half = line.half_length_m
    return LineExtent(
        id=id_, anchor_x_m=line.x_m, anchor_y_m=line.y_m, from_m=-half, to_m=half, faces_left=line.faces_left
    )


def _alike(a: ModelLine, b: ModelLine) -> bool:
    places = ((a.start, b.start), (a.end, b.end))
    return all(hypot(p.x_m - q.x_m, p.y_m - q.y_m) < SHOWN_M for p, q in places)
