"""What stands on one robot's board, as it came over the wire, merged like on every replica."""

from collections import OrderedDict
from collections.abc import Iterator
from typing import Any

import msgspec

from blackboard.entry import Entry
from blackboard.journal import line_of
from blackboard.keeper.checking import key_of
from blackboard.key_expressions import matches
from blackboard.link.envelope import Envelope, Origin, read_entry, read_payload
from blackboard.link.merge import life_of, merged, retracted_s
from blackboard.vocabulary import Vocabulary


class Held:
    """One revision as it came, with what tells whether another one is newer. Its value is decoded only where words meet."""

    __slots__ = ("origin", "payload", "plain", "revision", "stamp_s")

    def __init__(self, origin: Origin, payload: bytes, entry: Entry[Any]) -> None:
        self.origin = origin
        self.payload = payload
        self.stamp_s = entry.stamp_s
        self.revision = entry.revision
        self.plain = not entry.endorsements and entry.value_from is None and entry.event != "retracted"


class Standing:
    """Entries and retractions by key. In whatever order envelopes come, the same stands in the end."""

    def __init__(self, vocabulary: Vocabulary, tombstones: int) -> None:
        self._vocabulary = vocabulary
        self._limit = tombstones
        self._standing: dict[str, Held] = {}
        self._gone: OrderedDict[str, Held] = OrderedDict()

    def take(self, origin: Origin, payload: bytes, entry: Entry[Any]) -> None:
        """Take in an envelope whose entry was checked."""
        known = self._standing.get(entry.key)
        come = Held(origin, payload, entry)
        if come.plain and entry.key not in self._gone and (known is None or _plainly_newer(come, known)):
            self._standing[entry.key] = come
            return
        self._merge(come, entry, known)

    def _merge(self, come: Held, entry: Entry[Any], known: Held | None) -> None:
        gone = self._gone.get(entry.key)
        gone_entry = self._entry(gone) if gone is not None else None
        known_entry = self._entry(known) if known is not None else gone_entry
        result = merged(known_entry, entry, life_of(retracted_s(gone_entry), entry))
        if entry.event == "retracted":
            self._bury(entry.key, self._held(merged(gone_entry, entry), come, entry, gone, gone_entry))
        if result is known_entry:
            return
        if result.event == "retracted":
            self._standing.pop(entry.key, None)
            self._bury(entry.key, self._held(result, come, entry, known or gone, known_entry))
        else:
            self._standing[entry.key] = self._held(result, come, entry, known, known_entry)

    def entries(self) -> list[Envelope]:
        """Return what stands, in order of first posting."""
        return [Envelope(held.origin, held.payload) for held in self._standing.values()]

    def matching(self, expression: str) -> Iterator[tuple[str, Envelope]]:
        """Yield the keys that the expression matches, with what stands there."""
        if "*" not in expression:
            exact = self._standing.get(expression)
            found = [(expression, exact)] if exact is not None else []
        else:
            found = [(key, held) for key, held in self._standing.items() if matches(expression, key)]
        for key, held in found:
            yield key, Envelope(held.origin, held.payload)

    def tombstones(self) -> list[Envelope]:
        """Return the retractions that are remembered, the oldest first."""
        return [Envelope(held.origin, held.payload) for held in self._gone.values()]

    def __len__(self) -> int:
        return len(self._standing)

    def _entry(self, held: Held) -> Entry[Any]:
        return read_entry(self._vocabulary, read_payload(key_of(held.payload), held.payload))[1]

    def _held(
        self, result: Entry[Any], come: Held, entry: Entry[Any], known: Held | None, was: Entry[Any] | None
    ) -> Held:
        if result is entry:
            return come
        if known is not None and result is was:
            return known
        raw = msgspec.json.encode(result.value)
        return Held(come.origin, line_of(result, raw), result)

    def _bury(self, key: str, held: Held) -> None:
        self._gone[key] = held
        self._gone.move_to_end(key)
        while len(self._gone) > self._limit:
            self._gone.popitem(last=False)


def _plainly_newer(come: Held, known: Held) -> bool:
    return known.plain and come.stamp_s >= known.stamp_s and come.revision > known.revision
