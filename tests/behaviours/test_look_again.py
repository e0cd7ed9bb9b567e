"""Going to where a doubt can be resolved: over empty floor only, facing what is in doubt, and leaving it alone afterwards."""

from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.look_again import LookAgain, LookAgainParams, approach, face
from blackboard.access import Access
from blackboard.board import Board
from blackboard.grid import Grid, tile_id
from blackboard.kinds import GRID, ODOM_FROM_ROBOT, RESOLUTION_TASK, ROBOT
from blackboard.messages.conflicts import ResolutionTask
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.motion import Response
from blackboard.messages.sensing import RobotDescription
from blackboard.vocabulary import Vocabulary

PARAMS = LookAgainParams()


class Scene:
    """An empty room of 4 by 4 m with a wall at x = 2 up to y = 3, a robot, and tasks."""

    def __init__(self) -> None:
        self.board = Board(Vocabulary())
        grid = Grid(0.05)
        grid.cover(0.0, 0.0, 3.99, 3.99)
        grid.cells[:80, :80] = 0
        grid.cells[:60, 40] = 255
        for tile in grid.take_changed():
            self.board.post(GRID, tile, id=tile_id(tile), source="grid")
        robot = RobotDescription(
            name="r", radius_m=0.2, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0
        )
        self.board.post(ROBOT, robot, source="robot")
        self.behaviour = LookAgain(PARAMS, name="look_again")
        self.access = Access(self.board, "look_again", self.behaviour.reads, ())

    def task(
        self, id_: str, stand: tuple[float, float] | None, not_before_s: float = 0.0, outcome: str = "open"
    ) -> None:
        value = ResolutionTask(
            hypothesis="ski/r/hypotheses/symbol/trap/1",
            todo="look again",
            outcome=outcome,  # type: ignore[arg-type]
            opened_s=0.0,
            not_before_s=not_before_s,
            until_s=300.0,
            place=Point(x_m=1.0, y_m=3.0),
            stand=None if stand is None else Point(x_m=stand[0], y_m=stand[1]),
        )
        self.board.post(RESOLUTION_TASK, value, id=id_, source="tasks")

    def at(self, now_s: float, x: float, y: float, heading: float = 0.0) -> Response | None:
        self.board.now_s = now_s
        self.board.post(ODOM_FROM_ROBOT, Pose(x_m=x, y_m=y, heading_rad=heading), source="odometry")
        return self.behaviour.respond(self.access)


def test_it_goes_there_faces_the_place_and_rests() -> None:
    scene = Scene()
    assert scene.at(0.0, 1.0, 0.5) is None
    scene.task("1", (1.0, 2.0))
    there = scene.at(1.0, 1.0, 0.5)
    assert there is not None
    assert (there.forward, there.left) == (pytest.approx(0.0, abs=1e-9), pytest.approx(PARAMS.strength))
    seen = {entry.key for entry in scene.access.take_seen()}
    assert "ski/robot/motivations/resolution_task/1" in seen  # what `ski why` tells of it
    turn = scene.at(3.0, 1.0, 1.95)
    assert turn is not None
    assert (turn.forward, turn.turn_radps) == (0.0, PARAMS.turn_radps)
    assert scene.at(4.0, 1.0, 1.95, pi / 2) is not None
    assert scene.at(4.0 + PARAMS.look_s, 1.0, 1.95, pi / 2) is None  # looked long enough
    assert scene.at(20.0, 1.0, 1.95, pi / 2) is None
    later_s = 10.0 + PARAMS.look_s + PARAMS.rest_s
    assert scene.at(later_s, 1.0, 1.95, pi / 2) is not None  # and tries once more later
    assert scene.at(later_s + PARAMS.look_s, 1.0, 1.95, pi / 2) is None
    assert scene.at(later_s + PARAMS.look_s + 1.5 * PARAMS.rest_s, 1.0, 1.95, pi / 2) is None  # and the less often
    assert scene.at(later_s + PARAMS.look_s + 2.5 * PARAMS.rest_s, 1.0, 1.95, pi / 2) is not None


def test_it_is_silent_where_the_way_is_not_empty_or_the_time_has_not_come() -> None:
    scene = Scene()
    scene.task("1", (3.0, 0.5))
    assert scene.at(1.0, 1.0, 0.5) is None  # beyond the wall
    scene.task("2", (1.0, 2.0), not_before_s=100.0)
    scene.task("3", None)
    scene.task("4", (1.5, 0.5), outcome="given up")
    assert scene.at(3.0, 1.0, 0.5) is None
    assert scene.at(101.0, 1.0, 0.5) is not None
    scene.task("2", (1.0, 2.0), outcome="confirmed")
    assert scene.at(101.1, 1.0, 0.6) is None


def test_it_stops_where_the_way_is_blocked_on_the_way() -> None:
    scene = Scene()
    scene.task("1", (1.0, 2.0))
    assert scene.at(1.0, 1.0, 0.5) is not None
    for entry in scene.board.entries(GRID):
        grid = Grid.from_tiles([entry.value])
        assert grid is not None
        grid.cells[25, 10:30] = 255
        scene.board.post(GRID, grid.take_changed()[0], id=entry.id, source="grid")
    assert scene.at(2.5, 1.0, 0.6) is None
    assert scene.at(4.0, 1.0, 0.6) is None


def test_it_gives_up_a_way_that_takes_too_long() -> None:
    scene = Scene()
    scene.task("1", (1.0, 2.0))
    assert scene.at(0.0, 1.0, 0.5) is not None
    assert scene.at(PARAMS.patience_s - 1.0, 1.0, 0.5) is not None
    assert scene.at(PARAMS.patience_s, 1.0, 0.5) is None


@given(st.floats(-9, 9), st.floats(-9, 9), st.floats(-pi, pi))
def test_vectors_point_there_and_never_ask_for_more_than_they_may(x: float, y: float, heading: float) -> None:
    pose = Pose(x_m=1.0, y_m=-1.0, heading_rad=heading)
    response = approach(pose, x, y, PARAMS)
    assert response.forward**2 + response.left**2 <= PARAMS.strength**2 + 1e-9
    dx, dy = pose.transform(response.forward, response.left)
    assert (dx - 1.0) * (x - 1.0) + (dy + 1.0) * (y + 1.0) >= -1e-9
    facing, turn = face(pose, x, y, PARAMS)
    assert abs(turn.turn_radps) <= PARAMS.turn_radps
    assert not facing or abs(turn.turn_radps) < 0.25


def test_selected_anew_it_looks_for_a_task_at_once() -> None:
    scene = Scene()
    scene.task("1", (1.0, 2.0))
    assert scene.at(1.0, 1.0, 0.5) is not None
    scene.behaviour.select(())
    assert scene.at(1.1 + 2 * PARAMS.patience_s, 1.0, 0.5) is not None
