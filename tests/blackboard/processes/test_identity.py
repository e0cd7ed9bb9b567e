"""Who a process is, and that signals reach only the one that was meant."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

from blackboard.processes.identity import Identity, cpu_s, end_all, gone_within, identity_of, is_alive, send

WAITS = "import sys; print('up', flush=True); sys.stdin.read()"
DEAF = "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN)\n" + WAITS


@pytest.fixture
def process() -> Iterator[subprocess.Popen[bytes]]:
    yield from started(WAITS)


@pytest.fixture
def deaf() -> Iterator[subprocess.Popen[bytes]]:
    yield from started(DEAF)


def started(script: str) -> Iterator[subprocess.Popen[bytes]]:
    child = subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    try:
        assert child.stdout is not None
        assert child.stdout.readline() == b"up\n"
        yield child
    finally:
        child.kill()
        child.communicate(timeout=20)


def who(child: subprocess.Popen[bytes]) -> Identity:
    found = identity_of(child.pid)
    assert found is not None
    return found


def test_one_that_runs_is_alive(process: subprocess.Popen[bytes]) -> None:
    assert is_alive(who(process))


def test_this_process_has_used_time_and_one_that_is_not_there_none() -> None:
    assert (cpu_s(os.getpid()) or 0.0) > 0.0
    assert cpu_s(2**22 + 1) is None


def test_a_number_given_out_again_is_somebody_else(process: subprocess.Popen[bytes]) -> None:
    other = Identity(process.pid, "earlier")
    assert not is_alive(other)
    assert not send(other, signal.SIGKILL)
    assert end_all([other], 0.0) == 0
    assert process.poll() is None


def test_the_dead_are_gone_even_before_their_parent_looks(process: subprocess.Popen[bytes]) -> None:
    asked = who(process)
    process.kill()
    assert gone_within(asked, 20.0)
    assert identity_of(process.pid) is None
    assert not send(asked, signal.SIGTERM)


def test_all_are_ended_who_hear_it_by_a_word(process: subprocess.Popen[bytes]) -> None:
    assert end_all([who(process)], 20.0) == 1
    assert process.wait(20) == -signal.SIGTERM


def test_who_does_not_hear_is_killed(deaf: subprocess.Popen[bytes]) -> None:
    assert end_all([who(deaf)], 0.1) == 1
    assert deaf.wait(20) == -signal.SIGKILL


def test_who_is_halted_is_ended_too(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGSTOP)
    assert end_all([who(process)], 20.0) == 1
    assert process.wait(20) == -signal.SIGTERM


def test_waiting_for_one_that_runs_on_ends_in_time(process: subprocess.Popen[bytes]) -> None:
    assert not gone_within(who(process), 0.05)
