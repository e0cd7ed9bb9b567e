"""The robot on worn wheels errs as its file says: over 10 m by 2 % of the way and by 2 degrees, exploring the office."""

import dataclasses

import numpy as np
import pytest

from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions


def test_what_odometry_is_wrong_by_over_ten_metres() -> None:
    mission = load_mission(
        find_mission("wander-lab"), {"robot": {"world": "office", "robot": "k2a_worn", "odometry_errors": True}}
    )
    mission = dataclasses.replace(mission, knowledge_sources=mission.knowledge_sources[:1])  # the odometry's pose
    way_errors, heading_errors = [], []
    for seed in range(2):
        run = Run(mission, RunOptions(seed=seed, strict=True))
        run.run(600.0)
        truth, told = run.true_trajectory(), run.trajectory()
        assert truth is not None
        there = [np.interp(told[:, 0], truth[:, 0], c) for c in (truth[:, 1], truth[:, 2], np.unwrap(truth[:, 3]))]
        way = np.append(0.0, np.hypot(np.diff(there[0]), np.diff(there[1])).cumsum())
        told_way = np.append(0.0, np.hypot(np.diff(told[:, 1]), np.diff(told[:, 2])).cumsum())
        at = np.searchsorted(way, np.arange(0.0, way[-1], 10.0))
        way_errors += list(np.diff(told_way[at]) / np.diff(way[at]) - 1.0)
        heading_errors += list(np.diff(np.unwrap(told[:, 3])[at] - there[2][at]))
    assert len(way_errors) >= 20
    assert np.sqrt(np.mean(np.square(way_errors))) == pytest.approx(0.02, rel=0.15)
    assert np.degrees(np.sqrt(np.mean(np.square(heading_errors)))) == pytest.approx(2.0, rel=0.25)
