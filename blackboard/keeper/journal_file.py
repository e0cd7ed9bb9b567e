"""The keeper's journal of one board: `board.jsonl`, only ever appended to, each line an entry with its origin.

A batch is written in one go; what cannot be written whole is taken out again. What stands in the file survives the keeper's own
death, not the machine's: nothing is forced out to the disk.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import msgspec

from blackboard.errors import OutputError
from blackboard.journal import FILE_NAME
from blackboard.link.envelope import Envelope, Origin
from blackboard.link.lanes import Lane

_MARK = b',"origin":['
_PART = 1 << 20
_LINE = 2048  # most lines are shorter


def journalled(origin: Origin, payload: bytes) -> bytes:
    """Return an envelope as a line of the journal: its payload with the origin in place of the last brace."""
    host, boot, lane, number = origin
    return b'%s,"origin":["%s","%s","%s",%d]}\n' % (
        payload[:-1],
        host.encode(),
        boot.encode(),
        lane.encode(),
        number,
    )


def read_journalled(line: bytes) -> Envelope | None:
    """Return the envelope that a line holds, its payload as it came; None where the line is none of the keeper's."""
    place = line.rfind(_MARK)
    if place < 0 or not line.endswith(b"]}\n"):
        return None
    try:
        host, boot, lane, number = msgspec.json.decode(
            line[place + len(_MARK) - 1 : -2], type=tuple[str, str, Lane, int]
        )
    except (msgspec.DecodeError, UnicodeDecodeError):
        return None
    return Envelope(Origin(host, boot, lane, number), line[:place] + b"}")


class JournalFile:
    """An open journal. `trouble` says why the last batch could not be written, "" where all is well."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / FILE_NAME
        self.trouble = ""
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be written ({error.strerror}); choose another --out") from None
        self.size_bytes = self._cut_torn_line(os.fstat(self._file).st_size)

    def append(self, lines: bytes) -> bool:
        """Write whole lines at the end; return False, with nothing of them in the file, where that is not possible now."""
        written = 0
        try:
            while written < len(lines):
                written += os.pwrite(self._file, memoryview(lines)[written:], self.size_bytes + written)
        except OSError as error:
            self.trouble = error.strerror or str(error)
            with suppress(OSError):  # else the next batch is written over it
                os.ftruncate(self._file, self.size_bytes)
            return False
        self.trouble = ""
        self.size_bytes += len(lines)
        return True

    def lines(self, start: int) -> Iterator[tuple[int, bytes]]:
        """Yield offset and text of every line that begins at `start` or after it."""
        offset = max(0, start - 1)  # the end of the line before tells that one begins at `start`
        with self.path.open("rb") as file:
            file.seek(offset)
            if start > 0:
                offset += len(file.readline())
            for line in file:
                yield offset, line
                offset += len(line)

    def line_at(self, offset: int) -> bytes:
        """Return the line that begins at an offset."""
        size = _LINE
        while True:
            text = os.pread(self._file, size, offset)
            end = text.find(b"\n")
            if end >= 0 or len(text) < size:
                return text[: end + 1]
            size *= 16

    def tail_of(self, offset: int, length: int = 64) -> bytes:
        """Return what stands just before an offset, to know the file again."""
        start = max(0, offset - length)
        return os.pread(self._file, offset - start, start)

    def close(self) -> None:
        """Close the file."""
        os.close(self._file)

    def _cut_torn_line(self, size: int) -> int:
        """Cut off a last line that was never finished; return the size that is left."""
        end = size
        while end > 0:
            start = max(0, end - _PART)
            place = os.pread(self._file, end - start, start).rfind(b"\n")
            if place >= 0:
                end = start + place + 1
                break
            end = start
        if end < size:
            os.ftruncate(self._file, end)
        return end
