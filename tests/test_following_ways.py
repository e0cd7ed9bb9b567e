"""Routes, path-following, avoid-obstacles and safety together, on a map that is right: round traps and through narrow gaps."""

from math import hypot
from pathlib import Path

import numpy as np
import pytest
import shapely

from blackboard.component import WorldTruth
from blackboard.grid import Grid, tile_id
from blackboard.kinds import BEHAVIOUR, GRID, MOTIVATION, ROUTE
from blackboard.messages.motion import BehaviourStatus, Motivation
from blackboard.mission import load_mission
from blackboard.runner import Run, RunOptions

MISSION = """
[robot]
use = "sim.simulated:SimulatedRobot"
world = "{world}"
robot = "k2a"
people = false
start_x_m = {x}
start_y_m = {y}

[[knowledge_source]]
use = "given.py:Given"

[[knowledge_source]]
use = "knowledge_sources.odometry_pose:OdometryPose"
rating = 100

[[knowledge_source]]
use = "knowledge_sources.routes:Routes"

[[behaviour]]
use = "behaviours.avoid_obstacles:AvoidObstacles"

[[behaviour]]
use = "behaviours.path_following:PathFollowing"

[coordinator]
use = "behaviours.arbitration_network:ArbitrationNetwork"
"""
GIVEN = """
from blackboard.component import KnowledgeSource
from blackboard.kinds import GRID, MOTIVATION, ROBOT


class Given(KnowledgeSource):
    triggers = (ROBOT,)
    posts = (GRID, MOTIVATION)  # by the test, in its name

    def activate(self, trigger, board):
        pass
"""
CELL_M = 0.05


class Drive:
    """A robot in a world that it has a map of."""

    def __init__(self, folder: Path, world: str, start: tuple[float, float]) -> None:
        (folder / "given.py").write_text(GIVEN, encoding="utf-8")
        path = folder / "drive.toml"
        path.write_text(MISSION.format(world=world, x=start[0], y=start[1]), encoding="utf-8")
        self.run = Run(load_mission(path), RunOptions(seed=1, strict=True))
        self.run.cycle()
        truth = self.run.robot.truth()
        assert truth is not None
        for tile in drawn(truth).take_changed():
            self.run.board.post(GRID, tile, id=tile_id(tile), source="given")
        self.number = 0

    def go(self, x_m: float, y_m: float, limit_s: float = 90.0) -> BehaviourStatus:
        """Ask for a place; return the status of path-following once that is reached or blocked."""
        board = self.run.board
        self.number += 1
        value = Motivation(on=True, number=self.number, parameters=(x_m, y_m))
        board.post(MOTIVATION, value, id="path_following", source="given")
        until_s = board.now_s + limit_s
        while board.now_s < until_s:
            self.run.cycle()
            status = board.newest(BEHAVIOUR, "path_following")
            if status is not None and status.value.acknowledged == self.number and status.value.outcome != "underway":
                return status.value
        raise AssertionError(f"neither there nor blocked after {limit_s:g} s: {status}")

    @property
    def way_m(self) -> float:
        route = self.run.board.newest(ROUTE)
        assert route is not None
        return route.value.length_m


def drawn(truth: WorldTruth) -> Grid:
    """Return the grid of a world that is known all over: a cell is occupied that a solid thing touches."""
    grid = Grid(CELL_M)
    x0, y0, x1, y1 = truth.floor.bounds
    grid.cover(x0 - 0.2, y0 - 0.2, x1 + 0.2, y1 + 0.2)  # with the walls around
    rows, columns = grid.cells.shape
    x, y = np.meshgrid(
        grid.x_min_m + (np.arange(columns) + 0.5) * CELL_M, grid.y_min_m + (np.arange(rows) + 0.5) * CELL_M
    )
    half = CELL_M / 2 - 1e-6
    touched = shapely.intersects(truth.solid, shapely.box(x - half, y - half, x + half, y + half))
    grid.cells[:] = np.where(touched | ~shapely.contains_xy(truth.floor, x, y), 255, 0)
    return grid


@pytest.mark.parametrize(
    ("start", "goal", "longest_m"),
    [
        ((9.3, 0.5), (10.8, 0.5), 2.0),  # a gap of 0.95 m
        ((9.3, 6.0), (10.8, 6.0), 2.0),  # of 0.75 m
        ((4.8, 4.0), (6.5, 4.0), 9.0),  # out of a U and round it
        ((5.0, 7.5), (7.5, 7.5), 3.0),  # into a dead end, 0.9 m wide
    ],
)
def test_it_gets_through_what_is_wide_enough_and_round_what_is_not(
    tmp_path: Path, start: tuple[float, float], goal: tuple[float, float], longest_m: float
) -> None:
    drive = Drive(tmp_path, "trap", start)
    assert drive.go(*goal).outcome == "reached"
    assert drive.way_m < longest_m
    place = drive.run.robot.true_pose()
    assert place is not None
    assert hypot(place.x_m - goal[0], place.y_m - goal[1]) < 0.35
    assert drive.run.robot.summary()["collisions"] == 0


def test_a_gap_of_half_a_metre_is_no_way(tmp_path: Path) -> None:
    drive = Drive(tmp_path, "trap", (9.3, 3.45))
    assert drive.go(10.8, 3.45).outcome == "reached"
    assert drive.way_m > 6.0  # 1.5 m through the gap
    assert drive.run.robot.summary()["collisions"] == 0


def test_there_and_back_through_the_doors_of_an_office(tmp_path: Path) -> None:
    drive = Drive(tmp_path, "office", (1.5, 1.0))
    for goal in ((3.0, 4.0), (1.5, -2.0), (1.5, 1.0)):
        assert drive.go(*goal).outcome == "reached"
    assert drive.run.robot.summary()["collisions"] == 0


def test_where_no_way_leads_it_says_so(tmp_path: Path) -> None:
    drive = Drive(tmp_path, "trap", (1.2, 4.0))
    status = drive.go(4.0, 9.5)
    assert (status.outcome, status.detail) == ("blocked", "no way there is known")
    assert drive.run.robot.summary()["distance_m"] == 0.0
