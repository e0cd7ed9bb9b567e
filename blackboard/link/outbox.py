"""What a host has posted and the keeper has not yet acknowledged, kept on disk: it outlives a kill of the host.

Envelopes are appended to segment files in the order of posting, before they are sent. A segment goes once all of it is
acknowledged. What an earlier boot of the host left is found at the start, and handed to the keeper under its old numbers.

A disk that is full does not stop a robot: what cannot be written is kept in memory, and `trouble` says so. Where so much waits that
memory would run out (hours without a keeper, or a role that may not post what the host posts), the oldest goes and is counted.
"""

import os
from collections import deque
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from blackboard.errors import LinkError, MessageError
from blackboard.link.envelope import Envelope, attachment_of, read_origin
from blackboard.link.lanes import LANES, Lane

SEGMENT_BYTES = 4_000_000
LIMIT_BYTES = 256_000_000  # an hour of a sonar robot without a keeper
SUFFIX = ".outbox"


class Outbox:
    """The unacknowledged envelopes of one boot, in memory and, where there is a folder, on disk."""

    def __init__(self, folder: Path | None = None, limit_bytes: int = LIMIT_BYTES) -> None:
        """Read what earlier boots left in `folder`; raise LinkError where it cannot be used."""
        self.left: list[Envelope] = []
        self.trouble = ""  # why not all of it is on disk
        self.dropped = 0
        self._limit_bytes = limit_bytes
        self._bytes: dict[Lane, int] = dict.fromkeys(LANES, 0)
        self._waiting: dict[Lane, deque[Envelope]] = {lane: deque() for lane in LANES}
        self._folder = folder
        self._segments: deque[tuple[Path, dict[Lane, int]]] = deque()  # closed ones, with the last number of each lane
        self._last: dict[Lane, int] = {}
        self._file = -1
        self._size = 0
        self._number = 0
        self._old: list[Path] = []
        if folder is not None:
            try:
                folder.mkdir(parents=True, exist_ok=True)
                self._old = sorted(folder.glob(f"*{SUFFIX}"))
                for path in self._old:
                    self.left += _read(path)
                self._number = max((int(path.stem) for path in self._old if path.stem.isdigit()), default=0)
                self._open()
            except OSError as error:
                raise LinkError(f"{folder}: cannot be used ({error.strerror}); choose another --state") from None

    def add(self, envelope: Envelope) -> None:
        """Keep an envelope until it is acknowledged."""
        lane = envelope.origin.lane
        self._waiting[lane].append(envelope)
        self._bytes[lane] += len(envelope.payload)
        if sum(self._bytes.values()) > self._limit_bytes:
            self._drop_oldest()
        if self._folder is not None:
            self._write(b"%s\t%s\n" % (attachment_of(envelope.origin), envelope.payload))
            self._last[lane] = envelope.origin.number
            if self._size >= SEGMENT_BYTES:
                self._rotate()

    def _write(self, line: bytes) -> None:
        try:
            written = os.write(self._file, line)
            if written == len(line):
                self._size += written
                self.trouble = ""
                return
            os.ftruncate(self._file, self._size)  # no torn line may stand between whole ones
            self.trouble = "no space left on device"
        except OSError as error:
            self.trouble = (error.strerror or str(error)).lower()

    def _rotate(self) -> None:
        try:
            before, path = self._file, self._path
            last = self._last
            self._open()
        except OSError as error:
            self.trouble = (error.strerror or str(error)).lower()
            return
        os.close(before)
        self._segments.append((path, last))

    def _drop_oldest(self) -> None:
        lane = max(LANES, key=lambda lane: self._bytes[lane])
        self._bytes[lane] -= len(self._waiting[lane].popleft().payload)
        self.dropped += 1

    def acknowledge(self, lane: Lane, number: int) -> None:
        """Let go of all up to a number."""
        waiting = self._waiting[lane]
        while waiting and waiting[0].origin.number <= number:
            self._bytes[lane] -= len(waiting.popleft().payload)
        while self._segments and not self._needed(self._segments[0][1]):
            self._segments.popleft()[0].unlink(missing_ok=True)

    def acknowledge_left(self) -> None:
        """Let go of what earlier boots left: the keeper has it."""
        self.left = []
        for path in self._old:
            path.unlink(missing_ok=True)
        self._old = []

    def waiting(self, lane: Lane) -> deque[Envelope]:
        """Return what is not acknowledged of a lane, oldest first."""
        return self._waiting[lane]

    def after(self, lane: Lane, number: int) -> Iterator[Envelope]:
        """Yield what is not acknowledged of a lane and comes after a number, oldest first."""
        waiting = self._waiting[lane]
        if waiting:
            skipped = max(0, number + 1 - waiting[0].origin.number)  # numbers follow each other
            yield from islice(waiting, skipped, None)

    def __len__(self) -> int:
        return sum(len(waiting) for waiting in self._waiting.values())

    def close(self) -> None:
        """Close the file, and take it away where nothing in it is needed."""
        if self._file >= 0:
            os.close(self._file)
            self._segments.append((self._path, self._last))
            self._file = -1
        for lane, waiting in self._waiting.items():
            if not waiting:
                self.acknowledge(lane, 0)

    def _needed(self, last: dict[Lane, int]) -> bool:
        return any(w and w[0].origin.number <= last.get(lane, 0) for lane, w in self._waiting.items())

    def _open(self) -> None:
        assert self._folder is not None
        self._number += 1
        self._path = self._folder / f"{self._number:08d}{SUFFIX}"
        self._file = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o600)
        self._size, self._last = 0, {}


def _read(path: Path) -> list[Envelope]:
    """Return the envelopes of a segment; a last line that was cut off is none, since it was never sent either."""
    envelopes = []
    for line in path.read_bytes().split(b"\n")[:-1]:
        attachment, _, payload = line.partition(b"\t")
        try:
            envelopes.append(Envelope(read_origin(attachment), payload))
        except MessageError as error:
            raise LinkError(f"{path}: not an outbox ({error}); move it away") from None
    return envelopes
