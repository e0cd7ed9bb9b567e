"""The vocabulary of one mission: every kind that may stand on its board, and the check that every value passes.

A value is checked by writing it as JSON, reading that back against its declared type, and comparing: what would not
arrive as it was sent (a wrong type, a value beyond its limit, NaN or infinity, a list for a tuple) is refused where
it is posted.
"""

import math
import re
from collections.abc import Iterable, Iterator
from functools import cache
from typing import Any, TypeVar

import msgspec

from blackboard import kinds as declared
from blackboard.errors import BoardError, MessageError, did_you_mean
from blackboard.key_expressions import is_chunk
from blackboard.kinds import Kind
from blackboard.messages.base import Message

M = TypeVar("M", bound=Message)

_ENCODER = msgspec.json.Encoder()
_PATH = re.compile(r"\.(\w+)|\[(\d+)\]")
MAX_MESSAGE_BYTES = 16_000_000  # an entry with all that belongs to it: larger ones would hold up a link for too long
MAX_VALUE_BYTES = 10_000_000  # of that, the value
MAX_PARSED = 20_000  # keys remembered


def core_kinds() -> list[Kind[Any]]:
    """Return every kind that `blackboard.kinds` declares, by path."""
    return sorted((k for k in vars(declared).values() if isinstance(k, Kind)), key=lambda kind: kind.path)


def has_own_kinds(kinds: "Vocabulary") -> bool:
    """Say whether a mission's components bring kinds of their own."""
    core = {kind.path for kind in core_kinds()}
    return any(kind.path not in core for kind in kinds)


class Vocabulary:
    """The kinds of one mission, by path. Raises BoardError where two different kinds claim one path."""

    def __init__(self, kinds: Iterable[Kind[Any]] = ()) -> None:
        self._kinds: dict[str, Kind[Any]] = {}
        self._parsed: dict[str, tuple[str, Kind[Any], str | None]] = {}  # keys come again and again
        for kind in [*core_kinds(), *kinds]:
            standing = self._kinds.setdefault(kind.path, kind)
            if standing.type is not kind.type or standing.collection != kind.collection:
                types = f"{standing.type.__name__} and {kind.type.__name__}"
                raise BoardError(f"kind '{kind.path}' is declared twice, for {types}; rename one")

    def __iter__(self) -> Iterator[Kind[Any]]:
        return iter(sorted(self._kinds.values(), key=lambda kind: kind.path))

    def __contains__(self, kind: Kind[Any]) -> bool:
        return kind.path in self._kinds

    def at(self, path: str) -> Kind[Any]:
        """Return the kind with this path; raise BoardError with the nearest path where there is none."""
        if path not in self._kinds:
            raise BoardError(f"no kind has the path '{path}'{did_you_mean(path, self._kinds)}")
        return self._kinds[path]

    def parse_key(self, key: str) -> tuple[str, Kind[Any], str | None]:
        """Split `ski/<robot>/<path>[/<id>]` into robot, kind and id; raise BoardError for any other key."""
        parsed = self._parsed.get(key)
        if parsed is not None:
            return parsed
        chunks = key.split("/")
        if len(chunks) < 4 or chunks[0] != "ski" or not all(is_chunk(chunk) for chunk in chunks):
            raise BoardError(f"key '{key}' is not of the form ski/<robot>/<panel>/...")
        for length in (4, 5):
            kind = self._kinds.get("/".join(chunks[2:length]))
            if kind is not None and len(chunks) == length + kind.collection:
                parsed = chunks[1], kind, chunks[length] if kind.collection else None
                if len(self._parsed) < MAX_PARSED:
                    self._parsed[key] = parsed
                return parsed
        path = "/".join(chunks[2:])
        raise BoardError(f"key '{key}' names no kind of this vocabulary{did_you_mean(path, self._kinds)}")

    def schemas(self) -> dict[str, Any]:
        """Return the JSON Schema (2020-12) of every kind's value, by path."""
        return {
            kind.path: {
                "$schema": "https://json-schema.org/draft/2020-12/schema",
                "description": kind.doc,
                "x-collection": kind.collection,
                **msgspec.json.schema(kind.type),
            }
            for kind in self
        }


@cache
def _decoder(type_: type[Message]) -> "msgspec.json.Decoder[Any]":
    return msgspec.json.Decoder(type_)


def checked(kind: Kind[M], key: str, value: M) -> tuple[M, bytes]:
    """Return the value as every reader will see it, and its JSON; raise MessageError where it is unfit for its kind."""
    if type(value) is not kind.type:
        raise MessageError(f"{key}: a {type(value).__name__} was posted, this key holds {kind.type.__name__}")
    try:
        raw = _ENCODER.encode(value)
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        raise MessageError(
            f"{key}: the value cannot be written as JSON ({error}); use plain numbers, strings, tuples"
        ) from None
    if len(raw) > MAX_VALUE_BYTES:
        raise MessageError(f"{key}: the value has {len(raw)} bytes, the limit is {MAX_VALUE_BYTES}; post it in parts")
    try:
        arrived = _decoder(kind.type).decode(raw)
    except msgspec.ValidationError as error:
        raise MessageError(_refusal(key, value, str(error))) from None
    if arrived != value:
        raise MessageError(f"{key}: {_difference(value, arrived, '')}")
    return arrived, raw


def decode(kind: Kind[M], key: str, data: bytes) -> M:
    """Return the value that came as JSON from outside; raise MessageError naming key, field, value and limit."""
    if len(data) > MAX_MESSAGE_BYTES:
        raise MessageError(f"{key}: the message has {len(data)} bytes, the limit is {MAX_MESSAGE_BYTES}")
    try:
        value: M = _decoder(kind.type).decode(data)
        return value
    except msgspec.ValidationError as error:
        try:
            plain = msgspec.json.decode(data)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            plain = None
        raise MessageError(_refusal(key, plain, str(error))) from None
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise MessageError(f"{key}: not JSON ({error})") from None


def _refusal(key: str, value: object, text: str) -> str:
    reason, _, path = text.partition(" - at `$")
    field = path.rstrip("`").lstrip(".")
    found = value
    for name, index in _PATH.findall(path):
        if isinstance(found, list | tuple) and index and int(index) < len(found):
            found = found[int(index)]
        elif isinstance(found, dict):
            found = found.get(name)
        else:
            found = getattr(found, name, None)
    shown = "" if not field or found is value else f" = {_shown(found)}"
    reason = reason.replace("`", "")
    if isinstance(found, float) and not math.isfinite(found):
        reason = "must be finite"
    return f"{key}: {field}{shown}: {reason}" if field else f"{key}: {reason}"


def _difference(sent: object, arrived: object, path: str) -> str:
    if isinstance(sent, msgspec.Struct) and type(sent) is type(arrived):
        for name in sent.__struct_fields__:
            a, b = getattr(sent, name), getattr(arrived, name)
            if a != b:
                return _difference(a, b, f"{path}.{name}".lstrip("."))
    if isinstance(sent, tuple) and isinstance(arrived, tuple):
        for i, (a, b) in enumerate(zip(sent, arrived, strict=False)):
            if a != b:
                return _difference(a, b, f"{path}[{i}]")
    if isinstance(sent, float) and not math.isfinite(sent):
        return f"{path} = {sent!r}: must be finite"
    return f"{path} = {_shown(sent)}: must be a {type(arrived).__name__}, not a {type(sent).__name__}"


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
