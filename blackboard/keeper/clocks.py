"""The mission clocks of all robots, asked from whatever thread."""

import time
from pathlib import Path
from threading import Lock

from blackboard.keeper.clock import KeptClock
from blackboard.link.clock import ClockAnswer


class Clocks:
    """A clock for each robot, in the robot's folder. A wall clock that is set meanwhile moves none of them."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._wall_minus_monotonic_s = time.time() - time.monotonic()
        self._clocks: dict[str, KeptClock] = {}
        self._lock = Lock()

    def ask(self, robot: str, question: bytes = b"", may_begin: bool = False) -> ClockAnswer:
        """Ask a robot's clock; one that has begun is kept. Raises MessageError where the question is none, or asks too much."""
        with self._lock:
            clock = self._clocks.get(robot) or KeptClock(self._folder / robot, self._wall_s)
            answer = clock.answer(question, may_begin)
            if answer.now_s is not None:
                self._clocks.setdefault(robot, clock)
            return answer

    def now_s(self, robot: str) -> float | None:
        """Return a robot's clock; None where it has not begun."""
        clock = self._clocks.get(robot)
        return clock.now_s if clock is not None else None

    def keep(self, robot: str) -> None:
        """Write down what could not be written when the clock began."""
        clock = self._clocks.get(robot)
        if clock is not None:
            clock.keep()

    def _wall_s(self) -> float:
        return time.monotonic() + self._wall_minus_monotonic_s
