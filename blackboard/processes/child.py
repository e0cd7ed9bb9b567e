"""One child process: started with a leash, waited for in a thread of its own, so that its end is known at once.

The leash is a pipe to the child's standard input, which closes when this process ends, however it ends, and a leashed child goes
down then. Both outputs go to a log file.
"""

import contextlib
import subprocess
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from blackboard.errors import OutputError
from blackboard.processes.identity import Identity, identity_of

TAIL_BYTES = 8192


@dataclass(frozen=True)
class Ended:
    """A child has ended: its exit code, or minus the number of the signal that ended it, and the last line of its log."""

    name: str
    pid: int
    code: int
    last_line: str


class Started(Protocol):
    """A process that an executor has started, by whatever way."""

    @property
    def pid(self) -> int:
        """Its number."""

    @property
    def identity(self) -> Identity:
        """Who it is."""

    def terminate(self) -> None:
        """Ask it to end."""

    def kill(self) -> None:
        """End it."""

    def join(self, timeout_s: float | None = None) -> int | None:
        """Wait for its end and return its code; None where it still runs."""


class Child:
    """A process that this one has started. `ended` is called once, on the waiting thread: it must only put on a queue."""

    def __init__(
        self, name: str, command: Sequence[str], log: Path, ended: Callable[[Ended], None], keep: Sequence[int] = ()
    ) -> None:
        """Start it, with the open files `keep`: then `wait` is called later, since this process has to fork without threads."""
        self.name = name
        self._log = log
        try:
            log.parent.mkdir(parents=True, exist_ok=True)
            with log.open("ab") as out:
                self._begins = out.tell()
                self._process = subprocess.Popen(  # noqa: S603
                    command,
                    stdin=subprocess.PIPE,
                    stdout=out,
                    stderr=out,
                    pass_fds=keep,
                    start_new_session=True,  # Ctrl-C at the terminal is for the manager, which ends its children in order
                )
        except OSError as error:
            raise OutputError(f"{name} cannot be started: {error.strerror}: {error.filename}") from None
        self.pid = self._process.pid
        self.identity = identity_of(self.pid) or Identity(self.pid, "")
        self._ended = ended
        self._thread = threading.Thread(target=self._wait, name=f"wait for {name}", daemon=True)
        if not keep:
            self.wait()

    def wait(self) -> None:
        """Begin to wait for its end."""
        self._thread.start()

    def say(self, line: bytes) -> None:
        """Write a line to its standard input; one that has ended does not hear it."""
        stdin = self._process.stdin
        if stdin is not None:
            with contextlib.suppress(OSError, ValueError):
                stdin.write(line + b"\n")
                stdin.flush()

    def terminate(self) -> None:
        """Ask it to end."""
        self._process.terminate()

    def kill(self) -> None:
        """End it."""
        self._process.kill()

    def join(self, timeout_s: float | None = None) -> int | None:
        """Wait for its end and return its code; None where it still runs."""
        self._thread.join(timeout_s)
        return self._process.returncode

    def _wait(self) -> None:
        code = self._process.wait()
        if self._process.stdin is not None:
            with contextlib.suppress(OSError):
                self._process.stdin.close()
        self._ended(Ended(self.name, self.pid, code, last_line(self._log, self._begins)))


def last_line(log: Path, begins: int = 0) -> str:
    """Return the last line with anything in it after the first `begins` bytes of a log."""
    try:
        with log.open("rb") as file:
            size = file.seek(0, 2)
            file.seek(max(begins, size - TAIL_BYTES))
            lines = file.read().decode(errors="replace").splitlines()
    except OSError:
        return ""
    return next((line.strip()[:400] for line in reversed(lines) if line.strip()), "")
