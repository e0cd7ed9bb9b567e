"""Snapshots for the moving picture of a run whose end nobody knows beforehand."""

import numpy as np

from blackboard.command.gather import FRAMES, FrameCollector
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions


def test_a_run_that_ends_early_or_late_has_enough_frames_evenly_over_its_time() -> None:
    run = Run(load_mission(find_mission("wander-lab")), RunOptions())
    collector = FrameCollector(run)
    counts = []
    for cycle in range(400):
        run.cycle()
        collector.note(cycle * 0.1, 7200.0)
        counts.append(len(collector.frames))
    run.close()
    assert counts[FRAMES - 1] == FRAMES
    assert all(FRAMES <= count <= 2 * FRAMES for count in counts[FRAMES:])
    gaps = np.diff([frame.stamp_s for frame in collector.frames])
    assert gaps.max() <= 2.1 * gaps.min()
