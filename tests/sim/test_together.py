"""Robots that share a world: what they sense of each other, how they touch, whose time passes, and what is refused."""

from math import cos, hypot, inf, pi, radians, sin, sqrt
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.component import Reading
from blackboard.errors import MissionError
from blackboard.kinds import BLOBS, BUMPER, LASER_SCAN, SONAR_SCAN
from blackboard.messages.motion import Drive
from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams

ROBOT = """
[body]
name = "exact"
radius_m = 0.3
max_speed_mps = 0.5
max_turn_degps = 60.0
max_acceleration_mps2 = 0.6
max_turn_acceleration_radps2 = 2.0
bumper = true

[sonar]
cone_deg = 12.0
max_range_m = 10.0
ring_radius_m = 0.30
bearings_deg = [0, 30, 60, 90, 120, 150, 180, -150, -120, -90, -60, -30]
rate_hz = 5.0
noise_m = 0.0
noise_fraction = 0.0
missed_fraction = 0.0
cross_talk_fraction = 0.0

[[laser]]
beams = 360
field_deg = 360.0
max_range_m = 30.0
noise_m = 0.0

[camera]
field_deg = 60.0
max_range_m = 8.0
noise_rad = 0.0
missed_fraction = 0.0
false_fraction = 0.0
"""

HALL = """
[floor]
outline = [[-10, -10], [10, -10], [10, 10], [-10, 10], [-10, -10]]
"""

Start = tuple[float, float, float]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    here = tmp_path_factory.mktemp("hall")
    (here / "exact.toml").write_text(ROBOT)
    (here / "hall.toml").write_text(HALL)
    return here


def params(folder: Path, start: Start, **more: Any) -> SimulatedRobotParams:
    x_m, y_m, heading_rad = start
    more = {"world": folder / "hall.toml", "robot": folder / "exact.toml", "odometry_errors": False, **more}
    return SimulatedRobotParams(start_x_m=x_m, start_y_m=y_m, start_heading_rad=heading_rad, **more)


def pair(
    folder: Path, first: Start, second: Start, seed: int = 0, **more: Any
) -> tuple[SimulatedRobot, SimulatedRobot]:
    east = SimulatedRobot(params(folder, first, **more), name="east", seed=seed)
    west = SimulatedRobot(params(folder, second, **more), name="west", seed=seed)
    west.join(east)
    return east, west


def newest(robot: SimulatedRobot, until_s: float) -> dict[Any, Any]:
    return {reading.kind: reading.value for reading in robot.advance(until_s)}


def drive(robot: SimulatedRobot, forward_mps: float, turn_radps: float = 0.0) -> None:
    robot.drive(Drive(forward_mps=forward_mps, turn_radps=turn_radps, limited_by="nothing"))


def text(readings: list[Reading[Any]]) -> str:
    return "\n".join(f"{r.kind.path} {r.stamp_s!r} {r.value!r}" for r in readings)


def test_sonar_and_laser_measure_to_the_others_rim(folder: Path) -> None:
    east, west = pair(folder, (0.0, 0.0, 0.0), (3.0, 0.0, 0.0))
    seen, seen_back = newest(east, 0.0), newest(west, 0.0)
    ahead, behind = 0, 6  # of the ring
    assert seen[SONAR_SCAN].ranges_m[ahead] == pytest.approx(3.0 - 2 * 0.3)
    assert seen_back[SONAR_SCAN].ranges_m[behind] == pytest.approx(3.0 - 2 * 0.3)
    assert seen[SONAR_SCAN].ranges_m[behind] == pytest.approx(10.0 - 0.3)
    laser = seen[LASER_SCAN]

    def beam(degrees: float) -> float:
        index = round((radians(degrees) - laser.angle_min_rad) / laser.angle_step_rad - 0.5)
        angle = laser.angle_min_rad + index * laser.angle_step_rad
        off_axis = 3.0 * sin(angle)
        expected = 3.0 * cos(angle) - sqrt(0.09 - off_axis * off_axis) if abs(off_axis) < 0.3 else 10.0 / cos(angle)
        assert laser.ranges_m[index] == pytest.approx(expected, abs=1e-3)
        return expected

    assert beam(0.5) < 2.71
    assert beam(5.5) < 3.0  # asin(0.3 / 3) is 5.7 degrees
    assert beam(6.5) > 10.0


