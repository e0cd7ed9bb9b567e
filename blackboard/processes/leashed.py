"""The child's end of the leash: a process that ends when its standard input does, since then nobody holds it any more."""

import os
import signal
import sys
import threading
import time

GRACE_S = 3.0  # for an orderly end before a hard one


def end_with_holder(grace_s: float = GRACE_S) -> None:
    """Have this process sent SIGTERM when its standard input ends, and ended the hard way where that is not enough."""
    threading.Thread(target=_hold, args=(grace_s,), name="leash", daemon=True).start()


def _hold(grace_s: float) -> None:
    try:
        while os.read(sys.stdin.fileno(), 4096):
            pass
    except (OSError, ValueError):  # standard input is closed, so nobody holds this process
        pass
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(grace_s)
    os.kill(os.getpid(), signal.SIGKILL)
