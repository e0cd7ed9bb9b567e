"""The simulated robot: its readings, their order, determinism, start, bumper, battery; and on a board."""

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import Reading
from blackboard.errors import MissionError
from blackboard.kinds import BATTERY, BUMPER, LASER_SCAN, ODOMETRY, ROBOT, SONAR_SCAN
from blackboard.messages.motion import Drive
from blackboard.vocabulary import Vocabulary
from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams

Params = SimulatedRobotParams
PIONEER = Params(world=Path("office"), robot=Path("pioneer"), people=True)


def robot(params: Params | None = None, seed: int = 0) -> SimulatedRobot:
    return SimulatedRobot(params or Params(), name="robot", seed=seed)


def command(forward: float, turn: float) -> Drive:
    return Drive(forward_mps=forward, turn_radps=turn, limited_by="nothing")


def run(simulated: SimulatedRobot, seconds: float, step_s: float = 0.1) -> list[Reading[Any]]:
    """Drive a wandering course whose commands change every two seconds."""
    readings: list[Reading[Any]] = []
    steps_a_command = round(2.0 / step_s)
    for i in range(round(seconds / step_s)):
        if i % steps_a_command == 0:
            turn = (i // steps_a_command * 7 % 5 - 2) * 0.3
            simulated.drive(command(0.4, turn))
        readings += simulated.advance((i + 1) * step_s)
    return readings


def text(readings: list[Reading[Any]]) -> str:
    return "\n".join(f"{r.kind.path} {r.stamp_s!r} {r.value!r}" for r in readings)


def test_first_readings_and_their_order() -> None:
    first = list(robot(PIONEER).advance(0.0))
    assert [r.kind for r in first] == [ODOMETRY, BUMPER, LASER_SCAN, SONAR_SCAN, BATTERY]
    assert {r.stamp_s for r in first} == {0.0}
    assert robot(PIONEER).provides == (ODOMETRY, BUMPER, LASER_SCAN, SONAR_SCAN, BATTERY)
    assert robot().provides == (ODOMETRY, BUMPER, SONAR_SCAN, BATTERY)


def test_rates_and_stamps() -> None:
    readings = list(robot().advance(20.0))
    stamps = {kind: [r.stamp_s for r in readings if r.kind is kind] for kind in (ODOMETRY, SONAR_SCAN, BATTERY)}
    assert stamps[ODOMETRY] == [i / 10 for i in range(201)]
    assert stamps[SONAR_SCAN] == [i / 5 for i in range(101)]
    assert stamps[BATTERY] == [0.0, 10.0, 20.0]
    assert [r.stamp_s for r in readings] == sorted(r.stamp_s for r in readings)


def test_the_operator_tells_the_robot_where_it_starts() -> None:
    simulated = robot(Params(start_x_m=2.0, start_y_m=1.5, start_heading_rad=3.0))
    odometry = next(r.value for r in simulated.advance(0.0) if r.kind is ODOMETRY)
    assert odometry.pose == simulated.true_pose()
    assert (odometry.pose.x_m, odometry.pose.y_m, odometry.pose.heading_rad) == (2.0, 1.5, 3.0)


def test_exact_odometry_stays_exact_and_the_other_does_not() -> None:
    for errors in (False, True):
        simulated = robot(Params(odometry_errors=errors))
        readings = run(simulated, 20.0)
        told = [r.value.pose for r in readings if r.kind is ODOMETRY][-1]
        away = told.distance_m(simulated.true_pose())
        assert (away == 0.0) != errors
        assert away < 0.1 * float(simulated.summary()["distance_m"])


def test_same_seed_same_readings_other_seed_others() -> None:
    once = text(run(robot(PIONEER, seed=5), 10.0))
    assert once == text(run(robot(PIONEER, seed=5), 10.0))
    assert once != text(run(robot(PIONEER, seed=6), 10.0))


def test_reset_begins_anew() -> None:
    simulated = robot(PIONEER, seed=5)
    once = text(run(simulated, 8.0))
    simulated.reset()
    assert simulated.summary()["distance_m"] == 0.0
    assert once == text(run(simulated, 8.0))


@pytest.mark.parametrize("step_s", [0.025, 0.05, 0.2, 0.5, 0.01])
def test_the_steps_that_time_is_asked_for_in_do_not_matter(step_s: float) -> None:
    assert text(run(robot(seed=2), 8.0, step_s)) == text(run(robot(seed=2), 8.0, 0.1))


def test_readings_come_whether_or_not_anyone_takes_them() -> None:
    simulated = robot()
    simulated.drive(command(0.4, 0.0))
    simulated.advance(2.0)
    assert simulated.true_pose().x_m > 4.5


def test_latency_delays_the_reading_and_not_its_stamp(tmp_path: Path) -> None:
    file = tmp_path / "late.toml"
    shipped = (Path(__file__).resolve().parents[2] / "sim/robots/k2a.toml").read_text()
    file.write_text(shipped.replace("[sonar]\n", "[sonar]\nlatency_s = 0.15\n"))
    simulated = robot(Params(robot=file))
    assert SONAR_SCAN not in [r.kind for r in simulated.advance(0.1)]
    (late,) = [r for r in simulated.advance(0.2) if r.kind is SONAR_SCAN]
    assert late.stamp_s == 0.0


def test_the_bumper_speaks_when_it_changes() -> None:
    simulated = robot(Params(start_x_m=7.0, start_y_m=1.0))
    simulated.drive(command(0.4, 0.0))
    bumps = [r for r in simulated.advance(4.0) if r.kind is BUMPER]
    assert [r.value.bearings_rad for r in bumps] == [(), (0.0,)]
    assert 2.0 < bumps[1].stamp_s < 2.2  # 0.7 m at 0.4 m/s, after speeding up
    simulated.drive(command(0.0, pi / 6))
    bumps = [r for r in simulated.advance(8.0) if r.kind is BUMPER]
    assert bumps[-1].value.bearings_rad[0] < -pi / 4  # the wall is to the right of where it looks now
    simulated.advance(10.0)  # half a turn
    simulated.drive(command(0.4, 0.0))
    assert [r for r in simulated.advance(12.0) if r.kind is BUMPER][-1].value.bearings_rad == ()
    assert simulated.summary()["collisions"] == 1


def test_the_battery_drains_and_an_empty_robot_stands(tmp_path: Path) -> None:
    file = tmp_path / "tired.toml"
    shipped = (Path(__file__).resolve().parents[2] / "sim/robots/k2a.toml").read_text()
    file.write_text(
        shipped.replace("driving_m = 10000.0", "driving_m = 2.0").replace("[battery]", "[battery]\nrate_hz = 10")
    )
    simulated = robot(Params(robot=file, start_heading_rad=pi))
    simulated.drive(command(0.3, 0.0))
    charges = [r.value.charge_fraction for r in simulated.advance(12.0) if r.kind is BATTERY]
    assert charges == sorted(charges, reverse=True)
    assert (charges[0], charges[-1]) == (1.0, 0.0)
    assert float(simulated.summary()["distance_m"]) == pytest.approx(2.0, abs=0.15)


def test_people_walk_only_when_asked_for_and_change_no_other_random_number() -> None:
    alone, accompanied = robot(replace(PIONEER, people=False)), robot(PIONEER)
    assert alone.people_at() == []
    before = accompanied.people_at()
    assert len(before) == 3
    told = [text([r for r in run(simulated, 3.0) if r.kind is ODOMETRY]) for simulated in (alone, accompanied)]
    assert told[0] == told[1]
    assert before != accompanied.people_at()


def test_people_are_heard() -> None:
    alone = [r.value for r in robot(Params(), seed=1).advance(30.0) if r.kind is SONAR_SCAN]
    visited = [r.value for r in robot(Params(people=True), seed=1).advance(30.0) if r.kind is SONAR_SCAN]
    shorter = sum(
        b is not None and (a is None or b < a - 0.3)
        for x, y in zip(alone, visited, strict=True)
        for a, b in zip(x.ranges_m, y.ranges_m, strict=True)
    )
    assert shorter > 50


def test_a_person_in_a_narrow_place_does_not_walk_into_a_robot_that_stands(tmp_path: Path) -> None:
    world = tmp_path / "path.toml"
    world.write_text(
        "[floor]\noutline = [[0, 0], [8, 0], [8, 1.2], [0, 1.2], [0, 0]]\n[start]\nx_m = 4.0\ny_m = 0.6\n"
        "[[person]]\npath = [[1, 0.6], [7, 0.6]]\n"
    )
    simulated = robot(Params(world=world, people=True))
    for i in range(1, 600):
        simulated.advance(i / 10)
        ((x, _y, _radius),) = simulated.people_at()
        assert x < 4.0 - 0.55 - 0.4
    assert simulated.summary()["touched_by_others"] == 0


@settings(deadline=None, max_examples=25)
@given(
    commands=st.lists(st.tuples(st.floats(-1, 1), st.floats(-2, 2)), min_size=1, max_size=10), seed=st.integers(0, 999)
)
def test_whatever_is_commanded_the_robot_stays_on_the_floor_and_its_readings_are_fit(
    commands: list[tuple[float, float]], seed: int
) -> None:
    simulated = robot(Params(world=Path("trap"), people=True), seed)
    truth = simulated.truth()
    vocabulary = Vocabulary()
    board = Board(vocabulary, robot="k2a")
    for i, (forward, turn) in enumerate(commands):
        simulated.drive(command(forward, turn))
        for reading in simulated.advance((i + 1) * 1.5):
            board.now_s = max(board.now_s, reading.stamp_s)
            board.post(reading.kind, reading.value, source="robot", stamp_s=reading.stamp_s)
        pose = simulated.true_pose()
        assert truth.solid.distance(shapely.Point(pose.x_m, pose.y_m)) >= 0.3


def test_its_readings_stand_on_the_board() -> None:
    simulated = robot(PIONEER)
    board = Board(Vocabulary(), robot=simulated.description.name)
    access = Access(board, "robot", (), (ROBOT, *simulated.provides))
    access.post(ROBOT, simulated.description)
    for reading in run(simulated, 3.0):
        board.now_s = max(board.now_s, reading.stamp_s)
        access.post(reading.kind, reading.value, stamp_s=reading.stamp_s)
    scan, description = access.newest(SONAR_SCAN), access.newest(ROBOT)
    assert scan is not None
    assert description is not None
    assert scan.stamp_s == 3.0
    assert len(scan.value.ranges_m) == len(description.value.sonars) == 16
    told = [r for r in scan.value.ranges_m if r is not None]
    assert told == [round(r, 3) for r in told]
    assert max(told) <= 5.0


@pytest.mark.parametrize(
    ("params", "says"),
    [
        ({"start_x_m": 1.0}, "belong together"),
        ({"start_heading_rad": 7.0}, "start_heading_rad = 7.0 is outside"),
        ({"start_x_m": 0.2, "start_y_m": 3.0}, "starts inside a wall or a thing"),
        ({"start_x_m": -3.0, "start_y_m": 3.0}, "starts outside the floor"),
        ({"start_x_m": 1.2, "start_y_m": 3.7, "people": True}, "starts where the robot starts"),
        ({"world": Path("moon")}, "unknown world 'moon'"),
        ({"robot": Path("moon")}, "unknown robot 'moon'"),
    ],
)
def test_what_cannot_be(params: dict[str, Any], says: str) -> None:
    with pytest.raises(MissionError, match=says) as caught:
        robot(Params(**params))
    assert "\n" not in str(caught.value)
