"""How long the board remembers: enough to explain what still stands, and never more than a bound.

Kept are
- the newest revisions of every key (`slot_revisions` of a slot, `member_revisions` of a member of a collection);
- beyond them, each revision that a kept entry names as an end of a support, and so on down to the readings; it goes when
  nothing kept names it any more (inner revisions of a stretch are counted by the support and stand in `board.jsonl`);
- at most `pinned_limit` of those; past it the oldest go first;
- the keys retracted last, `retired_limit` of them.
"""

from collections import OrderedDict, deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from blackboard.entry import Entry, Support
from blackboard.parameters import require


@dataclass(frozen=True, slots=True, kw_only=True)
class HistoryParams:
    """Bounds on what the board remembers."""

    slot_revisions: int = 600  # a minute of a 10 Hz stream
    member_revisions: int = 8  # a collection has many members, and they change seldom
    pinned_limit: int = 20_000  # older entries kept as supports: some 20 MB
    retired_limit: int = 1000  # retracted keys that can still be asked why

    def __post_init__(self) -> None:
        for name in ("slot_revisions", "member_revisions", "pinned_limit", "retired_limit"):
            require(getattr(self, name) >= 1, name, getattr(self, name), "1 and more")


class History:
    """Old revisions by key, with those that supports name pinned."""

    def __init__(self, params: HistoryParams) -> None:
        self.params = params
        self._recent: dict[str, deque[Entry[Any]]] = {}
        self._pins: dict[tuple[str, int], int] = {}
        self._pinned: OrderedDict[tuple[str, int], Entry[Any]] = OrderedDict()
        self._retired: OrderedDict[str, None] = OrderedDict()

    def add(self, entry: Entry[Any], *, member: bool) -> None:
        """Remember a new revision, and let go of what falls out of the bounds."""
        recent = self._recent.get(entry.key)
        if recent is None:
            recent = self._recent[entry.key] = deque()
        recent.append(entry)
        pins = self._pins
        for support in entry.supports:
            end = (support.key, support.last)
            pins[end] = pins.get(end, 0) + 1
            if support.first != support.last:
                start = (support.key, support.first)
                pins[start] = pins.get(start, 0) + 1
        if len(recent) > (self.params.member_revisions if member else self.params.slot_revisions):
            self._evict(recent.popleft())
        if entry.event == "retracted":
            self._retire(entry.key)
        elif self._retired and entry.key in self._retired:
            del self._retired[entry.key]

    @property
    def retired(self) -> list[str]:
        """The keys retracted last, oldest first."""
        return list(self._retired)

    def last_revision(self, key: str) -> int:
        """Return the number of the newest revision remembered, 0 for none."""
        recent = self._recent.get(key)
        return recent[-1].revision if recent else 0

    def revisions(self, support: Support) -> list[Entry[Any]]:
        """Return the revisions of a stretch that are still remembered, oldest first."""
        recent = self._recent.get(support.key, ())
        found = {e.revision: e for e in recent if support.first <= e.revision <= support.last}
        for revision in (support.first, support.last):
            pinned = self._pinned.get((support.key, revision))
            if pinned is not None:
                found[revision] = pinned
        return [found[revision] for revision in sorted(found)]

    def around(self, key: str, stamp_s: float) -> tuple[Entry[Any] | None, Entry[Any] | None]:
        """Return the newest recent revision at or before `stamp_s`, and the one after it."""
        after: Entry[Any] | None = None
        for entry in reversed(self._recent.get(key, ())):
            if entry.stamp_s <= stamp_s:
                return entry, after
            after = entry
        return None, after

    def recent(self, key: str) -> Iterator[Entry[Any]]:
        """Yield the recent revisions of a key, oldest first."""
        yield from self._recent.get(key, ())

    def __len__(self) -> int:
        return sum(len(recent) for recent in self._recent.values()) + len(self._pinned)

    def _retire(self, key: str) -> None:
        self._retired[key] = None
        self._retired.move_to_end(key)
        while len(self._retired) > self.params.retired_limit:
            oldest, _ = self._retired.popitem(last=False)
            for entry in self._recent.pop(oldest):
                self._evict(entry)

    def _evict(self, entry: Entry[Any]) -> None:
        if self._pins.get((entry.key, entry.revision)):
            self._pinned[(entry.key, entry.revision)] = entry
            if len(self._pinned) > self.params.pinned_limit:
                self._release(self._pinned.popitem(last=False)[1])
        else:
            self._release(entry)

    def _release(self, entry: Entry[Any]) -> None:
        gone = [entry]
        while gone:
            for support in gone.pop().supports:
                ends = (support.last,) if support.first == support.last else (support.first, support.last)
                for revision in ends:
                    name = (support.key, revision)
                    left = self._pins.get(name, 1) - 1
                    if left:
                        self._pins[name] = left
                        continue
                    self._pins.pop(name, None)
                    unpinned = self._pinned.pop(name, None)
                    if unpinned is not None:
                        gone.append(unpinned)
