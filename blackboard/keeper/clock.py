"""The mission clock of one robot's board: begun once, kept over restarts of the keeper by the machine's wall clock."""

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Lock

import msgspec

from blackboard.errors import MessageError
from blackboard.link.clock import ClockAnswer, ClockQuestion

FILE_NAME = "clock.json"


class Begun(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When the clock began, by wall time, what it said then, and how many of its seconds pass in one."""

    wall_s: float
    begin: float
    pace: float


class KeptClock:
    """Answers from whatever thread asks. `wall` is the machine's clock, in seconds."""

    def __init__(self, folder: Path, wall: Callable[[], float]) -> None:
        self._path = folder / FILE_NAME
        self._wall = wall
        self._lock = Lock()
        self._begun: Begun | None = None
        self._kept = True  # on disk
        try:
            self._begun = msgspec.json.decode(self._path.read_bytes(), type=Begun)
        except (OSError, msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            self._begun = None

    @property
    def now_s(self) -> float | None:
        """The mission's clock; None where it has not begun."""
        return self._at(self._wall())

    def answer(self, question: bytes, may_begin: bool = True) -> ClockAnswer:
        """Answer a question, beginning the clock if it asks for that; raise MessageError where it is none, or may not."""
        try:
            asked = msgspec.json.decode(question, type=ClockQuestion) if question else ClockQuestion()
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            raise MessageError(f"not a question for the clock ({error}); ask nothing, or begin and pace") from None
        if asked.begin is not None:
            if not may_begin:
                raise MessageError("a clock is begun by asking .../@keeper/begin, not .../@keeper/clock")
            if not (abs(asked.begin) <= 1e10 and 0 < asked.pace <= 1e4):
                raise MessageError(f"a clock begins within 1e10 s of zero at a pace up to 10000, not {question[:80]!r}")
            self._begin(asked.begin, asked.pace)
        wall_s, begun = self._wall(), self._begun
        return ClockAnswer(now_s=self._at(wall_s), wall_s=wall_s, pace=begun.pace if begun is not None else 1.0)

    def _at(self, wall_s: float) -> float | None:
        begun = self._begun
        return None if begun is None else begun.begin + (wall_s - begun.wall_s) * begun.pace

    def keep(self) -> None:
        """Write down what could not be written when the clock began."""
        if self._begun is not None and not self._kept:
            with suppress(OSError):
                replace_file(self._path, msgspec.json.encode(self._begun))
                self._kept = True

    def _begin(self, begin: float, pace: float) -> None:
        with self._lock:
            if self._begun is None:
                self._begun = Begun(wall_s=self._wall(), begin=begin, pace=pace)
                self._kept = False
                self.keep()


def replace_file(path: Path, text: bytes) -> None:
    """Write a file so that at every moment either the old or the new one is there, whole. Raises OSError."""
    beside = path.with_name(path.name + ".new")
    path.parent.mkdir(parents=True, exist_ok=True)
    beside.write_bytes(text)
    os.replace(beside, path)  # noqa: PTH105
