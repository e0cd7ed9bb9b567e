"""What comes on a board, as a table: each key with its kind, source, rate, age and size.

Ages are told on the mission's clock, which is read off the stamps themselves: it stands no earlier than the newest of them, and
goes on from there as real time does.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from blackboard.errors import BoardError, MessageError
from blackboard.kinds import Kind
from blackboard.link.envelope import read_origin
from blackboard.parameters import require
from blackboard.vocabulary import Vocabulary
from blackboard.watching.summary import SeenEntry, printable, read_entry


@dataclass(frozen=True, slots=True, kw_only=True)
class TableParams:
    """How rates are taken."""

    window_s: float = 5.0  # rates are those of the last so many seconds: some 50 entries of a 10 Hz stream
    arrivals: int = 2000  # remembered of one key; of a faster stream the rate is that of the newest so many

    def __post_init__(self) -> None:
        require(0.1 <= self.window_s <= 3600.0, "window_s", self.window_s, "[0.1, 3600] seconds")
        require(2 <= self.arrivals <= 1_000_000, "arrivals", self.arrivals, "[2, 1000000]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One key, or all members of a collection together (`members` of them, the key ending in `*`)."""

    key: str
    type: str  # of the values; empty where the key is of no known kind
    source: str
    host: str  # that sent it; empty where nobody said
    rate_hz: float
    age_s: float | None  # of the newest; None of what bears no stamp
    size_bytes: int
    members: int = 1

    def as_dict(self) -> dict[str, Any]:
        """Return the same as plain data, for JSON."""
        return {name: getattr(self, name) for name in self.__slots__}


@dataclass(slots=True)
class _Seen:
    """What is known of one key."""

    kind: Kind[Any] | None
    source: str = ""
    host: str = ""
    stamp_s: float | None = None
    revision: int = -1
    size_bytes: int = 0
    arrivals: deque[float] = field(default_factory=deque)


class Traffic:
    """Takes note of what comes, and of what stood before."""

    def __init__(self, vocabulary: Vocabulary, params: TableParams | None = None, *, began_s: float) -> None:
        """Begin at `began_s`, on the watcher's own clock, as all times here that are no stamps."""
        self._vocabulary = vocabulary
        self._params = params or TableParams()
        self._began_s = began_s
        self._seen: dict[str, _Seen] = {}
        self._newest: tuple[float, float] | None = None  # stamp, and when it came
        self.entries = 0

    def came(self, key: str, payload: bytes, attachment: bytes, at_s: float) -> None:
        """Take note of what came just now."""
        self.entries += 1
        entry = self._note(key, payload, attachment, at_s)
        if entry is not None and entry.event == "retracted":
            self._seen.pop(key, None)
            return
        seen = self._seen[key]
        seen.arrivals.append(at_s)
        if len(seen.arrivals) > self._params.arrivals:
            seen.arrivals.popleft()

    def stood(self, key: str, payload: bytes, attachment: bytes, at_s: float) -> None:
        """Take note of what stood before anything came; what has come since is newer."""
        if key not in self._seen:
            self._note(key, payload, attachment, at_s)

    def clock_s(self, at_s: float) -> float | None:
        """Return the mission's clock as far as it can be told; None before the first stamp."""
        return None if self._newest is None else self._newest[0] + at_s - self._newest[1]

    def rate_hz(self, at_s: float) -> float:
        """Return how many entries come in a second, all together."""
        return sum(self._rate_hz(seen, at_s) for seen in self._seen.values())

    def rows(self, at_s: float, *, fold_from: int | None = None) -> list[Row]:
        """Return a row for each key, in key order; collections of at least `fold_from` members have one together."""
        groups: dict[str, list[tuple[str, _Seen]]] = {}
        for key, seen in self._seen.items():
            collected = seen.kind is not None and seen.kind.collection
            groups.setdefault(key.rsplit("/", 1)[0] + "/*" if collected else key, []).append((key, seen))
        rows = []
        for name, group in groups.items():
            if fold_from is not None and len(group) >= fold_from:
                rows.append(self._row(name, [seen for _, seen in group], at_s))
            else:
                rows += [self._row(key, [seen], at_s) for key, seen in group]
        return sorted(rows, key=lambda row: row.key)

    def _note(self, key: str, payload: bytes, attachment: bytes, at_s: float) -> SeenEntry | None:
        seen = self._seen.get(key)
        if seen is None:
            seen = self._seen[key] = _Seen(self._kind(key))
        entry = read_entry(payload)
        seen.host, seen.size_bytes = _host(attachment), len(payload)
        if entry is not None:
            seen.source, seen.stamp_s = printable(entry.source), entry.stamp_s
            clock_s = self.clock_s(at_s)
            if clock_s is None or entry.stamp_s > clock_s:
                self._newest = (entry.stamp_s, at_s)
        return entry

    def _kind(self, key: str) -> Kind[Any] | None:
        try:
            return self._vocabulary.parse_key(key)[1]
        except BoardError:
            return None

    def _rate_hz(self, seen: _Seen, at_s: float) -> float:
        window_s = min(self._params.window_s, at_s - self._began_s)
        while seen.arrivals and seen.arrivals[0] < at_s - window_s:
            seen.arrivals.popleft()
        if len(seen.arrivals) == self._params.arrivals:
            window_s = at_s - seen.arrivals[0]
        return len(seen.arrivals) / window_s if window_s > 0 else 0.0

    def _row(self, key: str, group: list[_Seen], at_s: float) -> Row:
        clock_s = self.clock_s(at_s)
        stamps = [seen.stamp_s for seen in group if seen.stamp_s is not None]
        kind = group[0].kind
        return Row(
            key=printable(key),
            type=kind.type.__name__ if kind is not None else "",
            source=_one_of(seen.source for seen in group),
            host=_one_of(seen.host for seen in group),
            rate_hz=sum(self._rate_hz(seen, at_s) for seen in group),
            age_s=max(0.0, clock_s - max(stamps)) if clock_s is not None and stamps else None,
            size_bytes=sum(seen.size_bytes for seen in group),
            members=len(group),
        )


def _host(attachment: bytes) -> str:
    try:
        return read_origin(attachment).host
    except MessageError:
        return ""


def _one_of(names: Iterable[str]) -> str:
    found = sorted(set(names) - {""})
    return found[0] if len(found) == 1 else f"{len(found)} of them" if found else ""
