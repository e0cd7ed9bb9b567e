"""Pure functions on revisions of entries: the next one, whether one lies in an area and a time."""

from typing import Any

from blackboard.entry import Endorsement, Entry, Event
from blackboard.uncertainty.endorsements import standing as still_standing

Area = tuple[float, float, float, float]


def within(entry: Entry[Any], area: Area | None, since_s: float | None, until_s: float | None) -> bool:
    """Say whether an entry lies within an area (x_min, y_min, x_max, y_max; m, map frame) and between two stamps."""
    if (since_s is not None and entry.stamp_s < since_s) or (until_s is not None and entry.stamp_s > until_s):
        return False
    if area is None:
        return True
    extent = entry.value.extent()
    return extent is not None and (
        extent[0] <= area[2] and extent[2] >= area[0] and extent[1] <= area[3] and extent[3] >= area[1]
    )


def without_oldest(endorsements: tuple[Endorsement, ...]) -> tuple[Endorsement, ...]:
    """Return all but the oldest that does not stand any more; the record still has it."""
    stands = still_standing(endorsements)
    oldest = next((i for i, e in enumerate(endorsements) if e not in stands), 0)
    return endorsements[:oldest] + endorsements[oldest + 1 :]


def next_revision(
    entry: Entry[Any], *, event: Event, stamp_s: float, source: str, added: tuple[Endorsement, ...] = ()
) -> Entry[Any]:
    """Return the revision that follows an entry with the same value, with what was `added` to the reasons for and against."""
    return Entry(
        key=entry.key,
        id=entry.id,
        revision=entry.revision + 1,
        event=event,
        stamp_s=stamp_s,
        source=source,
        value=entry.value,
        supports=entry.supports,
        endorsements=entry.endorsements + added,
        value_from=(entry.value_from or (entry.revision, entry.stamp_s)) if added else None,
    )
