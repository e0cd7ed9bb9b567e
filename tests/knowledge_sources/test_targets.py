"""Targets on a board: posted where something is unknown, denied when it is known."""

import numpy as np
import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import KnowledgeSource
from blackboard.entry import Support
from blackboard.errors import MissionError
from blackboard.grid import Grid, tile_id
from blackboard.kinds import GRID, LINE, ODOM_FROM_ROBOT, ROBOT, TARGET
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.sensing import RobotDescription
from blackboard.messages.world import Line
from blackboard.parameters import parse_parameters
from blackboard.vocabulary import Vocabulary
from knowledge_sources.frontier_targets import FrontierTargets, FrontierTargetsParams
from knowledge_sources.line_end_targets import LineEndTargets, LineEndTargetsParams

ROBOT_OF_60_CM = RobotDescription(
    name="k2a", radius_m=0.3, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0
)


class World:
    """A board with a grid that is empty from (0, 0) to (3, 3) behind walls, unknown beyond a door of 1 m in the right one."""

    def __init__(self) -> None:
        self.board = Board(Vocabulary())
        self.board.post(ROBOT, ROBOT_OF_60_CM, source="robot")
        self.grid = Grid(0.05)
        self.grid.cover(-0.5, -0.5, 3.5, 3.5)
        self._fill(-0.1, -0.1, 3.1, 3.1, 255)
        self._fill(0.0, 0.0, 3.0, 3.0, 0)
        self._fill(3.0, 1.0, 3.1, 2.0, 128)
        self.post()

    def _fill(self, x0: float, y0: float, x1: float, y1: float, value: int) -> None:
        columns = [round((x - self.grid.x_min_m) / 0.05) for x in (x0, x1)]
        rows = [round((y - self.grid.y_min_m) / 0.05) for y in (y0, y1)]
        self.grid.cells[rows[0] : rows[1], columns[0] : columns[1]] = value

    def close(self) -> None:
        """Make the door a wall."""
        self._fill(3.0, 1.0, 3.1, 2.0, 255)
        self.post()

    def post(self) -> None:
        """Post what changed."""
        for tile in self.grid.take_changed():
            self.board.post(GRID, tile, id=tile_id(tile), source="grid")

    def line(self, id_: str, x0: float, y0: float, x1: float, y1: float) -> None:
        """Post a line."""
        ends = {"start": Point(x_m=x0, y_m=y0), "end": Point(x_m=x1, y_m=y1)}
        value = Line(**ends, alpha_rad=0.0, rho_m=0.0, sigma_rho_m=0.02, support=30)
        self.board.post(LINE, value, id=id_, source="finder")


def look(world: World, source: KnowledgeSource[object]) -> None:
    tile = world.board.entries(GRID)[0]
    source.activate(tile, Access(world.board, source.name, (LINE, GRID, *source.reads), source.posts))


def test_a_frontier_is_a_target_until_it_is_known() -> None:
    world = World()
    source = FrontierTargets(FrontierTargetsParams(), name="frontiers")
    look(world, source)
    (entry,) = world.board.entries(TARGET)
    target = entry.value
    assert (entry.id, target.reason) == ("frontier-1", "frontier")
    assert (target.place.x_m, target.place.y_m) == pytest.approx((2.975, 1.5), abs=0.03)
    assert target.size_m == pytest.approx(
        0.7, abs=0.06
    )  # of 1 m, where the robot's centre could pass, and 0.1 m beside
    assert target.stand.x_m < 2.8  # where no unknown cell lies within 0.21 m
    assert world.grid.values_at(np.array([[target.stand.x_m, target.stand.y_m]]))[0] == 0
    assert {s.key.split("/")[-2] for s in entry.supports} == {"grid"}
    look(world, source)
    assert len(world.board.history.revisions(Support(entry.key, 1, 9))) == 2  # posted, endorsed; then nothing new
    world.close()
    look(world, source)
    assert world.board.entries(TARGET) == []
    last = world.board.history.revisions(Support(entry.key, 1, 9))[-1]
    assert (last.event, last.endorsements[-1].verdict) == ("retracted", "against")


def test_the_robot_is_no_frontier_to_itself() -> None:
    """Around a robot that has just been switched on there are cells that no cone has swept yet."""
    world = World()
    world.close()
    world._fill(1.2, 1.2, 1.8, 1.8, 128)
    world.post()
    source = FrontierTargets(FrontierTargetsParams(), name="frontiers")
    look(world, source)
    assert world.board.entries(TARGET) != []
    world.board.post(ODOM_FROM_ROBOT, Pose(x_m=1.5, y_m=1.5, heading_rad=0.0), source="odometry")
    look(world, source)
    assert world.board.entries(TARGET) == []


def test_a_robot_too_wide_has_no_target_there() -> None:
    world = World()
    wide = RobotDescription(name="wide", radius_m=0.6, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0)
    world.board.post(ROBOT, wide, source="robot")
    look(world, FrontierTargets(FrontierTargetsParams(), name="frontiers"))
    assert world.board.entries(TARGET) == []


def test_ends_of_lines_near_the_unknown_are_targets_merged_when_near() -> None:
    world = World()
    world.line("lower", 3.0, 0.0, 3.0, 1.0)
    world.line("upper", 3.0, 2.0, 3.0, 3.0)
    world.line("left", 0.0, 0.0, 0.0, 3.0)
    source = LineEndTargets(LineEndTargetsParams(), name="ends")
    look(world, source)
    places = [(e.value.place.x_m, e.value.place.y_m) for e in world.board.entries(TARGET)]
    assert places == [pytest.approx((3.0, 1.0)), pytest.approx((3.0, 2.0))]
    assert all(e.value.reason == "line end" for e in world.board.entries(TARGET))
    assert [s.key.rpartition("/")[2] for s in world.board.entries(TARGET)[0].supports] == ["lower"]
    world.close()
    look(world, source)
    assert world.board.entries(TARGET) == []


def test_the_thesis_takes_every_end() -> None:
    world = World()
    world.line("left", 0.0, 0.0, 0.0, 3.0)
    world.line("lower", 0.1, 0.0, 3.0, 0.0)
    look(world, LineEndTargets(LineEndTargetsParams(only_where_unknown=False), name="ends"))
    places = [(e.value.place.x_m, e.value.place.y_m) for e in world.board.entries(TARGET)]
    assert sorted(places) == [pytest.approx((0.0, 3.0)), pytest.approx((0.05, 0.0)), pytest.approx((3.0, 0.0))]
    assert {e.why for entry in world.board.entries(TARGET) for e in entry.endorsements} == {"lines end there"}


def test_a_tile_that_is_taken_back_is_forgotten() -> None:
    world = World()
    source = FrontierTargets(FrontierTargetsParams(), name="frontiers")
    look(world, source)
    assert len(world.board.entries(TARGET)) == 1
    for entry in world.board.entries(GRID)[1:]:
        world.board.retract(GRID, entry.id, source="grid")
    look(world, source)
    assert all(e.value.place.x_m < 0.1 for e in world.board.entries(TARGET))


def test_parameters() -> None:
    for params, key, value in (
        (FrontierTargetsParams, "depth_cells", 0),
        (FrontierTargetsParams, "interval_s", -1.0),
        (LineEndTargetsParams, "lines", "both"),
        (LineEndTargetsParams, "merge_radii", -1.0),
    ):
        with pytest.raises(MissionError, match=key):
            parse_parameters(params, {key: value}, "m.toml")
