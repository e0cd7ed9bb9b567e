"""An executor's hand on its nursery: hosts forked there are its children like those that it starts itself.

Each is on a leash of the executor's own. Where the nursery ends before its children they are waited for all the same; only their
exit codes are not known then.
"""

import contextlib
import os
import queue
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec

from blackboard.errors import OutputError
from blackboard.processes.child import Ended, last_line
from blackboard.processes.identity import Identity, gone_within, identity_of, send
from blackboard.processes.nursery import MAX_BYTES, Asked, Told

FORK_S = 20.0  # the first one waits until the mission is loaded
CLOSE_S = 3.0  # to finish what it is loading
UNKNOWN = -signal.SIGKILL  # the code of an end that nobody saw


def can_fork() -> bool:
    """Say whether this system has all that a nursery needs."""
    return hasattr(os, "pidfd_open") and hasattr(socket, "send_fds") and hasattr(socket, "SOCK_SEQPACKET")


def link_pair() -> tuple[socket.socket, socket.socket]:
    """Return the two ends of a link to a nursery."""
    return socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)


class ForkedChild:
    """A process forked by a nursery; the same to its owner as a `Child`."""

    def __init__(
        self, name: str, who: Identity, leash: int, log: Path, begins: int, ended: Callable[[Ended], None]
    ) -> None:
        self.name = name
        self.identity = who
        self.pid = who.pid
        self._leash = leash
        self._log = log
        self._begins = begins
        self._ended = ended
        self._code: int | None = None
        self._over = threading.Event()

    def terminate(self) -> None:
        """Ask it to end."""
        send(self.identity, signal.SIGTERM)

    def kill(self) -> None:
        """End it."""
        send(self.identity, signal.SIGKILL)

    def join(self, timeout_s: float | None = None) -> int | None:
        """Wait for its end and return its code; None where it still runs."""
        self._over.wait(timeout_s)
        return self._code

    def note_end(self, code: int) -> None:
        """Take note of its end, once."""
        if self._code is None:
            self._code = code
            os.close(self._leash)
            self._ended(Ended(self.name, self.pid, code, last_line(self._log, self._begins)))
            self._over.set()


class Nursery:
    """A nursery process. `alive` says whether it can still fork."""

    def __init__(self, mission: str, log: Path, link: socket.socket | None = None) -> None:
        """Start one, or take the one at the other end of `link`, which has loaded the mission or will have."""
        self.mission = mission
        self._process: subprocess.Popen[bytes] | None = None
        self._link = link or self._new(log)
        self._forked: queue.SimpleQueue[int] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._children: dict[int, ForkedChild] = {}
        self._early: dict[int, int] = {}  # ends that came before the child was known here
        self.alive = True
        self._thread = threading.Thread(target=self._listen, name="nursery", daemon=True)
        self._thread.start()
        if link is None:
            self._ask(Asked(what="warm", mission=mission))

    @property
    def identity(self) -> Identity | None:
        """Who it is, where it was started here."""
        return identity_of(self._process.pid) if self._process is not None else None

    def start(self, name: str, arguments: Sequence[str], log: Path, ended: Callable[[Ended], None]) -> ForkedChild:
        """Fork `ski ARGUMENTS`. Raises OutputError where the nursery does not do it."""
        theirs, ours = os.pipe()
        log.parent.mkdir(parents=True, exist_ok=True)
        with log.open("ab") as out:
            begins = out.tell()
            try:
                self._ask(Asked(what="fork", name=name, arguments=tuple(arguments)), (theirs, out.fileno()))
                pid = self._forked.get(timeout=FORK_S)
            except (OSError, queue.Empty):
                pid = 0
            finally:
                os.close(theirs)
        if pid == 0:  # a late answer must not be taken for the next one's
            os.close(ours)
            self.alive = False
            with contextlib.suppress(OSError):
                self._link.shutdown(socket.SHUT_RDWR)
            raise OutputError(f"{name} cannot be forked: the nursery does not answer")
        child = ForkedChild(name, identity_of(pid) or Identity(pid, ""), ours, log, begins, ended)
        with self._lock:
            self._children[pid] = child
            code = self._early.pop(pid, None)
        if code is not None:
            self._note(pid, code)
        elif not self.alive:
            self._wait_without(child)
        return child

    def close(self) -> None:
        """Let it end; children that it forked run on."""
        with contextlib.suppress(OSError):
            self._link.shutdown(socket.SHUT_RDWR)
        if self._process is None:
            return
        try:
            self._process.wait(CLOSE_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _new(self, log: Path) -> socket.socket:
        ours, theirs = link_pair()
        try:
            log.parent.mkdir(parents=True, exist_ok=True)
            with theirs, log.open("ab") as out:
                command = [sys.executable, "-m", "blackboard.processes.nursery"]
                self._process = subprocess.Popen(  # noqa: S603
                    command, stdin=theirs.fileno(), stdout=out, stderr=out, start_new_session=True
                )
        except OSError as error:
            ours.close()
            raise OutputError(f"the nursery cannot be started: {error.strerror}") from None
        return ours

    def _ask(self, asked: Asked, handles: Sequence[int] = ()) -> None:
        socket.send_fds(self._link, [msgspec.json.encode(asked)], list(handles))

    def _listen(self) -> None:
        with contextlib.suppress(OSError):
            while text := self._link.recv(MAX_BYTES):
                told = msgspec.json.decode(text, type=Told)
                if told.what == "forked":
                    self._forked.put(told.pid)
                else:
                    self._note(told.pid, told.code)
        self._link.close()
        self._forked.put(0)  # whoever waits for an answer has waited long enough
        with self._lock:
            self.alive = False
            orphans = list(self._children.values())
        for child in orphans:
            self._wait_without(child)

    def _note(self, pid: int, code: int) -> None:
        with self._lock:
            child = self._children.pop(pid, None)
            if child is None:
                self._early[pid] = code
                return
        child.note_end(code)

    def _wait_without(self, child: ForkedChild) -> None:
        def wait() -> None:
            while not gone_within(child.identity, 60.0):
                pass
            child.note_end(UNKNOWN)

        threading.Thread(target=wait, name=f"wait for {child.name}", daemon=True).start()
