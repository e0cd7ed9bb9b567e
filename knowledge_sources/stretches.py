"""What a source that integrates streams stands on: one stretch of revisions for each key, however many there were."""

from collections.abc import Iterable
from typing import Any

from blackboard.entry import Entry, Support


class Stretches:
    """The first and the last revision of every key that was added."""

    def __init__(self) -> None:
        self._supports: dict[str, Support] = {}

    def add(self, entries: Iterable[Entry[Any]]) -> None:
        """Widen the stretches by these entries."""
        for entry in entries:
            self._widen(entry.key, entry.revision, entry.revision)

    def merge(self, supports: Iterable[Support]) -> None:
        """Widen the stretches by others."""
        for support in supports:
            self._widen(support.key, support.first, support.last)

    def supports(self) -> list[Support]:
        """Return the stretches, in the order in which their keys were first added."""
        return list(self._supports.values())

    def clear(self) -> None:
        """Forget all."""
        self._supports.clear()

    def _widen(self, key: str, first: int, last: int) -> None:
        known = self._supports.get(key)
        if known is None:
            self._supports[key] = Support(key, first, last)
        elif first < known.first or last > known.last:
            self._supports[key] = Support(key, min(first, known.first), max(last, known.last))
