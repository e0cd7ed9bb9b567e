"""`ski up` of a mission with several robots: one world in one process, a board each, results of each and of all."""

import json
import os
import socket
import subprocess
import sys
from pathlib import Path

from blackboard.command.main import main

CHECKOUT = Path(__file__).resolve().parents[3]
ROBOTS = """
[[robot]]
name = "east"
use = "sim.simulated:SimulatedRobot"
start_x_m = 5.2
start_y_m = 2.4

[[robot]]
name = "west"
use = "sim.simulated:SimulatedRobot"
start_x_m = 2.8
start_y_m = 2.4

[[knowledge_source]]
use = "knowledge_sources.odometry_pose:OdometryPose"

[hosts.all]
runs = ["robot", "knowledge_sources"]
"""


def test_each_robot_has_its_results_and_all_have_theirs(tmp_path: Path) -> None:
    (tmp_path / "pair.toml").write_text(ROBOTS)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    home = {"HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path / "state"), "XDG_RUNTIME_DIR": str(tmp_path)}
    asked = ("up", str(tmp_path / "pair.toml"), "--duration", "2", "--connect", address, "--json")
    done = subprocess.run(
        [sys.executable, "-m", "blackboard.command.main", *asked, "--out", str(tmp_path / "out")],
        env={**os.environ, **home, "PYTHONPATH": str(CHECKOUT)},
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["team"]["robots"] == "east, west"
    assert all(told["robots"][name]["robot"] == name for name in ("east", "west"))
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["east", "overview.png", "west"]
    for name in ("east", "west"):
        assert main(["why", "observations/feature/odom_from_robot", "--in", str(tmp_path / "out" / name)]) == 0
        keys = {json.loads(line)["key"] for line in (tmp_path / "out" / name / "board.jsonl").read_text().splitlines()}
        assert all(key.startswith(f"ski/{name}/") for key in keys)
        assert f"ski/{name}/status/process/all" in keys
