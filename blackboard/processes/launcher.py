"""Starts hosts one after the other, on a thread of its own: the first waits until its mission is loaded, and nobody else does."""

import contextlib
import queue
import socket
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from blackboard.errors import OutputError
from blackboard.processes.child import Ended, Started
from blackboard.processes.executor import ProcessPlan, start_anew
from blackboard.processes.nursery_children import Nursery, can_fork

CLOSE_S = 30.0


@dataclass(frozen=True)
class Launched:
    """A process was started; None: it could not be, for the reason that `error` gives."""

    plan: ProcessPlan
    child: Started | None
    error: str = ""


class Launcher:
    """Forks hosts from a nursery where this system can have one. `launched` hears of each, on another thread."""

    def __init__(self, log: Path, launched: Callable[[Launched], None], link: socket.socket | None = None) -> None:
        """Make one; `link` leads to a nursery that somebody else has, for the first mission."""
        self._log = log
        self._link = link
        self._launched = launched
        self._mission = ""
        self._nursery: Nursery | None = None
        self._work: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="launcher", daemon=True)
        self._thread.start()

    def prepare(self, mission: str) -> None:
        """Have a mission loaded."""
        self._work.put(lambda: self._prepare(mission))

    def forget(self) -> None:
        """Let go of what is loaded: it may have changed when it is wanted again."""
        self._work.put(self._forget)

    def start(self, plan: ProcessPlan, arguments: Sequence[str], log: Path, ended: Callable[[Ended], None]) -> None:
        """Start a host, `ski ARGUMENTS`."""
        self._work.put(lambda: self._start(plan, arguments, log, ended))

    def close(self) -> None:
        """End, after all that was asked for."""
        self._work.put(self._forget)
        self._work.put(None)
        self._thread.join(CLOSE_S)

    def _run(self) -> None:
        while (work := self._work.get()) is not None:
            work()

    def _prepare(self, mission: str) -> None:
        self._mission = mission
        if self._nursery is not None and (self._nursery.mission != mission or not self._nursery.alive):
            self._forget()
        if self._nursery is None and can_fork():
            with contextlib.suppress(OutputError):
                link, self._link = self._link, None
                self._nursery = Nursery(mission, self._log, link)

    def _forget(self) -> None:
        if self._nursery is not None:
            self._nursery.close()
            self._nursery = None

    def _start(self, plan: ProcessPlan, arguments: Sequence[str], log: Path, ended: Callable[[Ended], None]) -> None:
        self._prepare(self._mission)
        if self._nursery is not None:
            with contextlib.suppress(OutputError):
                self._launched(Launched(plan, self._nursery.start(plan.name, arguments, log, ended)))
                return
        try:
            self._launched(Launched(plan, start_anew(plan, log, ended)))
        except OutputError as error:
            self._launched(Launched(plan, None, str(error)))
