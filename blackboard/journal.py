"""`board.jsonl`: every recorded post of a run, one line of JSON each, in the order of posting; and reading it back."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

import msgspec

from blackboard.entry import Endorsement, Entry, EntryRecord, Event, Support
from blackboard.errors import OutputError, RecordingError
from blackboard.messages.base import Count, Name

FILE_NAME = "board.jsonl"


class _Line(msgspec.Struct, kw_only=True, omit_defaults=True):
    """An EntryRecord for writing: unchecked, since the board has checked all of it."""

    key: str
    revision: int
    event: Event
    stamp_s: float
    source: str
    value: msgspec.Raw
    supports: tuple[Support, ...] = ()
    endorsements: tuple[Endorsement, ...] = ()
    value_from: tuple[int, float] | None = None


_ENCODE = msgspec.json.Encoder().encode


def line_of(entry: Entry[Any], raw: bytes) -> bytes:
    """Return an entry, with its value's JSON, as one line of JSON without its end."""
    return _ENCODE(
        _Line(
            key=entry.key,
            revision=entry.revision,
            event=entry.event,
            stamp_s=entry.stamp_s,
            source=entry.source,
            value=msgspec.Raw(raw),
            supports=entry.supports,
            endorsements=entry.endorsements,
            value_from=entry.value_from,
        )
    )


class JournalWriter:
    """Writes posts to a file as they come; call it with an entry and its value's JSON, close it at the end."""

    def __init__(self, path: Path) -> None:
        try:
            self._file = path.open("wb", buffering=1 << 20)
        except OSError as error:
            raise OutputError(f"{path}: cannot be written ({error.strerror}); choose another --out") from None
        self._path = path

    def __call__(self, entry: Entry[Any], raw: bytes) -> None:
        try:
            self._file.write(line_of(entry, raw) + b"\n")
        except OSError as error:
            raise OutputError(
                f"{self._path}: writing failed ({error.strerror}); free some space and run again"
            ) from None

    def __enter__(self) -> "JournalWriter":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()


class JournalLine(EntryRecord, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A line read back; the value stays JSON until it is decoded by its kind.

    In a keeper's journal `origin` tells who sent it: host, boot, lane, number.
    """

    value: msgspec.Raw
    origin: tuple[Name, Name, Name, Count] | None = None


def read_journal(folder: Path) -> Iterator[JournalLine]:
    """Yield the lines of a run's `board.jsonl`; raise RecordingError naming file and line for what is not one.

    A last line that was cut off (the run was killed while writing) ends the journal without an error.
    """
    path = folder / FILE_NAME if folder.is_dir() else folder
    decoder = msgspec.json.Decoder(JournalLine)
    try:
        with path.open("rb") as file:
            for number, text in enumerate(file, 1):
                try:
                    yield decoder.decode(text)
                except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
                    if not text.endswith(b"\n"):
                        return
                    raise RecordingError(f"{path}:{number}: not an entry of a board ({error})") from None
    except FileNotFoundError:
        raise RecordingError(f"{path}: there is no such file; name the output folder of a run") from None
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from None


def in_stamp_order(lines: Iterable[JournalLine]) -> Iterator[JournalLine]:
    """Yield the lines of a keeper's journal by their stamps: what was handed in late stands there where it came, not when it was.

    Those of a run in one process stay as they are.
    """
    lines = iter(lines)
    first = next(lines, None)
    if first is None:
        return
    if first.origin is None:
        yield first
        yield from lines
    else:
        yield from sorted([first, *lines], key=lambda line: (line.stamp_s, line.revision))
