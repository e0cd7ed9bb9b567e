"""Lines in question: what speaks for and against a line that matches none known, and against known ones that are missing.

Reads  hypotheses/feature/expected_lines
Posts  hypotheses/symbol/new_area_visited/<n>    NewAreaVisited
       hypotheses/symbol/verdict/<kind>.<id>     Verdict

Source: Bou-Ghannam 1992, section 3.3: such a line is of an area not modelled yet, or a sensing error; never silently dropped.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import hypot
from typing import Any, TypeVar

from blackboard.access import Access
from blackboard.entry import Entry, Strength, Support
from blackboard.kinds import EXPECTED_LINES, MODEL_LINE, NEW_AREA_VISITED
from blackboard.messages.base import Message
from blackboard.messages.geometry import Point
from blackboard.messages.model import ModelLine, NewAreaVisited
from blackboard.parameters import require
from blackboard.uncertainty.endorsements import reasons, standing
from blackboard.uncertainty.theories import Theory, judge
from knowledge_sources.line_model import Observed
from knowledge_sources.line_sightings import Missed
from knowledge_sources.stretches import Stretches
from knowledge_sources.verdicts import Verdicts

M = TypeVar("M", bound=Message)


@dataclass(frozen=True, slots=True, kw_only=True)
class QuestionParams:
    """When a new line counts, and when an old one has gone."""

    elsewhere_m: float = (
        0.5  # so far the robot must have moved for another look: what cross-talk made is then elsewhere
    )
    least_views: int = 3  # on the way through one batch, from which a line must have been in view to be missed
    misses: int = 8  # in a row: a finder that finds half of what is there misses so often once in 256 times
    misses_of_new: int = 4  # of a line not confirmed yet
    theory: Theory = "endorsements"  # that weighs the reasons for and against lines

    def __post_init__(self) -> None:
        require(self.elsewhere_m >= 0.0, "elsewhere_m", self.elsewhere_m, "0 and more")
        for name in ("least_views", "misses", "misses_of_new"):
            require(getattr(self, name) >= 1, name, getattr(self, name), "1 and more")

    @classmethod
    def of(cls, params: object) -> "QuestionParams":
        """Return those of a component that has fields of these names among its own."""
        return cls(**{field.name: getattr(params, field.name) for field in fields(cls)})


class LinesInQuestion:
    """Keeps the hypotheses of new lines, and counts how often lines were missing."""

    def __init__(self, params: QuestionParams) -> None:
        self._params = params
        self._verdicts = Verdicts(params.theory, needs=("elsewhere",))
        self._missed = Missed()
        self._viewed = 0  # the last revision of the expected lines that has counted

    def resume(self, board: Access) -> None:
        """After a restart: take away the verdicts on lines that are in question no more."""
        self._verdicts.resume(board, NEW_AREA_VISITED)

    def open(
        self, board: Access, id_: str, line: ModelLine, seen: Observed, trigger: Entry[Any]
    ) -> Entry[NewAreaVisited]:
        """Post the hypothesis that there is a new line."""
        area = NewAreaVisited(line=line, seen_from=Point(x_m=seen.from_x_m, y_m=seen.from_y_m))
        new = board.post(NEW_AREA_VISITED, area, id=id_, supports=[trigger], stamp_s=trigger.stamp_s)
        new = board.endorse(new, "for", "a line that matches none known", about="seen", strength="weak")
        self._verdicts.judge(board, new)
        return new

    def look_again(
        self, board: Access, entry: Entry[NewAreaVisited], line: ModelLine, seen: Observed, trigger: Entry[Any]
    ) -> tuple[Entry[NewAreaVisited], bool]:
        """Post the hypothesis as `line` makes it after another look; return it and whether it is sure now.

        From elsewhere that confirms it; while anybody has a doubt, it waits.
        """
        old, entry = entry.value, not_missing(entry, board)
        area = NewAreaVisited(line=line, seen_from=old.seen_from)
        supports, stamp_s = with_another(entry, trigger), seen_at_s(entry, trigger)
        entry = board.post(NEW_AREA_VISITED, area, id=entry.id, supports=supports, stamp_s=stamp_s)
        away = hypot(seen.from_x_m - old.seen_from.x_m, seen.from_y_m - old.seen_from.y_m)
        if away >= self._params.elsewhere_m and not any(e.about == "elsewhere" for e in entry.endorsements):
            why = f"seen again {away:.1f} m from where it was first seen"
            entry = board.endorse(entry, "for", why, about="elsewhere", strength="strong")
        sure = self._verdicts.judge(board, entry).outcome == "confirmed"
        return entry, sure and not reasons(standing(entry.endorsements), "against")

    def close(self, board: Access, entry: Entry[NewAreaVisited]) -> None:
        """Take a hypothesis off the board: it is a line of the model now."""
        self._verdicts.close(board, entry)
        board.retract(NEW_AREA_VISITED, entry.id)

    def deny(
        self,
        board: Access,
        seen: Sequence[str],
        known: Mapping[str, Entry[ModelLine]],
        doubtful: Mapping[str, Entry[NewAreaVisited]],
    ) -> list[str]:
        """Speak against what was in view and not seen too often; take back what is denied, and return the known ones of it."""
        self._count_missed(board, seen, known, doubtful)
        gone = []
        for kind, lines in ((MODEL_LINE, known), (NEW_AREA_VISITED, doubtful)):
            for id_ in [i for i in lines if i not in seen]:
                entry: Entry[Any] | None = board.newest(kind, id_)
                if entry is None or not entry.endorsements:
                    continue
                if kind is NEW_AREA_VISITED:
                    outcome = self._verdicts.judge(board, entry).outcome
                else:
                    outcome = judge(self._params.theory, entry.endorsements).outcome
                if outcome != "denied":
                    continue
                self._verdicts.close(board, entry)
                board.retract(kind, id_)
                self._missed.forget(id_)
                if kind is MODEL_LINE:
                    gone.append(id_)
        return gone

    def _count_missed(
        self,
        board: Access,
        seen: Sequence[str],
        known: Mapping[str, Entry[ModelLine]],
        doubtful: Mapping[str, Entry[NewAreaVisited]],
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
        for id_, times in self._missed.note(ids, self._params.least_views, seen):
            entry: Entry[Any] | None = known.get(id_) or doubtful.get(id_)
            if entry is None:
                self._missed.forget(id_)
                continue
            last = self._params.misses_of_new if id_ in doubtful else self._params.misses
            if times >= last and any(e.about == "elsewhere" for e in entry.endorsements):
                entry = board.withdraw(entry, "elsewhere", "it is not seen any more")
            if times in (max(last // 2, 1), last):
                why = f"in view and not seen in {times} sets of lines, one after the other"
                strength: Strength = "strong" if times >= last else "fair"
                board.endorse(entry, "against", why, about="missing", strength=strength)


def not_missing(entry: Entry[M], board: Access) -> Entry[M]:
    """Take back that a line was in view and not seen, where that was said: here it is."""
    said = [e for e in entry.endorsements if (e.who, e.about) == (board.name, "missing")]
    if said and said[-1].verdict != "withdrawn":
        return board.withdraw(entry, "missing", "seen again")
    return entry


def seen_at_s(entry: Entry[Any], trigger: Entry[Any]) -> float:
    """Return when it was seen again: at the trigger's stamp, but not before anybody's last word about it."""
    return max(entry.stamp_s, trigger.stamp_s)


def with_another(entry: Entry[Any], trigger: Entry[Any]) -> list[Support]:
    """Return what a line stands on that stood already, and was seen once more."""
    stretches = Stretches()
    stretches.merge(entry.supports)
    stretches.add((trigger,))
    return stretches.supports()
