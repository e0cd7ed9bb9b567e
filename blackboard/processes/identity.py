"""Who a process is: its number and when it started, since numbers are given out again.

A signal goes only to the process that was meant: on Linux the number is held open while its start is looked at.
"""

import contextlib
import os
import select
import signal
import subprocess
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec

_PROC = Path("/proc")
_POLL_S = 0.05  # where the system cannot wait for another's child
KILLED_S = 5.0  # the system's own time to end a process
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


class Identity(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A process: `started` is the system's word for when it began, to be compared and not read."""

    pid: int
    started: str


def identity_of(pid: int) -> Identity | None:
    """Return who runs under this number; None where nobody does, or only what is left of it."""
    if _PROC.joinpath("self").exists():
        stat = _stat(pid)
        return None if stat is None or stat[0] in "ZX" else Identity(pid, f"{stat[19]}@{_boot()}")
    command = ["/bin/ps", "-o", "stat=,lstart=", "-p", str(pid)]
    told = subprocess.run(command, capture_output=True, text=True, check=False).stdout.split(maxsplit=1)  # noqa: S603
    return None if len(told) < 2 or told[0].startswith("Z") else Identity(pid, told[1].strip())


def is_alive(who: Identity) -> bool:
    """Say whether this very process still runs."""
    return identity_of(who.pid) == who


def cpu_s(pid: int) -> float | None:
    """Return the processor time that a process has used; None where nobody can tell."""
    stat = _stat(pid)
    return (int(stat[11]) + int(stat[12])) / TICKS_PER_S if stat is not None else None


def send(who: Identity, number: signal.Signals) -> bool:
    """Send a signal to this very process; False where it is gone."""
    with _held(who.pid) as handle:
        if not is_alive(who):
            return False
        try:
            if handle is None:
                os.kill(who.pid, number)
            else:
                signal.pidfd_send_signal(handle, number)
        except ProcessLookupError:
            return False
    return True


def end_all(processes: Sequence[Identity], grace_s: float) -> int:
    """End processes, whoever started them: SIGTERM to all, SIGKILL to those left after `grace_s`. Return how many ran."""
    until_s = time.monotonic() + grace_s
    ran = [who for who in processes if send(who, signal.SIGTERM)]
    for who in ran:
        send(who, signal.SIGCONT)  # one that was halted cannot hear that it is to end
    for who in ran:
        if not gone_within(who, max(0.0, until_s - time.monotonic())) and send(who, signal.SIGKILL):
            gone_within(who, KILLED_S)
    return len(ran)


def gone_within(who: Identity, timeout_s: float) -> bool:
    """Wait until a process is gone, at most so long; say whether it is."""
    until = time.monotonic() + timeout_s
    with _held(who.pid) as handle:
        while is_alive(who):
            left_s = until - time.monotonic()
            if left_s <= 0:
                return False
            if handle is None:
                time.sleep(min(_POLL_S, left_s))
            else:
                select.select([handle], [], [], left_s)
    return True


@contextlib.contextmanager
def _held(pid: int) -> Iterator[int | None]:
    """Keep a process's number from being given out again, where the system can do that."""
    handle = None
    if hasattr(os, "pidfd_open"):
        with contextlib.suppress(OSError):
            handle = os.pidfd_open(pid)
    try:
        yield handle
    finally:
        if handle is not None:
            os.close(handle)


def _stat(pid: int) -> list[str] | None:
    try:
        return (_PROC / str(pid) / "stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None


def _boot() -> str:
    try:
        return (_PROC / "sys/kernel/random/boot_id").read_text()[:8]
    except OSError:
        return ""