def test_a_robot_does_not_sense_itself(folder: Path) -> None:
    east, _ = pair(folder, (0.0, 0.0, 0.0), (0.0, 5.0, 0.0))
    ranges = newest(east, 0.0)[LASER_SCAN].ranges_m
    assert min(ranges) == pytest.approx(4.7, abs=5e-3)  # the beams lie half a degree off


def test_what_moves_is_seen_where_it_is(folder: Path) -> None:
    east, west = pair(folder, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0))
    drive(west, 0.5)
    newest(east, 5.0)
    away_m = east.true_pose().distance_m(west.true_pose())
    assert away_m > 4.0
    assert newest(east, 5.2)[SONAR_SCAN].ranges_m[0] == pytest.approx(
        east.true_pose().distance_m(west.true_pose()) - 0.6, abs=1e-3
    )


def test_a_robot_hides_what_is_behind_it_from_a_camera(folder: Path, tmp_path: Path) -> None:
    world = tmp_path / "ball.toml"
    world.write_text(HALL + '[[circle]]\ncentres = [[6.0, 0.0]]\nradius_m = 0.2\ncolour = "red"\n')
    east, west = pair(folder, (0.0, 0.0, 0.0), (3.0, 2.0, -pi / 2), world=world)
    assert [blob.colour for blob in newest(east, 0.0)[BLOBS].blobs] == ["red"]
    drive(west, 0.5)
    newest(east, 4.0)  # 2 m at 0.5 m/s, with the time that it takes to come up to that, and to a stop
    drive(west, 0.0)
    assert newest(east, 7.0)[BLOBS].blobs == ()
    assert abs(west.true_pose().y_m) < 0.1


@settings(max_examples=25, deadline=None)
@given(
    commands=st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(-1.0, 1.0)), min_size=1, max_size=5),
    start=st.tuples(st.floats(1.0, 4.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)),
)
def test_mirrored_robots_sense_and_move_mirrored(
    folder: Path, commands: list[tuple[float, float]], start: tuple[float, float, float]
) -> None:
    x_m, y_m, heading_rad = start
    right, left = pair(folder, (x_m, y_m, heading_rad), (-x_m, y_m, pi - heading_rad))
    at_s = 0.0
    for forward_mps, turn_radps in commands:
        drive(right, forward_mps, turn_radps)
        drive(left, forward_mps, -turn_radps)
        at_s += 1.0
        seen, mirrored = newest(right, at_s)[SONAR_SCAN].ranges_m, newest(left, at_s)[SONAR_SCAN].ranges_m
        here, there = right.true_pose(), left.true_pose()
        if here.x_m < 0.35:
            return  # they meet: who drives later finds the other where it has gone to
        assert (there.x_m, there.y_m) == pytest.approx((-here.x_m, here.y_m), abs=1e-6)
        for number in range(12):
            a, b = seen[number], mirrored[-number % 12]
            assert (a or inf) == pytest.approx(b or inf, abs=2e-3)


def contacts(robot: SimulatedRobot) -> tuple[int, int, int]:
    table = robot.summary()
    return int(table["collisions"]), int(table["touched_by_others"]), int(table["met_robots"])


def test_who_drives_into_one_that_stands_has_caused_it(folder: Path) -> None:
    east, west = pair(folder, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0))
    drive(east, 0.5)
    touched = [r.value.bearings_rad for r in east.advance(6.0) if r.kind is BUMPER][-1]
    assert (contacts(east), contacts(west)) == ((1, 0, 1), (0, 1, 1))
    assert touched == pytest.approx((0.0,))
    pushed = [r.value.bearings_rad for r in west.advance(6.0) if r.kind is BUMPER][-1]
    assert [abs(bearing) for bearing in pushed] == pytest.approx([pi])
    drive(east, -0.5)
    east.advance(8.0)
    drive(east, 0.5)
    east.advance(14.0)
    assert (contacts(east), contacts(west)) == ((2, 0, 2), (0, 2, 2))


