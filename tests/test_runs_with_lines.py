"""A whole run that lines keep straight, against the same run on odometry alone."""

import numpy as np

from blackboard.entry import Entry
from blackboard.kinds import COMPONENT, MAP_FROM_ODOM, MODEL_LINE, POSE_ESTIMATE, RE_REFERENCE
from blackboard.messages.geometry import Pose
from blackboard.messages.model import ReReference
from blackboard.mission import find_mission, load_mission
from blackboard.report.pose_log import PoseLog
from blackboard.report.pose_scores import honesty, path_error
from blackboard.runner import Run, RunOptions


def test_lines_hold_the_pose_in_the_lab() -> None:
    run = Run(load_mission(find_mission("explore-lab-lines")), RunOptions(seed=0, strict=True))
    odometry: list[tuple[float, float]] = []
    run.board.subscribe(
        f"ski/{run.board.robot}/observations/feature/odom_from_robot",
        lambda entry: odometry.append((entry.value.x_m, entry.value.y_m)),
    )
    run.run(400.0)
    truth, believed = run.true_trajectory(), run.trajectory()
    assert truth is not None
    there = np.column_stack([np.interp(believed[:, 0], truth[:, 0], truth[:, k]) for k in (1, 2)])
    with_lines = np.hypot(*(believed[:, 1:3] - there).T).mean()
    alone = np.hypot(*(np.array(odometry) - there).T).mean()
    assert alone > 0.3
    assert with_lines < 0.3 * alone
    assert len(run.board.entries(MODEL_LINE)) > 5
    assert run.board.newest(POSE_ESTIMATE) is not None
    assert not [e for e in run.board.entries(COMPONENT) if e.value.state == "failed"]


def test_one_estimate_of_pose_and_lines_is_nearer_and_honest() -> None:
    run = Run(load_mission(find_mission("explore-lab-joint")), RunOptions(seed=1, strict=True))
    log = PoseLog(run)
    moves: list[Entry[Pose]] = []
    sizes_told: list[Entry[ReReference]] = []
    run.board.subscribe(run.board.key(MAP_FROM_ODOM), moves.append)
    run.board.subscribe(run.board.key(RE_REFERENCE), sizes_told.append)
    run.run(300.0)
    truth = run.true_trajectory()
    assert truth is not None
    alone, held = path_error(log.odometry(), truth), path_error(run.trajectory(), truth)
    assert alone is not None
    assert held is not None
    assert alone.mean_m > 0.2
    assert held.mean_m < min(0.3 * alone.mean_m, 0.06)
    honest = honesty(log.nees(truth))
    assert honest is not None
    assert honest.inside_fraction > 0.8
    lines = run.board.entries(MODEL_LINE)
    assert len(lines) > 5
    assert not [e for e in run.board.entries(COMPONENT) if e.value.state == "failed"]
    assert len(moves) > 100
    stand_on = [[support.key.split("/")[4] for support in entry.supports] for entry in moves[1:]]
    assert {kinds[0] for kinds in stand_on} == {"sonar_scan", "line_set"}
    assert all("model_line" in kinds for kinds in stand_on if kinds[0] == "sonar_scan")
    sizes = {entry.supports for entry in sizes_told if entry.value.applied}
    assert all(entry.supports in sizes for entry in moves[1:])  # each move of the odometry frame with its size
