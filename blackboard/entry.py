"""What stands on the board: an entry with its value, what it was derived from, and what was said for and against it."""

from collections.abc import Iterable
from typing import Annotated, Generic, Literal, TypeVar

from msgspec import Meta, Struct

from blackboard.messages.base import Count, Message, Name, Seconds, Text

M = TypeVar("M", bound=Message)

Event = Literal["posted", "revised", "retracted"]
Verdict = Literal["for", "against", "withdrawn"]
Strength = Literal["weak", "fair", "strong"]


class Support(Struct, frozen=True, forbid_unknown_fields=True):
    """A stretch of one key's revisions that an entry was derived from, both ends included."""

    key: Name
    first: Count
    last: Count


class Endorsement(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A reason for or against an entry: who gives it, and why (after Cohen, as in Bou-Ghannam 1992, section 2.5.3.6).

    `about` tells the reasons of one endorser apart: a new word about the same takes the place of the last one, and "withdrawn"
    takes that back without another in its place. `strength` is a class and not a number; each theory makes of it what it needs.
    """

    who: Name
    verdict: Verdict
    why: Text
    stamp_s: Seconds
    about: Annotated[str, Meta(max_length=200)] = ""
    strength: Strength = "fair"


class Entry(Struct, Generic[M], frozen=True, kw_only=True, eq=False):
    """One revision of a key. A retraction keeps the last value, so that what was believed can still be read.

    `value_from` tells revision and stamp of the post that brought the value, where this revision only adds an endorsement.
    """

    key: str
    id: str | None
    revision: int
    event: Event
    stamp_s: float
    source: str
    value: M
    supports: tuple[Support, ...] = ()
    endorsements: tuple[Endorsement, ...] = ()
    value_from: tuple[int, float] | None = None

    def as_support(self) -> Support:
        """Return the stretch that is just this revision."""
        return Support(self.key, self.revision, self.revision)


class EntryRecord(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The JSON form of an entry around its value: one line of `board.jsonl`, and what travels to other machines."""

    key: Name
    revision: Count
    event: Event
    stamp_s: Seconds
    source: Name
    supports: Annotated[tuple[Support, ...], Meta(max_length=10_000)] = ()
    endorsements: Annotated[tuple[Endorsement, ...], Meta(max_length=1000)] = ()
    value_from: tuple[Count, Seconds] | None = None


def stretches(entries: Iterable[Entry[Message]]) -> tuple[Support, ...]:
    """Return supports that name these entries, revisions of one key that follow each other joined to one stretch."""
    joined: dict[str, list[Support]] = {}
    for entry in entries:
        runs = joined.setdefault(entry.key, [])
        if runs and runs[-1].first <= entry.revision <= runs[-1].last + 1:
            runs[-1] = Support(entry.key, runs[-1].first, max(runs[-1].last, entry.revision))
        else:
            runs.append(entry.as_support())
    return tuple(run for runs in joined.values() for run in runs)