def test_two_that_drive_into_each_other_have_both_caused_it(folder: Path) -> None:
    east, west = pair(folder, (0.0, 0.0, 0.0), (3.0, 0.0, pi))
    drive(east, 0.4)
    drive(west, 0.4)
    east.advance(8.0)
    assert (contacts(east), contacts(west)) == ((1, 0, 1), (1, 0, 1))


def test_who_is_run_into_from_behind_has_not_caused_it(folder: Path) -> None:
    east, west = pair(folder, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0))
    drive(east, 0.5)
    drive(west, 0.1)
    east.advance(5.0)
    met = contacts(east)[2]  # more than once: it stops, the other goes on, it comes up again
    assert met >= 1
    assert (contacts(east), contacts(west)) == ((met, 0, met), (0, met, met))


@settings(max_examples=20, deadline=None)
@given(commands=st.lists(st.tuples(*[st.floats(-0.5, 0.5)] * 4), min_size=4, max_size=10))
def test_robots_never_stand_inside_each_other(folder: Path, commands: list[tuple[float, ...]]) -> None:
    east, west = pair(folder, (0.0, 0.0, 0.0), (0.7, 0.0, pi))
    for number, (forward, turn, other_forward, other_turn) in enumerate(commands, 1):
        drive(east, forward, turn)
        drive(west, other_forward, other_turn)
        for step in range(20):
            east.advance(0.5 * (number - 1) + 0.025 * (step + 1))
            here, there = east.true_pose(), west.true_pose()
            assert hypot(here.x_m - there.x_m, here.y_m - there.y_m) >= 0.6


def test_time_passes_for_both_whoever_asks_first(folder: Path) -> None:
    told = []
    for first, second in ((0, 1), (1, 0)):
        robots = pair(folder, (0.0, 0.0, 0.0), (3.0, 0.5, 3.0), seed=4, robot=Path("k2a"))
        readings: list[list[Reading[Any]]] = [[], []]
        for cycle in range(40):
            for number in (first, second):
                readings[number] += robots[number].advance(cycle * 0.1)
            for robot in robots:
                drive(robot, 0.3, 0.1)
        told.append([text(one) for one in readings])
    assert told[0] == told[1]
    assert told[0][0] != told[0][1]


def test_nothing_is_told_before_its_time(folder: Path) -> None:
    east, west = pair(folder, (0.0, 0.0, 0.0), (3.0, 0.0, 0.0))
    east.advance(1.0)
    assert max(reading.stamp_s for reading in west.advance(0.5)) == 0.5
    assert {reading.stamp_s for reading in west.advance(1.0) if reading.kind is SONAR_SCAN} == {0.6, 0.8, 1.0}


def test_reset_begins_anew_for_both(folder: Path) -> None:
    east, west = pair(folder, (0.0, 0.0, 0.0), (3.0, 0.0, pi), seed=2, robot=Path("k2a"))
    told = []
    for _ in range(2):
        drive(east, 0.4)
        drive(west, 0.1)
        told.append((text(list(east.advance(6.0))), text(list(west.advance(6.0))), contacts(east)))
        west.reset()
    assert told[0] == told[1]


def test_both_see_the_same_people_who_mind_either_robot(folder: Path, tmp_path: Path) -> None:
    world = tmp_path / "walk.toml"
    world.write_text(
        HALL + '[[person]]\nname = "w"\npath = [[-8.0, 0.0], [8.0, 0.0]]\nspeed_mps = 1.0\npause_s = 0.0\n'
    )
    east, west = pair(folder, (0.0, 5.0, 0.0), (3.0, 0.0, 0.0), world=world, people=True)
    east.advance(12.0)
    ((x_m, y_m, radius_m),) = east.people_at()
    assert west.people_at() == east.people_at()
    assert (x_m, y_m) == pytest.approx((3.0 - 0.3 - radius_m - 0.5, 0.0), abs=0.03)  # at arm's length before the second


