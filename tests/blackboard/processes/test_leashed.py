"""The child's end of the leash."""

import signal
import subprocess
import sys

DEAF = "signal.signal(signal.SIGTERM, signal.SIG_IGN)"


def held(before: str = "") -> "subprocess.Popen[bytes]":
    script = f"import signal, sys\n{before}\nfrom blackboard.processes.leashed import end_with_holder\nend_with_holder(0.1)\n"
    script += "print('up', flush=True)\nwhile True: signal.pause()\n"
    child = subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert child.stdout is not None
    assert child.stdout.readline() == b"up\n"
    return child


def test_it_ends_when_it_is_let_go() -> None:
    child = held()
    try:
        assert child.poll() is None
        child.communicate(timeout=20)
        assert child.returncode == -signal.SIGTERM
    finally:
        child.kill()


def test_one_that_does_not_listen_ends_the_hard_way() -> None:
    child = held(DEAF)
    try:
        child.communicate(timeout=20)
        assert child.returncode == -signal.SIGKILL
    finally:
        child.kill()


def test_without_standard_input_nobody_holds_it() -> None:
    script = (
        "import os, signal\nos.close(0)\nfrom blackboard.processes.leashed import end_with_holder\nend_with_holder()\n"
    )
    done = subprocess.run([sys.executable, "-c", script + "signal.pause()"], timeout=20, check=False)
    assert done.returncode == -signal.SIGTERM
