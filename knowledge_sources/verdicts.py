"""The verdicts on a source's hypotheses, kept on the board in step with their endorsements.

Posts  hypotheses/symbol/verdict/<kind>.<id>    Verdict

The theory is the mission's choice; what each makes of reasons is in `blackboard.uncertainty.theories`.
"""

from collections.abc import Sequence
from typing import Any

from blackboard.access import Access
from blackboard.entry import Entry
from blackboard.kinds import VERDICT, Kind
from blackboard.messages.conflicts import Verdict
from blackboard.messages.geometry import Point
from blackboard.uncertainty.theories import Belief, Theory, judge


def verdict_id(entry: Entry[Any]) -> str:
    """Return the id of the verdict on a hypothesis: its kind and its own id."""
    chunks = entry.key.split("/")
    return ".".join(chunks[4:])


class Verdicts:
    """Judges hypotheses by one theory; `needs` are what endorsements must speak for before one is confirmed."""

    def __init__(self, theory: Theory, needs: Sequence[str] = ()) -> None:
        self._theory = theory
        self._needs = tuple(needs)
        self._judged: dict[str, tuple[int, Belief]] = {}  # by key: the revision last judged

    def resume(self, board: Access, kind: Kind[Any]) -> None:
        """After a restart: take away this source's verdicts on hypotheses of a kind that do not stand any more."""
        standing = {verdict_id(entry) for entry in board.entries(kind)}
        for verdict in board.own(VERDICT):
            if str(verdict.id).startswith(f"{kind.name}.") and verdict.id not in standing:
                board.retract(VERDICT, verdict.id)

    def judge(
        self,
        board: Access,
        entry: Entry[Any],
        *,
        place: Point | None = None,
        look_from: Point | None = None,
        wait_until_s: float | None = None,
    ) -> Belief:
        """Post the verdict on a hypothesis where it is new or has changed, and return the belief."""
        known = self._judged.get(entry.key)
        if known is not None and known[0] == entry.revision:
            return known[1]
        belief = judge(self._theory, entry.endorsements, self._needs)
        value = Verdict(
            hypothesis=entry.key,
            theory=self._theory,
            outcome=belief.outcome,
            belief=belief.belief,
            plausibility=belief.plausibility,
            lacking=belief.lacking,
            place=place if place is not None else _place(entry),
            look_from=look_from,
            wait_until_s=wait_until_s,
        )
        standing = board.newest(VERDICT, verdict_id(entry))
        if standing is None or standing.value != value or _reasons(standing, board) != entry.endorsements:
            board.post(VERDICT, value, id=verdict_id(entry), supports=[entry])
        self._judged[entry.key] = (entry.revision, belief)
        return belief

    def close(self, board: Access, entry: Entry[Any]) -> None:
        """Take the verdict on a hypothesis away, since that is about to be retracted: whoever waits for it has still been told."""
        self._judged.pop(entry.key, None)
        if board.newest(VERDICT, verdict_id(entry)) is not None:
            board.retract(VERDICT, verdict_id(entry))


def _reasons(verdict: Entry[Verdict], board: Access) -> tuple[Any, ...]:
    hypothesis = board.revisions(verdict.supports[0]) if verdict.supports else []
    return hypothesis[-1].endorsements if hypothesis else ()


def _place(entry: Entry[Any]) -> Point | None:
    extent = entry.value.extent()
    if extent is None:
        return None
    return Point(x_m=(extent[0] + extent[2]) / 2, y_m=(extent[1] + extent[3]) / 2)
