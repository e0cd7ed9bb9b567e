"""What the map of the lab is worth after ten simulated minutes of wander-lab with exact odometry."""

from pathlib import Path

import pytest

from blackboard.command.gather import gather
from blackboard.kinds import GRID, LINE, MAP_FROM_ODOM, ODOM_FROM_ROBOT, SONAR_SCAN
from blackboard.messages.geometry import IDENTITY
from blackboard.mission import find_mission, load_mission
from blackboard.report.result import RunResult
from blackboard.report.scores import grid_score
from blackboard.runner import Run, RunOptions


@pytest.fixture(scope="module")
def run() -> Run:
    settings = {"robot": {"odometry_errors": False, "world": Path("lab"), "robot": Path("k2a")}}
    run = Run(load_mission(find_mission("wander-lab"), settings), RunOptions(strict=True))
    run.run(600.0)
    return run


@pytest.fixture(scope="module")
def result(run: Run) -> RunResult:
    return gather(run, "wander-lab")


def test_decided_cells_are_right(result: RunResult) -> None:
    assert result.grid is not None
    assert result.truth is not None
    score = grid_score(result.grid, result.truth)
    assert (score.right_fraction or 0.0) >= 0.98
    assert (score.empty_right_fraction or 0.0) >= 0.98
    assert (score.occupied_right_fraction or 0.0) >= 0.95
    assert score.occupied >= 400  # some 35 m of wall, half of which or more a ring of sonars hears


def test_the_floor_is_decided(result: RunResult) -> None:
    assert result.table["reachable_decided_fraction"] >= 0.95


def test_walls_are_found(result: RunResult) -> None:
    assert result.table["walls_found_fraction"] >= 0.85


def test_lines_lie_on_walls(result: RunResult) -> None:
    assert result.table["lines_spurious_fraction"] <= 0.10


def test_exact_odometry_is_exact(run: Run) -> None:
    """Were the poses wrong, the figures above would say nothing of the map builder."""
    pose, correction, truth = run.board.newest(ODOM_FROM_ROBOT), run.board.newest(MAP_FROM_ODOM), run.robot.true_pose()
    assert pose is not None
    assert correction is not None
    assert truth is not None
    assert correction.value == IDENTITY
    assert pose.value.distance_m(truth) < 0.03


def test_everything_went_into_the_map(run: Run) -> None:
    newest = run.board.newest(SONAR_SCAN)
    assert newest is not None
    tiles = run.board.entries(GRID)
    scans = [s for tile in tiles for s in tile.supports if s.key == newest.key]
    assert len(scans) == len(tiles)
    assert (min(s.first for s in scans), max(s.last for s in scans)) == (1, newest.revision)
    assert len(run.board.entries(LINE)) > 20
