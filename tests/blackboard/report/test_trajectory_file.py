import json
import subprocess
import sys
from math import atan2, pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.errors import RecordingError
from blackboard.report.trajectory_file import read_trajectory, write_trajectory

SCORER = Path(__file__).resolve().parents[3] / "../shared/tools/trajectory_error.py"


def read(path: Path) -> np.ndarray:
    """Return stamp, x, y, heading of a TUM file, (n, 4)."""
    rows = [[float(word) for word in line.split()] for line in path.read_text().splitlines()]
    assert all(len(row) == 8 and row[3] == row[4] == row[5] == 0.0 for row in rows)
    return np.array([(r[0], r[1], r[2], 2.0 * atan2(r[6], r[7])) for r in rows]).reshape(-1, 4)


def test_a_quarter_turn_is_written_as_its_quaternion(tmp_path):
    write_trajectory(np.array([[1.5, 2.0, -3.0, pi / 2]]), tmp_path / "trajectory.tum")
    assert (tmp_path / "trajectory.tum").read_text() == "1.500000 2.000000 -3.000000 0 0 0 0.707106781 0.707106781\n"


@given(st.floats(0, 2e9), st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(-pi, pi, exclude_min=True))
def test_what_is_read_back_is_what_was_written(tmp_path_factory, stamp_s, x_m, y_m, heading_rad):
    path = tmp_path_factory.mktemp("tum") / "trajectory.tum"
    write_trajectory(np.array([[stamp_s, x_m, y_m, heading_rad]]), path)
    (row,) = read(path)
    assert row[:3] == pytest.approx([stamp_s, x_m, y_m], abs=2e-6)
    assert abs(np.sin((row[3] - heading_rad) / 2)) < 1e-8
    again = read_trajectory(path)[0]
    assert again[:3] == pytest.approx(row[:3])
    assert abs(np.sin((again[3] - heading_rad) / 2)) < 1e-8


def test_unix_stamps_keep_their_microseconds(tmp_path):
    write_trajectory(np.array([[1763771234.123456, 0.0, 0.0, 0.0]]), tmp_path / "trajectory.tum")
    assert (tmp_path / "trajectory.tum").read_text().split()[0] == "1763771234.123456"


def test_no_poses_make_an_empty_file(tmp_path):
    write_trajectory(np.empty((0, 4)), tmp_path / "trajectory.tum")
    assert (tmp_path / "trajectory.tum").read_text() == ""


@pytest.mark.skipif(not SCORER.exists(), reason=f"{SCORER.name} is not there to read the files with")
def test_the_scorer_reads_both_files(tmp_path, path):
    stretched = path.copy()
    stretched[:, 1] = path[0, 1] + 1.1 * (path[:, 1] - path[0, 1])  # 10 % too long: 0.3 m off after 3 m
    write_trajectory(stretched, tmp_path / "trajectory.tum")
    write_trajectory(path, tmp_path / "truth.tum")
    command = [sys.executable, SCORER, tmp_path / "trajectory.tum", tmp_path / "truth.tum", "--json"]
    error = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    assert error["poses"] == 61
    assert error["length_m"] == pytest.approx(3.0)
    assert error["max_m"] == pytest.approx(0.3, abs=1e-5)
    assert error["max_deg"] == pytest.approx(0.0, abs=1e-6)


def test_a_trajectory_is_read_in_the_order_of_its_stamps(tmp_path):
    path = tmp_path / "truth.tum"
    path.write_text("# stamp x y z qx qy qz qw\n2 1 0 0 0 0 1 0\n\n1 5 6 0.1 0 0 0.6 0.8\n")
    assert read_trajectory(path) == pytest.approx(
        np.array([[1.0, 5.0, 6.0, 2 * np.arctan2(0.6, 0.8)], [2.0, 1.0, 0.0, pi]])
    )
    path.write_text("")
    assert read_trajectory(path).shape == (0, 4)


@pytest.mark.parametrize("text", ["1 2 3\n", "1 2 3 4 5 6 7 x\n", "1 2 3 4 5 6 7 8\n1 2\n"])
def test_what_is_no_trajectory(tmp_path, text):
    path = tmp_path / "truth.tum"
    path.write_text(text)
    with pytest.raises(RecordingError, match=r"truth\.tum: not a trajectory"):
        read_trajectory(path)
    with pytest.raises(RecordingError, match="cannot be read"):
        read_trajectory(tmp_path / "none.tum")
