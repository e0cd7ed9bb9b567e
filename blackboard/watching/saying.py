"""What a person says on a board: a value for a key, a reason for or against an entry, or that an entry is to go.

Everything here raises a SkiError where it cannot be, with nothing posted.
"""

from typing import Any

import msgspec

from blackboard.board import Board
from blackboard.errors import BoardError, MessageError, did_you_mean
from blackboard.key_expressions import is_chunk
from blackboard.kinds import BEHAVIOUR, HOST, MOTIVATION, Kind
from blackboard.vocabulary import MAX_MESSAGE_BYTES, Vocabulary, decode


def whole_key(key: str, robots: list[str]) -> str:
    """Return a key with its robot: as it is, or on the board of the only robot there is."""
    if key.startswith("ski/"):
        return key
    if len(robots) != 1:
        there = ", ".join(sorted(robots)) or "none yet"
        raise BoardError(f"key '{key}': name the robot's board, ski/<robot>/{key}; there are {there}")
    return f"ski/{robots[0]}/{key}"


def parse_key(vocabulary: Vocabulary, key: str) -> tuple[str, Kind[Any], str | None]:
    """Return robot, kind and id of a key; raise BoardError where it is none, with what is missing."""
    chunks = key.split("/")
    path = "/".join(chunks[2:])
    if any(kind.path == path and kind.collection for kind in vocabulary):
        raise BoardError(f"key '{key}' needs an id: {key}/<id>")
    return vocabulary.parse_key(key)


def check_speaker(board: Board, name: str) -> None:
    """Raise BoardError where a person would speak under the name of a component that runs."""
    if not is_chunk(name):
        raise BoardError(f"--as '{name}': letters, digits, '_', '-' and '.' only")
    for host in board.entries(HOST):
        if host.value.state in ("alive", "hung") and name in host.value.components:
            raise BoardError(f"--as '{name}': {name} is a component that runs in {host.id}; take a name of your own")


def read_value(board: Board, kind: Kind[Any], id: str | None, text: bytes) -> Any:
    """Return the value that the JSON text is; a motivation's number follows on the last one unless given."""
    key = board.key(kind, id)
    if kind is MOTIVATION:
        text = _numbered(board, str(id), key, text)
    return decode(kind, key, text)


def _numbered(board: Board, behaviour: str, key: str, text: bytes) -> bytes:
    there = [str(entry.id) for entry in board.entries(BEHAVIOUR)]
    if there and behaviour not in there:
        raise BoardError(f"{key}: there is no behaviour '{behaviour}'{did_you_mean(behaviour, there)}")
    if len(text) > MAX_MESSAGE_BYTES:
        raise MessageError(f"{key}: the message has {len(text)} bytes, the limit is {MAX_MESSAGE_BYTES}")
    try:
        value = msgspec.json.decode(text)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return text  # refused with its reason when it is decoded by its kind
    if not isinstance(value, dict) or "number" in value:
        return text
    asked, shown = board.newest(MOTIVATION, behaviour), board.newest(BEHAVIOUR, behaviour)
    last = max(asked.value.number if asked else 0, shown.value.acknowledged if shown else 0)
    return msgspec.json.encode({**value, "number": last + 1})
