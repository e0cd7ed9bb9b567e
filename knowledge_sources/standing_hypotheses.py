"""Keeping a source's hypotheses on the board in step with what it finds: posted, revised when they change, denied when gone."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import hypot
from typing import Any, Generic, Literal, TypeVar

from blackboard.access import Access
from blackboard.entry import Entry, Strength, Support
from blackboard.kinds import Kind
from blackboard.messages.base import Message
from blackboard.uncertainty.endorsements import standing
from knowledge_sources.verdicts import Verdicts

M = TypeVar("M", bound=Message)


@dataclass(frozen=True, slots=True)
class Reason:
    """One reason for or against a hypothesis; what it is about tells it from the source's other reasons."""

    why: str
    about: str = ""
    verdict: Literal["for", "against"] = "for"
    strength: Strength = "fair"


@dataclass(frozen=True, slots=True)
class Found(Generic[M]):
    """A hypothesis that holds now, what it stands on, and what speaks for and against it."""

    value: M
    supports: Sequence[Entry[Any] | Support]
    reasons: Sequence[Reason] = ()


class StandingHypotheses(Generic[M]):
    """The hypotheses of one kind that a source keeps; `differs` says when a change is worth a revision.

    With `verdicts`, what their reasons amount to stands on the board too.
    """

    def __init__(self, kind: Kind[M], differs: Callable[[M, M], bool], verdicts: Verdicts | None = None) -> None:
        self._kind = kind
        self._differs = differs
        self._verdicts = verdicts
        self._kept: dict[str, None] = {}  # ids

    def resume(self, board: Access) -> list[Entry[M]]:
        """After a restart: keep what stands by this source, whether it remembers it or not; return that."""
        own = board.own(self._kind)
        self._kept = dict.fromkeys(str(entry.id) for entry in own)
        if self._verdicts is not None:
            self._verdicts.resume(board, self._kind)
        return own

    def keep(self, board: Access, found: Mapping[str, Found[M]], gone: Callable[[M], str]) -> None:
        """Make what stands on the board what was found; what is not found any more is endorsed against, then retracted."""
        for id_ in [i for i in self._kept if i not in found]:
            entry = board.newest(self._kind, id_)
            if entry is not None:
                entry = give(board, entry, [Reason(gone(entry.value), verdict="against", strength="strong")])
                if self._verdicts is not None:
                    self._verdicts.judge(board, entry)
                    self._verdicts.close(board, entry)
                board.retract(self._kind, id_)
            del self._kept[id_]
        for id_, new in found.items():
            standing = board.newest(self._kind, id_)
            if standing is None or self._differs(standing.value, new.value):
                standing = board.post(self._kind, new.value, id=id_, supports=new.supports)
            standing = give(board, standing, new.reasons)
            if self._verdicts is not None:
                self._verdicts.judge(board, standing)
            self._kept[id_] = None


class Episodes(Generic[M]):
    """A hypothesis of which one holds at a time or none: each time that it comes to hold again it is another, `<name>-<number>`."""

    def __init__(self, kind: Kind[M], name: str) -> None:
        self._standing = StandingHypotheses(kind, _stays)
        self._kind = kind
        self._name = name
        self._number = 0
        self._holds = False

    def resume(self, board: Access) -> None:
        """After a restart: go on with what stands, and number on above what stood."""
        self._number = max(self._number, board.last_number(self._kind, f"{self._name}-"))
        self._holds = any(entry.id == f"{self._name}-{self._number}" for entry in self._standing.resume(board))

    def keep(self, board: Access, found: Found[M] | None, gone: str) -> None:
        """Post the hypothesis where it has come to hold; where it holds no more, retract it for the reason `gone`."""
        if found is not None and not self._holds:
            self._number += 1
        self._holds = found is not None
        self._standing.keep(board, {} if found is None else {f"{self._name}-{self._number}": found}, lambda _: gone)


def _stays(first: Message, now: Message) -> bool:
    """Within an episode the first value stays."""
    return False


def give(board: Access, entry: Entry[M], reasons: Sequence[Reason]) -> Entry[M]:
    """Make what this source says of a hypothesis just these reasons: said where they are new, withdrawn where they hold no more."""
    said = {e.about: e for e in standing(entry.endorsements) if e.who == board.name}
    wanted = {reason.about: reason for reason in reasons}
    for about in said:
        if about not in wanted:
            entry = board.withdraw(entry, about, "it does not hold any more")
    for about, reason in wanted.items():
        last = said.get(about)
        if last is None or (last.verdict, last.why, last.strength) != (reason.verdict, reason.why, reason.strength):
            entry = board.endorse(entry, reason.verdict, reason.why, about=about, strength=reason.strength)
    return entry


class Names:
    """Names for places that are found again and again: the nearest within `reach_m` keeps its name, a new one gets the next.

    What is `anchored` is compared with where it was first: a place that wanders off does not take its name along.
    """

    def __init__(self, prefix: str, reach_m: float, *, anchored: bool = False) -> None:
        self._prefix = prefix
        self._reach_m = reach_m
        self._anchored = anchored
        self._places: dict[str, tuple[float, float]] = {}
        self._next = 1

    def resume(self, standing: Mapping[str, tuple[float, float]], last: int) -> None:
        """After a restart: the names that stand are those given, and numbers go on above the last one that was."""
        self._places = {name: self._places.get(name, place) for name, place in standing.items()}
        self._next = max(self._next, last + 1)

    def name(self, places: Sequence[tuple[float, float]]) -> list[str]:
        """Return a name for each place; names of places not among them are given up."""
        pairs = sorted(
            (distance, name, i)
            for name, old in self._places.items()
            for i, place in enumerate(places)
            if (distance := hypot(place[0] - old[0], place[1] - old[1])) <= self._reach_m
        )
        names: dict[int, str] = {}
        taken: dict[str, None] = {}
        for _, name, i in pairs:
            if i not in names and name not in taken:
                names[i] = name
                taken[name] = None
        for i in range(len(places)):
            if i not in names:
                names[i] = f"{self._prefix}-{self._next}"
                self._next += 1
        first = self._places if self._anchored else {}
        self._places = {names[i]: first.get(names[i], place) for i, place in enumerate(places)}
        return [names[i] for i in range(len(places))]
