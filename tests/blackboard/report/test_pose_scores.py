"""Errors of a path and NEES, worked by hand; and the same through a whole run."""

import json
import subprocess
import sys
from math import pi, radians
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import IDENTITY
from blackboard.mission import find_mission, load_mission
from blackboard.report.pose_log import PoseLog
from blackboard.report.pose_scores import (
    BOUND,
    fitted_frame,
    honesty,
    nees,
    path_error,
    pose_errors,
    pose_table,
    true_poses,
)
from blackboard.runner import Run, RunOptions

TRUTH = np.array([[0.0, 1.0, 2.0, 0.0], [10.0, 11.0, 2.0, 0.2]])


def test_errors_are_plain_differences_at_the_paths_stamps() -> None:
    path = np.array([[0.0, 1.0, 2.0, 0.0], [5.0, 6.3, 2.4, 0.2], [10.0, 11.0, 3.0, 0.1], [11.0, 99.0, 9.0, 0.0]])
    assert pose_errors(path, TRUTH) == pytest.approx(np.array([[0, 0, 0], [0.3, 0.4, 0.1], [0, 1, -0.1]]))
    error = path_error(path, TRUTH)
    assert error is not None
    assert (error.mean_m, error.max_m) == pytest.approx((0.5, 1.0))
    assert (error.heading_mean_rad, error.heading_max_rad) == pytest.approx((0.2 / 3, 0.1))
    rows = {"pose_error_mean_m": 0.5, "pose_error_max_m": 1.0, "heading_error_mean_rad": 0.2 / 3}
    assert pose_table(path, TRUTH) == pytest.approx(rows)
    assert pose_table(path, None) == {}


def test_headings_are_compared_round_the_circle() -> None:
    truth = np.array([[0.0, 0.0, 0.0, pi - 0.1], [1.0, 0.0, 0.0, -pi + 0.1]])
    assert true_poses(np.array([0.5]), truth)[0, 2] == pytest.approx(pi)
    path = np.array([[0.0, 0.0, 0.0, -pi + 0.1], [1.0, 0.0, 0.0, -pi + 0.1]])
    assert pose_errors(path, truth)[:, 2] == pytest.approx([0.2, 0.0])


def test_a_path_of_another_frame_is_laid_on_the_truth_at_its_first_pose() -> None:
    # the truth drives 10 m along x; the path says 10 m along y, starting at (5, 5), and turns by 0.3 instead of 0.2
    path = np.array([[0.0, 5.0, 5.0, pi / 2], [10.0, 5.0, 15.0, pi / 2 + 0.3]])
    assert pose_errors(path, TRUTH, aligned=True) == pytest.approx(np.array([[0, 0, 0], [0, 0, 0.1]]))


def test_paths_without_a_common_stamp_have_no_error() -> None:
    assert path_error(np.array([[20.0, 0.0, 0.0, 0.0]]), TRUTH) is None


def test_nees_by_hand() -> None:
    # independent: (0.2 / 0.1)^2 + (0.3 / 0.3)^2 + (1 degree / 2 degrees)^2 = 4 + 1 + 0.25
    independent = np.diag([0.1**2, 0.3**2, radians(2) ** 2])
    # x and y correlated: P = 0.01 [[2, 1], [1, 2]], P^-1 = 100 / 3 [[2, -1], [-1, 2]];
    # e = (0.3, 0): 100 / 3 * 2 * 0.09 = 6; e = (0.3, 0.3): 100 / 3 * (2 - 1 - 1 + 2) * 0.09 = 6
    correlated = np.diag([0.02, 0.02, 1.0])
    correlated[0, 1] = correlated[1, 0] = 0.01
    errors = np.array([[0.2, -0.3, radians(1)], [0.3, 0.0, 0.0], [0.3, 0.3, 0.0], [0.3, -0.3, 3.0]])
    scores = nees(errors, np.array([independent, correlated, correlated, correlated]))
    assert scores == pytest.approx([5.25, 6.0, 6.0, 18.0 + 9.0])
    told = honesty(scores)
    assert told is not None
    assert (told.instants, told.inside_fraction) == (4, 0.75)
    assert told.nees_mean == pytest.approx((5.25 + 6 + 6 + 27) / 4)
    assert not told.honest  # 11.06 is beyond 7.81, the 95 % bound of chi-square with 3 degrees of freedom
    assert pytest.approx(7.8147, abs=1e-4) == BOUND
    assert honesty(scores[:0]) is None


