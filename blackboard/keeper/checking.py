"""Everything that comes in is looked at before anything is done with it: is it an entry of this board, whole and within bounds?

What is refused is counted by reason and told once for each reason and sender; the keeper lives on.
"""

from collections import Counter
from typing import Any, NamedTuple

import msgspec

from blackboard.entry import Entry
from blackboard.errors import BoardError, MessageError
from blackboard.link.addresses import place_of
from blackboard.link.envelope import Origin, read_entry, read_payload
from blackboard.link.lanes import Lane, lane_of, lane_of_place
from blackboard.vocabulary import Vocabulary

MAX_TOLD = 1000  # refusals told one by one
_NEWLINE, _BRACE = b"\n", ord("}")


class Checked(NamedTuple):
    """An envelope that may stand on the board."""

    origin: Origin
    payload: bytes
    entry: Entry[Any]


class Refused(Exception):
    """An envelope that may not, and why; `origin` is None where even that cannot be read."""

    def __init__(self, reason: str, text: str, origin: Origin | None) -> None:
        super().__init__(text)
        self.reason = reason
        self.origin = origin


class Checker:
    """Checks envelopes against a vocabulary."""

    def __init__(self, vocabulary: Vocabulary, entry_bytes: int) -> None:
        self.vocabulary = vocabulary
        self._limit = entry_bytes

    def check(self, key: str, payload: bytes, origin: Origin) -> Checked:
        """Return what came under a key as an entry; raise Refused where it is none."""
        if len(payload) > self._limit:
            raise Refused("size", f"{key}: {len(payload)} bytes, the limit is {self._limit}", origin)
        if not payload or payload[-1] != _BRACE or _NEWLINE in payload:
            raise Refused("form", f"{key}: an entry is one JSON object on one line", origin)
        try:
            line = read_payload(key, payload)
        except MessageError as error:
            raise Refused("form", str(error), origin) from None
        try:
            kind, entry = read_entry(self.vocabulary, line)
        except BoardError as error:
            raise Refused("kind", str(error), origin) from None
        except MessageError as error:
            raise Refused("value", str(error), origin) from None
        if lane_of(kind) != origin.lane:
            raise Refused("lane", f"{key}: belongs to lane {lane_of(kind)}, came in lane {origin.lane}", origin)
        return Checked(origin, payload, entry)


class _Keyed(msgspec.Struct):
    key: str


_KEYED = msgspec.json.Decoder(_Keyed)


def key_of(payload: bytes) -> str:
    """Return the key that a payload says it is for; raise MessageError where it says none."""
    try:
        return _KEYED.decode(payload).key
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise MessageError(f"not an entry of a board ({error})") from None


def lanes_at(key: str) -> tuple[Lane, ...]:
    """Return the lanes in which what stands at a key may travel, whether the key is of a known kind or not."""
    return (lane_of_place(place_of(key)), "large")


class Refusals:
    """How many were refused, by reason, and what is still to be told."""

    def __init__(self) -> None:
        self.by_reason: Counter[str] = Counter()
        self.examples: dict[str, str] = {}  # the newest of each reason
        self._told: set[tuple[str, str]] = set()

    def note(self, reason: str, text: str, sender: str) -> str | None:
        """Count a refusal; return the line to tell, None where this sender's fault has been told."""
        self.by_reason[reason] += 1
        self.examples[reason] = text[:500]
        if (reason, sender) in self._told or len(self._told) >= MAX_TOLD:
            return None
        self._told.add((reason, sender))
        return f"refused ({reason}) from {sender}: {text[:500]}; more of the same are only counted"
