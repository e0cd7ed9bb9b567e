"""What the keeper's router rejects, counted: zenoh's log goes into memory, where a thread reads it.

zenoh writes its log to standard output's file descriptor, from within its own threads. A pipe there could stop them all while
Python is busy, so it is a file in memory that takes everything at once and is emptied behind the reader.
"""

import contextlib
import ctypes
import os
import sys
import threading
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from blackboard.keys.denials import DIRECTIVES, KINDS, Denial, LogReader
from blackboard.link.session import start_log

NEWEST = 50
CHUNK_BYTES = 1 << 20
MAX_BEHIND_BYTES = 64 << 20  # a reader that is further behind passes over what lies between
READ_EVERY_S = 0.1
_PUNCH_HOLE = 0x03  # FALLOC_FL_KEEP_SIZE | FALLOC_FL_PUNCH_HOLE


@dataclass(frozen=True, slots=True)
class Rejection:
    """One thing that was rejected: when (UTC), what kind of attempt, by which member (where known), and the key or the reason."""

    stamp: str
    kind: str
    member: str
    detail: str


def spoken(rejection: Rejection, often: int) -> str | None:
    """Return a line for people, the first time and every time that the count has grown tenfold; None otherwise."""
    if often != 10 ** (len(str(often)) - 1):
        return None
    who = f" by {rejection.member}" if rejection.member else ""
    times = f" ({often} times by now)" if often > 1 else ""
    return f"rejected: {rejection.kind}{who}, {rejection.detail}{times}"


class Rejections:
    """Counts what is rejected, from `start` on, which comes before the router is opened; once in a process's life.

    Standard output's descriptor is zenoh's from then on, `sys.stdout` goes where it went before.
    """

    def __init__(self, tell: Callable[[Rejection, int], None] | None = None) -> None:
        """`tell` is called, on the thread that reads the log, with every rejection and how often that member tried that by then."""
        self._tell = tell
        self._reader = LogReader()
        self._counts: Counter[str] = Counter()
        self._by_member: Counter[tuple[str, str]] = Counter()
        self._newest: deque[Rejection] = deque(maxlen=NEWEST)
        self._lock = threading.Lock()
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        self._log = -1
        self._read_bytes = 0
        self.passed_over_bytes = 0

    def start(self) -> None:
        """Begin to count; nothing is counted where the system has no files in memory."""
        if not hasattr(os, "memfd_create"):
            return
        self._log = os.memfd_create("zenoh-log", os.MFD_CLOEXEC)
        import fcntl

        fcntl.fcntl(self._log, fcntl.F_SETFL, os.O_APPEND)
        os.environ.pop("RUST_LOG", None)  # it would take the place of what has to be logged here
        sys.stdout.flush()
        before = os.dup(1)
        os.dup2(self._log, 1, inheritable=False)
        sys.stdout = os.fdopen(before, "w", buffering=1, encoding="utf-8", errors="replace")
        start_log(DIRECTIVES)
        self._thread = threading.Thread(target=self._read_on, name="rejections", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Read what is left and stop; the descriptor stays zenoh's."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def counts(self) -> dict[str, int]:
        """Return how often each kind of attempt was rejected; kinds that never were are left out."""
        with self._lock:
            return {kind: self._counts[kind] for kind in KINDS if self._counts[kind]}

    def by_member(self) -> dict[str, dict[str, int]]:
        """Return the same for each member; what nobody knows whose it was stands under the empty name."""
        table: dict[str, dict[str, int]] = {}
        with self._lock:
            for (member, kind), count in sorted(self._by_member.items()):
                table.setdefault(member, {})[kind] = count
        return table

    def told(self) -> dict[str, int]:
        """Return how often each kind of attempt was rejected, with the member's name where it is known."""
        with self._lock:
            counted = sorted(self._by_member.items())
        told = {f"{kind} by {member}" if member else kind: count for (member, kind), count in counted}
        if self.passed_over_bytes:
            told["bytes of log that came too fast to be read"] = self.passed_over_bytes
        return told

    def newest(self) -> list[Rejection]:
        """Return the newest rejections, oldest first."""
        with self._lock:
            return list(self._newest)

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _read_on(self) -> None:
        ended = False
        while not ended:
            ended = self._ended.wait(READ_EVERY_S)
            while self._read_chunk():
                pass

    def _read_chunk(self) -> bool:
        behind = os.fstat(self._log).st_size - self._read_bytes
        if behind > MAX_BEHIND_BYTES:
            passed_over = behind - CHUNK_BYTES
            _forget(self._log, self._read_bytes, passed_over)
            self._read_bytes += passed_over
            self.passed_over_bytes += passed_over
        chunk = os.pread(self._log, CHUNK_BYTES, self._read_bytes)
        if not chunk:
            return False
        _forget(self._log, self._read_bytes, len(chunk))
        self._read_bytes += len(chunk)
        self._note(self._reader.feed(chunk))
        return True

    def _note(self, denials: list[Denial]) -> None:
        for denial in denials:
            member = denial.common_name.rpartition(".")[0] or denial.common_name
            rejection = Rejection(denial.stamp, denial.kind, member, denial.detail)
            with self._lock:
                self._counts[denial.kind] += 1
                self._by_member[member, denial.kind] += 1
                often = self._by_member[member, denial.kind]
                self._newest.append(rejection)
            if self._tell is not None:
                self._tell(rejection, often)


def _forget(descriptor: int, from_bytes: int, size_bytes: int) -> None:
    """Give back the memory of what was read; the file keeps its length, so that writers go on at its end."""
    with contextlib.suppress(AttributeError, OSError):
        libc = ctypes.CDLL(None, use_errno=True)
        libc.fallocate(descriptor, _PUNCH_HOLE, ctypes.c_int64(from_bytes), ctypes.c_int64(size_bytes))