@given(st.floats(-3.1, 3.1), st.floats(-9, 9), st.floats(-9, 9))
def test_the_fitted_frame_is_the_one_that_the_path_was_moved_by(turn: float, x: float, y: float) -> None:
    truth = np.array([[0.0, 1.0, 2.0, 0.0], [4.0, 3.0, -1.0, 0.5], [9.0, 6.0, 4.0, 1.0]])
    c, s = np.cos(turn), np.sin(turn)
    moved = truth.copy()
    moved[:, 1:3] = truth[:, 1:3] @ np.array([[c, s], [-s, c]]) + (x, y)
    frame = fitted_frame(moved, truth)
    assert (frame.x_m, frame.y_m, frame.heading_rad) == pytest.approx((x, y, turn), abs=1e-9)


def test_two_paths_with_less_than_two_stamps_in_common_are_not_fitted() -> None:
    assert fitted_frame(TRUTH[:1], TRUTH) == IDENTITY


def test_a_covariance_that_is_none_is_no_excuse() -> None:
    assert nees(np.array([[0.1, 0.0, 0.0]]), np.zeros((1, 3, 3)))[0] == np.inf


def test_honest_errors_give_three_on_average() -> None:
    rng = np.random.default_rng(0)
    root = np.array([[0.3, 0.0, 0.0], [0.1, 0.2, 0.0], [0.02, -0.01, 0.03]])
    errors = rng.standard_normal((4000, 3)) @ root.T
    told = honesty(nees(errors, np.broadcast_to(root @ root.T, (4000, 3, 3))))
    assert told is not None
    assert told.nees_mean == pytest.approx(3.0, rel=0.05)
    assert told.inside_fraction == pytest.approx(0.95, abs=0.015)
    assert told.honest


@given(
    x=st.floats(-5, 5),
    y=st.floats(-5, 5),
    turn=st.floats(-3, 3),
    way=st.lists(st.floats(-1, 1), min_size=4, max_size=4),
)
def test_where_a_path_starts_does_not_matter_once_aligned(x: float, y: float, turn: float, way: list[float]) -> None:
    path = np.array([[0.0, 0.0, 0.0, 0.1], [4.0, way[0], way[1], way[2]], [8.0, way[3], way[0], way[1]]])
    c, s = np.cos(turn), np.sin(turn)
    elsewhere = path.copy()
    elsewhere[:, 1:3] = path[:, 1:3] @ np.array([[c, s], [-s, c]]) + (x, y)
    elsewhere[:, 3] += turn
    assert pose_errors(elsewhere, TRUTH, aligned=True) == pytest.approx(
        pose_errors(path, TRUTH, aligned=True), abs=1e-9
    )


def test_a_run_is_scored_against_its_truth() -> None:
    run = Run(load_mission(find_mission("explore-lab-lines")), RunOptions(seed=1, strict=True))
    log = PoseLog(run)
    run.run(60.0)
    truth = run.true_trajectory()
    assert truth is not None
    estimates, covariances = log.estimates()
    assert len(estimates) >= 5
    assert (np.diff(estimates[:, 0]) > 0).all()
    assert covariances == pytest.approx(np.transpose(covariances, (0, 2, 1)))
    assert len(log.nees(truth)) == len(estimates)
    believed, alone = path_error(run.trajectory(), truth), path_error(log.odometry(), truth)
    assert believed is not None
    assert alone is not None
    assert 0.0 < believed.mean_m < alone.mean_m < 0.5
    assert pose_errors(run.trajectory(), truth)[0] == pytest.approx([0, 0, 0], abs=1e-9)  # the map begins at the truth


def test_as_the_scorer_beside_the_recordings_says(tmp_path: Path) -> None:
    tool = Path(__file__).resolve().parents[4] / "shared/tools/trajectory_error.py"
    if not tool.exists():
        pytest.skip(f"{tool} is absent")
    rng = np.random.default_rng(3)
    stamps = np.arange(0.0, 20.0, 0.5)
    truth = np.column_stack([stamps, np.cumsum(rng.normal(0, 0.2, (len(stamps), 3)), axis=0)])
    path = truth + np.column_stack([np.zeros(len(stamps)), np.cumsum(rng.normal(0, 0.02, (len(stamps), 3)), axis=0)])
    for name, rows in (("path", path), ("truth", truth)):
        lines = [
            f"{t:.9f} {x:.9f} {y:.9f} 0 0 0 {np.sin(a / 2):.12f} {np.cos(a / 2):.12f}" for t, x, y, a in rows.tolist()
        ]
        (tmp_path / f"{name}.tum").write_text("\n".join(lines) + "\n")
    said = subprocess.run(
        [sys.executable, tool, tmp_path / "path.tum", tmp_path / "truth.tum", "--json"],
        capture_output=True,
        check=True,
        text=True,
    )
    told, ours = json.loads(said.stdout), path_error(path, truth, aligned=True)
    assert ours is not None
    assert (ours.mean_m, ours.max_m) == pytest.approx((told["mean_m"], told["max_m"]), abs=1e-6)
    assert ours.heading_mean_rad == pytest.approx(radians(told["mean_deg"]), abs=1e-6)
