"""Which lines were in view and not seen: counted by line, forgotten when it is seen again."""

from collections import Counter
from collections.abc import Collection, Iterable


class Missed:
    """How many batches in a row each line was missing from, though it was in view."""

    def __init__(self) -> None:
        self._times: dict[str, int] = {}

    def note(self, views: Iterable[Collection[str]], least_views: int, seen: Collection[str]) -> list[tuple[str, int]]:
        """Take note of a batch; return the lines that were missing from it and how often in a row, in order of first view.

        `views` are the ids expected from each place on the way; a line is missing that was expected from `least_views` of
        them and is not among those seen.
        """
        expected = Counter(id_ for view in views for id_ in view)
        for id_ in seen:
            self._times.pop(id_, None)
        missing = []
        for id_, count in expected.items():
            if count >= least_views and id_ not in seen:
                self._times[id_] = self._times.get(id_, 0) + 1
                missing.append((id_, self._times[id_]))
        return missing

    def forget(self, id_: str) -> None:
        """Drop a line that no longer stands."""
        self._times.pop(id_, None)
