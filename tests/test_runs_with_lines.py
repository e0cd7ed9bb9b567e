"""A whole run that lines keep straight, against the same run on odometry alone."""

import numpy as np

from blackboard.kinds import COMPONENT, MODEL_LINE, POSE_ESTIMATE
from blackboard.mission import find_mission, load_mission
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