def test_nothing_is_put_down_on_the_second_robot(folder: Path, tmp_path: Path) -> None:
    world = tmp_path / "box.toml"
    world.write_text(HALL + "[[box]]\ncentre = [3.0, 0.0]\nsize = [1.0, 1.0]\nfrom_s = 1.0\n")
    east, west = pair(folder, (0.0, 0.0, 0.0), (3.0, 0.0, 0.0), world=world)
    assert newest(east, 2.0)[SONAR_SCAN].ranges_m[0] == pytest.approx(2.4)
    drive(west, 0.5)
    newest(west, 6.0)
    assert newest(east, 6.2)[SONAR_SCAN].ranges_m[0] == pytest.approx(2.5 - 0.3)


def test_nothing_larger_than_the_robot_is_put_down_over_it(folder: Path, tmp_path: Path) -> None:
    world = tmp_path / "large.toml"
    world.write_text(HALL + "[[box]]\ncentre = [0.0, 0.0]\nsize = [3.0, 3.0]\nfrom_s = 1.0\n")
    alone = SimulatedRobot(params(folder, (0.0, 0.0, 0.0), world=world), name="robot")
    assert newest(alone, 2.0)[SONAR_SCAN].ranges_m[0] == pytest.approx(10.0 - 0.3)


def test_three_robots_share_a_world(folder: Path) -> None:
    east, west = pair(folder, (0.0, 0.0, 0.0), (3.0, 0.0, 0.0))
    north = SimulatedRobot(params(folder, (0.0, 4.0, 0.0)), name="north")
    north.join(west)
    left = 3
    assert newest(east, 0.0)[SONAR_SCAN].ranges_m[left] == pytest.approx(4.0 - 0.6)
    assert newest(east, 0.2)[SONAR_SCAN].ranges_m[0] == pytest.approx(3.0 - 0.6)


def test_it_is_called_as_its_mission_calls_it_or_else_as_its_file_does(folder: Path) -> None:
    east, _ = pair(folder, (0.0, 0.0, 0.0), (3.0, 0.0, 0.0))
    assert east.description.name == "east"
    assert SimulatedRobot(params(folder, (0.0, 0.0, 0.0)), name="robot").description.name == "exact"


@pytest.mark.parametrize(
    ("start", "more", "told"),
    [
        ((0.5, 0.0, 0.0), {}, "start_x_m = 0.5, start_y_m = 0: the robot overlaps 'east', which starts at (0, 0)"),
        ((0.605, 0.0, 0.0), {}, "the robot is 0.005 m from 'east'"),
        ((4.0, 2.4, 0.0), {"world": Path("lab")}, "world = 'lab' is not that of 'east'"),
        ((3.0, 0.0, 0.0), {"people": True}, "people = true is not that of 'east', false: robots share a world"),
    ],
)
def test_what_cannot_share_a_world(folder: Path, start: Start, more: dict[str, Any], told: str) -> None:
    east = SimulatedRobot(params(folder, (0.0, 0.0, 0.0)), name="east")
    west = SimulatedRobot(params(folder, start, **more), name="west")
    with pytest.raises(MissionError) as refused:
        west.join(east)
    assert told in str(refused.value)


def test_the_refusal_names_a_place_with_room(folder: Path) -> None:
    east = SimulatedRobot(params(folder, (0.0, 0.0, 0.0)), name="east")
    west = SimulatedRobot(params(folder, (0.0, 0.0, 0.0)), name="west")
    with pytest.raises(MissionError, match=r"for example to \((-?[\d.]+), (-?[\d.]+)\)") as refused:
        west.join(east)
    place = str(refused.value).rsplit("(", 1)[1].split(")")[0]
    x_m, y_m = (float(number) for number in place.split(", "))
    assert hypot(x_m, y_m) > 0.6
