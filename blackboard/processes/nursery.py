"""A process that has everything loaded and forks hosts: one is up in a tenth of the time, the first as well as one that was killed.

It opens no link and starts no thread, since neither would survive a fork. It is told what to do on a socket, its standard input:
`warm` (load a mission), `fork` (with the ends of a leash and a log); it answers `forked` and `ended`. It ends when the socket does.
"""

import contextlib
import gc
import os
import select
import signal
import socket
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import msgspec

from blackboard.errors import SkiError

MAX_BYTES = 1 << 20
ENDING = (signal.SIGTERM, signal.SIGINT)
COMM = Path("/proc/self/comm")  # what `top` calls a process


class Asked(msgspec.Struct, frozen=True, kw_only=True):
    """What it is asked: to load a mission, or to fork `ski ARGUMENTS`."""

    what: Literal["warm", "fork"]
    name: str = ""
    arguments: tuple[str, ...] = ()
    mission: str = ""


class Told(msgspec.Struct, frozen=True, kw_only=True):
    """What it tells: a process that it forked, or the end of one (code as of `Ended`)."""

    what: Literal["forked", "ended"]
    pid: int
    code: int = 0


def main() -> None:
    """Be a nursery, started from nothing."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # a pool of threads would not survive the fork
    serve(socket.socket(fileno=os.dup(0)))


def fork_nursery(link: socket.socket, log: Path) -> None:
    """Fork one from this process, which has a mission loaded, no link open, and one thread. It is nobody's child."""
    child = os.fork()
    if child:
        os.waitpid(child, 0)
        return
    try:
        os.setsid()
        if os.fork():
            return
        nothing, out = os.open(os.devnull, os.O_RDONLY), os.open(log, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
        for place, handle in enumerate((nothing, out, out)):
            os.dup2(handle, place)
        kept = link.fileno()
        os.closerange(
            3, kept
        )  # above all other ends of pipes: whoever waits for theirs to close would wait for this process
        os.closerange(kept + 1, 65_536)
        with contextlib.suppress(OSError):
            COMM.write_text("ski-nursery")
        gc.freeze()
        serve(link)
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(0)


def serve(link: socket.socket) -> None:
    """Serve until the other end is gone."""
    with contextlib.suppress(BrokenPipeError, ConnectionResetError):
        _serve(link)


def _serve(link: socket.socket) -> None:
    woken, wake = os.pipe()
    for end in (woken, wake):
        os.set_blocking(end, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)  # it ends with its holder, not before
    while True:
        ready, _, _ = select.select([link.fileno(), woken], [], [])
        if woken in ready:
            with contextlib.suppress(BlockingIOError):
                os.read(woken, 4096)
        for told in _ends():
            link.send(msgspec.json.encode(told))
        if link.fileno() in ready:
            text, handles, _, _ = socket.recv_fds(link, MAX_BYTES, 2)
            if not text:
                return
            asked = msgspec.json.decode(text, type=Asked)
            if asked.what == "warm":
                _warm(asked.mission)
                continue
            signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)  # one that comes before the child can obey it waits
            pid = os.fork()
            if pid == 0:
                signal.set_wakeup_fd(-1)
                for handle in (link.fileno(), woken, wake):
                    os.close(handle)
                _be(asked, handles)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
            for handle in handles:
                os.close(handle)
            link.send(msgspec.json.encode(Told(what="forked", pid=pid)))


def _warm(mission: str) -> None:
    """Load all that a host of a mission needs; what cannot be loaded the host will complain of itself."""
    import blackboard.command.host
    import blackboard.link.host  # noqa: F401
    from blackboard.assembly import assemble
    from blackboard.mission import find_mission, load_mission

    with contextlib.suppress(SkiError):
        assemble(load_mission(find_mission(mission)))
    gc.freeze()  # what is there is shared, and need not be looked through again by each host


def _ends() -> list[Told]:
    """Return the ends of children since the last look."""
    told = []
    with contextlib.suppress(ChildProcessError):
        while True:
            pid, status = os.waitpid(-1, os.WNOHANG)
            if pid == 0:
                break
            told.append(Told(what="ended", pid=pid, code=os.waitstatus_to_exitcode(status)))
    return told


def _be(asked: Asked, handles: Sequence[int]) -> None:
    """Be the child: run the command, and end."""
    code = 1
    try:
        os.setsid()
        leash, log = handles
        os.dup2(leash, 0)
        os.dup2(log, 1)
        os.dup2(log, 2)
        for handle in handles:
            os.close(handle)
        for number in (*ENDING, signal.SIGCHLD):
            signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
        with contextlib.suppress(OSError):
            COMM.write_text(f"ski-{asked.name}"[:15])
        from blackboard.command.main import main as ski

        code = ski(asked.arguments)
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    except BaseException:
        traceback.print_exc()
    finally:
        with contextlib.suppress(OSError, ValueError):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


if __name__ == "__main__":
    main()
