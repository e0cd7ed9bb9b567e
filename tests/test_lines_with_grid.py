"""The thesis's claim (Bou-Ghannam 1992, section 5.2.2): grid and lines together give better lines."""

import numpy as np
import pytest

from blackboard.kinds import LINE, SUPPORTED_POINTS
from blackboard.mission import find_mission, load_mission
from blackboard.report.result import segments
from blackboard.report.scores import covered
from blackboard.report.walls import sample, wall_edges
from blackboard.runner import Run, RunOptions

SECONDS = 150.0
NEAR_M = 0.10


def on_walls(use_grid: bool, seed: int) -> float:
    """Return the share of the length of the thesis's lines that lies on a wall of the lab, exact odometry."""
    settings = {"line_finder": {"method": "axis"}, "filter_raw": {"use_grid": use_grid}}
    run = Run(load_mission(find_mission("wander-lab"), settings), RunOptions(seed=seed, strict=True))
    run.run(SECONDS)
    truth, batch = run.robot.truth(), run.board.newest(SUPPORTED_POINTS)
    assert truth is not None
    assert batch is not None
    assert (batch.value.dropped > 0) == use_grid
    drawn = sample(segments([entry.value for entry in run.board.entries(LINE)]), 0.05)
    near = covered(drawn.points, drawn.directions, wall_edges(truth), NEAR_M, np.pi / 2)
    return float(drawn.weights_m[near].sum() / drawn.weights_m.sum())


@pytest.mark.parametrize("seed", [0, 1])
def test_lines_are_better_with_the_grid(seed: int) -> None:
    without, with_grid = on_walls(False, seed), on_walls(True, seed)
    print(f"of the lines' length within {NEAR_M} m of a wall: {without:.3f} without the grid, {with_grid:.3f} with it")
    assert with_grid > without + 0.05
