"""The newest envelopes of a lane, for readers that missed some."""

from collections import OrderedDict
from collections.abc import Iterator

from blackboard.link.envelope import Envelope, Origin


class Ring:
    """At most so many envelopes and so many bytes; the first that came go first."""

    def __init__(self, envelopes: int, size_bytes: int) -> None:
        self._limit = envelopes
        self._limit_bytes = size_bytes
        self._held: OrderedDict[Origin, bytes] = OrderedDict()  # in order of coming
        self._bytes = 0

    def add(self, origin: Origin, payload: bytes) -> None:
        """Hold an envelope."""
        self._held[origin] = payload
        self._bytes += len(payload)
        while len(self._held) > self._limit or (self._bytes > self._limit_bytes and len(self._held) > 1):
            self._bytes -= len(self._held.popitem(last=False)[1])

    def between(self, host: str, boot: str, lane: str, first: int, last: int) -> Iterator[Envelope]:
        """Yield those of a lane's envelopes from `first` to `last` that are held, in order."""
        if last - first > len(self._held):
            numbers = sorted(o.number for o in self._held if o[:3] == (host, boot, lane) and first <= o.number <= last)
        else:
            numbers = list(range(first, last + 1))
        for number in numbers:
            origin = Origin(host, boot, lane, number)  # type: ignore[arg-type]
            payload = self._held.get(origin)
            if payload is not None:
                yield Envelope(origin, payload)

    def __len__(self) -> int:
        return len(self._held)

    @property
    def size_bytes(self) -> int:
        """How many bytes the payloads have."""
        return self._bytes
