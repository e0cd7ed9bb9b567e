"""Two machines, the cable between them pulled for a moment: a short run of the trial in benchmarks/cuts.py.

The robot must be told to stand within half a second of the mission's clock, and go on once the cable is in again; one that has its
behaviours in the same process must not stand at all. Nothing is lost.
"""

import os
import subprocess
import sys

import pytest
from deployment import CHECKOUT
from namespaces import why_not

pytestmark = [
    pytest.mark.timeout(300),
    pytest.mark.skipif(bool(why_not()), reason=why_not() or "possible"),
]
SHORT = ("--cuts", "3", "--first", "6", "--rest", "6", "--duration", "15")


@pytest.mark.parametrize("together", [(), ("--together",)], ids=["robot alone", "robot with its behaviours"])
def test_nothing_is_lost_and_a_robot_that_nobody_commands_stands(together, tmp_path):
    command = [sys.executable, str(CHECKOUT / "benchmarks" / "cuts.py"), *together, *SHORT, "--keep", str(tmp_path)]
    done = subprocess.run(
        [*command, "--mission", "wander-lab"],
        capture_output=True,
        text=True,
        check=False,
        timeout=240,
        env={**os.environ, "PYTHONPATH": str(CHECKOUT)},
    )
    assert "lost: 0 of" in done.stdout, done.stdout + done.stderr
    assert done.returncode == 0, done.stdout + done.stderr
