"""`refused.jsonl`: what the keeper refused, and why. A refused number has come: nobody needs to send it again."""

from collections.abc import Iterator
from pathlib import Path

import msgspec

from blackboard.link.envelope import Origin
from blackboard.link.lanes import Lane

FILE_NAME = "refused.jsonl"
MAX_BYTES = 16_000_000


class RefusedLine(msgspec.Struct, frozen=True, kw_only=True):
    """One refusal."""

    origin: tuple[str, str, Lane, int]
    reason: str
    text: str


def note_refused(folder: Path, refused: list[tuple[Origin, str, str]]) -> bool:
    """Append refusals (origin, reason, text); return False where they cannot be written. A full file is left as it is."""
    path = folder / FILE_NAME
    lines = [RefusedLine(origin=o, reason=reason, text=text[:500]) for o, reason, text in refused]
    try:
        with path.open("ab") as file:
            if file.tell() < MAX_BYTES:
                file.write(b"".join(msgspec.json.encode(line) + b"\n" for line in lines))
    except OSError:
        return False
    return True


def read_refused(folder: Path) -> Iterator[Origin]:
    """Yield the origins of what was refused."""
    try:
        with (folder / FILE_NAME).open("rb") as file:
            for line in file:
                try:
                    yield Origin(*msgspec.json.decode(line, type=RefusedLine).origin)
                except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
                    continue  # cut off in the middle
    except OSError:
        return
