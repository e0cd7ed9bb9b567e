"""A simulated robot whose process was killed: what is true of its world goes on, and nothing is said twice."""

from pathlib import Path
from typing import Any

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.checkpoint import dumped, loaded
from blackboard.component import Reading
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Drive
from blackboard.vocabulary import Vocabulary
from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams

AHEAD = Drive(forward_mps=0.4, turn_radps=0.3, limited_by="")
MUCH = {"world": Path("lab"), "people": True, "drawn_odometry": True, "disturbances": ("chair", "person", "door")}


def robot(**params: Any) -> SimulatedRobot:
    return SimulatedRobot(SimulatedRobotParams(**params), name="robot", seed=3)


def access(board: Board) -> Access:
    return Access(board, "robot", board.vocabulary, board.vocabulary)


def drive(it: SimulatedRobot, start_s: float, end_s: float) -> list[Reading[Any]]:
    said = []
    for step in range(round(start_s * 10) + 1, round(end_s * 10) + 1):
        it.drive(AHEAD)
        said += list(it.advance(step / 10))
    return said


@pytest.mark.parametrize("params", [{}, MUCH, {"world": Path("lab"), "robot": Path("k2a")}])
@pytest.mark.parametrize("killed_s", [0.5, 12.3, 95.0])
def test_the_world_goes_on_as_if_nothing_had_happened(params: dict[str, Any], killed_s: float) -> None:
    first, second = robot(**params), robot(**params)
    drive(first, -0.1, killed_s)
    second.resume(loaded(dumped(first.state()), Vocabulary()), access(Board(Vocabulary())))
    assert second.true_pose() == first.true_pose()
    assert drive(second, killed_s, killed_s + 8.0) == drive(first, killed_s, killed_s + 8.0)
    assert second.summary() == first.summary()
    assert second.people_at() == first.people_at()


def test_the_wheels_stand_still_until_they_are_commanded_anew() -> None:
    first, second = robot(), robot()
    drive(first, -0.1, 3.0)
    second.resume(first.state(), access(Board(Vocabulary())))
    list(second.advance(5.0))
    there = second.true_pose()
    list(second.advance(9.0))
    assert second.true_pose() == there
    drive(second, 9.0, 10.0)
    assert second.true_pose() != there


def posted(board: Board, readings: list[Reading[Any]]) -> None:
    for reading in readings:
        board.post(reading.kind, reading.value, source="robot", stamp_s=reading.stamp_s)


def test_what_was_said_after_the_state_was_kept_is_not_said_again() -> None:
    first, second, board = robot(), robot(), Board(Vocabulary())
    posted(board, drive(first, -0.1, 4.0))
    kept = dumped(first.state())
    posted(board, drive(first, 4.0, 4.7))
    second.resume(loaded(kept, board.vocabulary), access(board))
    again = drive(second, 4.0, 6.0)
    posted(board, again)  # a stamp that ran back would be refused here
    assert min(reading.stamp_s for reading in again) > 4.7 - 1e-9


def test_without_a_kept_state_it_stands_where_it_is_believed_to_be() -> None:
    first, second, board = robot(odometry_errors=False), robot(odometry_errors=False), Board(Vocabulary())
    posted(board, drive(first, -0.1, 2.0))
    second.resume(None, access(board))
    assert second.true_pose().distance_m(first.true_pose()) < 0.05
    come = drive(second, 2.0, 3.0)
    assert come
    posted(board, come)
    assert second.summary()["collisions"] == 0


def test_it_is_not_put_into_a_wall() -> None:
    it = robot()
    around = it.true_pose()
    for x_m in range(-40, 40):
        board, lost = Board(Vocabulary()), robot()
        reading = next(r for r in drive(robot(), -0.1, 0.0) if r.kind.name == "odometry")
        value = type(reading.value)(
            pose=Pose(x_m=around.x_m + x_m / 4.0, y_m=around.y_m, heading_rad=0.0), forward_mps=0.0, turn_radps=0.0
        )
        board.post(reading.kind, value, source="robot", stamp_s=1.0)
        lost.resume(None, access(board))
        drive(lost, 1.0, 1.2)
        assert lost.summary()["collisions"] == 0


@pytest.mark.parametrize("killed_s", [0.5, 6.0, 12.3])
def test_robots_of_one_world_go_on_as_if_nothing_had_happened(killed_s: float) -> None:
    def pair() -> tuple[SimulatedRobot, SimulatedRobot]:
        starts = {"east": (5.0, 2.4), "west": (3.5, 2.4)}  # the second drives into the first
        east, west = (
            SimulatedRobot(SimulatedRobotParams(start_x_m=x_m, start_y_m=y_m, people=True), name=name, seed=3)
            for name, (x_m, y_m) in starts.items()
        )
        west.join(east)
        return east, west

    def both(robots: tuple[SimulatedRobot, SimulatedRobot], start_s: float, end_s: float) -> list[Reading[Any]]:
        said = []
        for step in range(round(start_s * 10) + 1, round(end_s * 10) + 1):
            robots[0].drive(Drive(forward_mps=0.0, turn_radps=0.3, limited_by="nothing"))
            robots[1].drive(Drive(forward_mps=0.4, turn_radps=0.0, limited_by="nothing"))
            for it in robots:
                said += list(it.advance(step / 10))
        return said

    first, second = pair(), pair()
    both(first, -0.1, killed_s)
    states = [loaded(dumped(it.state()), Vocabulary()) for it in first]
    for it, state in zip(second, states, strict=True):
        it.resume(state, access(Board(Vocabulary())))
    assert both(second, killed_s, killed_s + 6.0) == both(first, killed_s, killed_s + 6.0)
    assert [it.summary() for it in second] == [it.summary() for it in first]
    assert any(it.summary()["met_robots"] for it in first)
