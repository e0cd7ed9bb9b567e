"""The laser graph on whole drives: a simulated one with slipping wheels, and a real recording."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from blackboard.command.gather import gather
from blackboard.command.main import main
from blackboard.kinds import CORRECTED_PATH, GRID
from blackboard.mission import find_mission, load_mission, shipped_missions
from blackboard.runner import Run, RunOptions

SHARED = Path(__file__).resolve().parents[4] / "shared"
INTEL = SHARED / "data" / "laser" / "intel.log.gz"
SEATTLE = SHARED / "data" / "laser" / "seattle.log.gz"


def laser_mission(folder: Path) -> Path:
    """Write wander-lab with a laser, wheels that slip, and the laser graph as its only map builder."""
    text = find_mission("wander-lab").read_text()
    head, tail = text.partition("# Knowledge sources")[0], text.partition("# Behaviours")[2]
    sources = shipped_missions()["map-recording-laser"].read_text().partition("[[knowledge_source]]")
    path = folder / "laser.toml"
    path.write_text(head + sources[1] + sources[2] + "\n#" + tail)
    return path


def test_slipping_wheels_are_corrected(tmp_path: Path) -> None:
    settings = {"robot": {"robot": "pioneer", "odometry_errors": True}}
    run = Run(load_mission(laser_mission(tmp_path), settings), RunOptions(seed=2, strict=True))
    run.run(120)
    truth = run.true_trajectory()
    corrected = run.board.newest(CORRECTED_PATH)
    assert truth is not None
    assert corrected is not None
    path = corrected.value.poses.unpack()
    odometry = np.array([np.interp(truth[:, 0], path[:, 0], path[:, i]) for i in (1, 2)]).T
    error = np.hypot(*(odometry - truth[:, 1:3]).T)
    assert error.mean() < 0.05
    assert error.max() < 0.15
    assert corrected.value.closed
    assert [(e.who, e.verdict) for e in corrected.endorsements] == [("laser_graph", "for")]
    assert len(run.board.entries(GRID)) > 4
    table = gather(run, "laser").table
    assert float(table["lines_spurious_fraction"]) < 0.03
    assert float(table["walls_found_fraction"]) > 0.85
    assert {support.key.rpartition("/")[2] for support in corrected.supports} == {"odom_from_robot", "laser_scan"}


@pytest.mark.skipif(not INTEL.exists(), reason=f"{INTEL} is absent")
def test_intel_closes(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["map", str(INTEL), "--mission", "map-recording-laser", "--out", str(out)]) == 0
    relations = SHARED / "data" / "relations" / "intel.relations"
    tool = [sys.executable, SHARED / "tools" / "relations.py", out / "trajectory.tum", relations]
    done = subprocess.run([*tool, "--odometry", INTEL, "--json"], capture_output=True, text=True, check=True)
    score = json.loads(done.stdout)
    assert score["used"] == score["of"]
    assert score["trans_mean_m"] < 0.06
    assert score["clear_trans_mean_m"] < 0.05


@pytest.mark.skipif(not SEATTLE.exists(), reason=f"{SEATTLE} is absent")
@pytest.mark.parametrize(("cones", "closes"), [(12, True), (2, False)])
def test_cones_close_or_say_that_they_did_not(
    cones: int, closes: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    run = ["map", str(SEATTLE), "--cones", str(cones), "--mission", "map-recording-laser", "--out", str(out), "--json"]
    assert main(run) == 0
    said = capsys.readouterr()
    table = json.loads(said.out)
    assert table["map_closed"] == ("yes" if closes else "not closed: do not trust it")
    assert ("ski: the map did not close" in said.err) == (not closes)
    entries = [json.loads(line) for line in (out / "board.jsonl").read_text().splitlines() if "corrected_path" in line]
    verdicts = [e["verdict"] for entry in entries for e in entry.get("endorsements", ())]
    assert verdicts == ["for" if closes else "against"]
