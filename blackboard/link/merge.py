"""Two revisions of one key become one, the same on every replica, in whatever order they come.

The value is that of the latest post: by the stamp of the post that brought the value, then by its revision. What was said for and
against is united; what was said before the entry was last retracted belongs to an earlier life of it and is dropped. Merging is
commutative, associative and idempotent.
"""

from typing import Any

import msgspec
from msgspec.structs import replace

from blackboard.entry import Endorsement, Entry

NEVER = float("-inf")
_ENCODE = msgspec.json.Encoder().encode


def merged(known: Entry[Any] | None, come: Entry[Any], life_s: float = NEVER) -> Entry[Any]:
    """Return what stands after `come` met `known` (None: nothing known of the key); `known` itself where nothing changes.

    `life_s` is the stamp of the latest retraction that was ever seen of the key.
    """
    if known is None:
        said = _of_this_life(come.endorsements, life_s)
        return come if said == come.endorsements else replace(come, endorsements=said)
    if (
        come.stamp_s > known.stamp_s
        and come.revision > known.revision
        and come.value_from is None
        and (come.endorsements == known.endorsements or not known.endorsements)
        and life_s == NEVER
    ):
        return come  # as nearly always
    wins = _order(come) > _order(known) or (_order(come) == _order(known) and _content(come) > _content(known))
    winner = come if wins else known
    said = _of_this_life(_united(known.endorsements, come.endorsements), life_s)
    revision, stamp_s = max(known.revision, come.revision), max(known.stamp_s, come.stamp_s)
    if winner.endorsements == said and winner.revision == revision and winner.stamp_s == stamp_s:
        return winner
    value_from: tuple[int, float] | None = winner.value_from or (winner.revision, winner.stamp_s)
    if value_from == (revision, stamp_s):
        value_from = None
    return replace(winner, endorsements=said, revision=revision, stamp_s=stamp_s, value_from=value_from)


def life_of(known_life_s: float, come: Entry[Any]) -> float:
    """Return the stamp of the latest retraction, after `come` has come."""
    return max(known_life_s, retracted_s(come)) if come.event == "retracted" else known_life_s


def retracted_s(gone: Entry[Any] | None) -> float:
    """Return the stamp of a retraction itself, whatever it was merged with; None: there never was one."""
    return NEVER if gone is None else _order(gone)[0]


def _order(entry: Entry[Any]) -> tuple[float, int, bool]:
    revision, stamp_s = entry.value_from or (entry.revision, entry.stamp_s)
    return stamp_s, revision, entry.event == "retracted"


def _content(entry: Entry[Any]) -> tuple[str, str, bytes]:
    """Return what decides between two posts of one revision and stamp: two processes both took themselves for the owner."""
    return entry.source, entry.event, _ENCODE((entry.value, entry.supports))


def _united(one: tuple[Endorsement, ...], other: tuple[Endorsement, ...]) -> tuple[Endorsement, ...]:
    if one == other or not other:
        return one
    if not one:
        return other
    both = [*one, *(e for e in other if e not in one)]
    return tuple(sorted(both, key=_said_when))


def _said_when(said: Endorsement) -> tuple[float, str, str, str, str, str]:
    # at one instant: first what was said, then its withdrawal
    return (
        said.stamp_s,
        said.who,
        said.about,
        "~" if said.verdict == "withdrawn" else said.verdict,
        said.strength,
        said.why,
    )


def _of_this_life(said: tuple[Endorsement, ...], life_s: float) -> tuple[Endorsement, ...]:
    if life_s == NEVER or all(e.stamp_s >= life_s for e in said):
        return said
    return tuple(e for e in said if e.stamp_s >= life_s)
