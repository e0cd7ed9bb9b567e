"""The form in which entries travel: a payload that a person can read, and beside it who sent it and which one it is.

The payload is one JSON object, the same as a line of `board.jsonl`: key, revision, event, stamp_s, source, value, supports,
endorsements. The attachment is ASCII: `host boot lane sequence`, numbered from 1 for each host, boot and lane. A batch is a
text with one envelope on each line, attachment and payload parted by a tab.
"""

from collections.abc import Iterable
from functools import lru_cache
from typing import Any, NamedTuple, TypeVar

import msgspec

from blackboard.entry import Entry
from blackboard.errors import BoardError, MessageError
from blackboard.journal import JournalLine
from blackboard.key_expressions import is_chunk
from blackboard.kinds import Kind
from blackboard.link.lanes import LANES, Lane
from blackboard.vocabulary import MAX_MESSAGE_BYTES, Vocabulary, decode

T = TypeVar("T")

_LINE = msgspec.json.Decoder(JournalLine)
_LANES = {lane.encode(): lane for lane in LANES}
MAX_NAME = 200
MAX_NUMBER = 2**53


class Origin(NamedTuple):
    """Who sent an envelope: a host, the boot of it (each start is another), the lane, and the number there, from 1."""

    host: str
    boot: str
    lane: Lane
    number: int


class Envelope(NamedTuple):
    """An entry on its way."""

    origin: Origin
    payload: bytes


def attachment_of(origin: Origin) -> bytes:
    """Return an origin as it travels."""
    return b"%s %s %s %d" % (origin.host.encode(), origin.boot.encode(), origin.lane.encode(), origin.number)


def read_origin(attachment: bytes) -> Origin:
    """Return the origin that an attachment tells; raise MessageError where it tells none."""
    parts = attachment.split(b" ")
    lane = _LANES.get(parts[2]) if len(parts) == 4 else None
    if lane is None or not parts[3].isdigit() or len(parts[3]) > 16 or max(len(parts[0]), len(parts[1])) > MAX_NAME:
        raise MessageError(f"attachment {attachment[:80]!r}: must be 'host boot lane number'")
    host, boot, number = _name(parts[0]), _name(parts[1]), int(parts[3])
    if not 1 <= number <= MAX_NUMBER:
        raise MessageError(f"attachment {attachment[:80]!r}: numbers begin with 1")
    return Origin(host, boot, lane, number)


@lru_cache(maxsize=1000)
def _name(text: bytes) -> str:
    """Return the name of a host or boot; raise MessageError where it is none."""
    name = text.decode("ascii", "replace")
    if not is_chunk(name):
        raise MessageError(f"attachment names {text[:80]!r}: host and boot are letters, digits, '_', '-' and '.'")
    return name


def read_payload(key: str | None, payload: bytes) -> JournalLine:
    """Return what a payload that came under `key` (None: in a batch) says, its value still JSON.

    Raises MessageError where it is not an entry, or one of another key.
    """
    if len(payload) > MAX_MESSAGE_BYTES:
        raise MessageError(
            f"{key or 'an envelope'}: the message has {len(payload)} bytes, the limit is {MAX_MESSAGE_BYTES}"
        )
    try:
        line = _LINE.decode(payload)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise MessageError(f"{key or 'an envelope'}: not an entry of a board ({error})") from None
    if key is not None and line.key != key:
        raise MessageError(f"{key}: the message says that it is for {line.key}")
    if line.origin is not None:
        raise MessageError(f"{key}: an origin stands in keepers' journals only; drop 'origin'")
    return line


def read_entry(vocabulary: Vocabulary, line: JournalLine) -> tuple[Kind[Any], Entry[Any]]:
    """Return a line's kind and its entry with its value checked; raise MessageError or BoardError where it is unfit."""
    _, kind, member = vocabulary.parse_key(line.key)
    return kind, Entry(
        key=line.key,
        id=member,
        revision=line.revision,
        event=line.event,
        stamp_s=line.stamp_s,
        source=line.source,
        value=decode(kind, line.key, bytes(line.value)),
        supports=line.supports,
        endorsements=line.endorsements,
        value_from=line.value_from,
    )


def join_batch(envelopes: Iterable[Envelope]) -> bytes:
    """Return envelopes as one text."""
    return b"".join(b"%s\t%s\n" % (attachment_of(e.origin), e.payload) for e in envelopes)


def split_batch(batch: bytes) -> list[Envelope]:
    """Return the envelopes of a text; raise MessageError where it is none. Payloads are not looked at."""
    envelopes = []
    for line in batch.split(b"\n"):
        if line:
            attachment, tab, payload = line.partition(b"\t")
            if not tab:
                raise MessageError("a batch of envelopes has a line without a tab between attachment and payload")
            envelopes.append(Envelope(read_origin(attachment), payload))
    return envelopes


Positions = dict[str, dict[str, dict[str, int]]]  # host, boot, lane: number up to which nothing is missing


class Snapshot(msgspec.Struct, kw_only=True, frozen=True):
    """The first line of a snapshot: which keeper's, the mission's clock (None: not begun), and up to where it goes in each lane.

    The lines after it are a batch: what stands, and what was retracted last.
    """

    boot: str
    now_s: float | None
    lanes: Positions


class KeeperBeat(msgspec.Struct, kw_only=True, frozen=True):
    """What the keeper tells all the time: up to which number it holds every lane, journalled, without a gap."""

    boot: str
    lanes: Positions


class LostQuestion(msgspec.Struct, kw_only=True, frozen=True, forbid_unknown_fields=True):
    """A reader asks for the envelopes of a lane from `first` to `last`; the answer is a batch of those that are held."""

    host: str
    boot: str
    lane: Lane
    first: int
    last: int


def join_snapshot(header: Snapshot, envelopes: Iterable[Envelope]) -> bytes:
    """Return a snapshot as one text."""
    return msgspec.json.encode(header) + b"\n" + join_batch(envelopes)


def split_snapshot(text: bytes) -> tuple[Snapshot, list[Envelope]]:
    """Return header and envelopes of a snapshot; raise MessageError where it is none."""
    first, _, rest = text.partition(b"\n")
    try:
        header = msgspec.json.decode(first, type=Snapshot)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise MessageError(f"not a snapshot of a board ({error})") from None
    return header, split_batch(rest)


def read_told(payload: bytes, type_: type[T]) -> T:
    """Return what a keeper or a host tells beside entries (beats, questions, answers); raise MessageError where it is none."""
    try:
        return msgspec.json.decode(payload, type=type_)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise MessageError(f"not a {type_.__name__} ({error})") from None


def robot_of(key: str) -> str:
    """Return whose board a key belongs to; raise BoardError for a key that is none of ours."""
    chunks = key.split("/", 2)
    if len(chunks) < 3 or chunks[0] != "ski" or not is_chunk(chunks[1]):
        raise BoardError(f"key '{key}' is not of the form ski/<robot>/<panel>/...")
    return chunks[1]
