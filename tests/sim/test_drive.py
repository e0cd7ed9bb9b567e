"""The body: speeds, arcs, and contact with walls and people."""

from dataclasses import replace
from math import cos, inf, pi, sin

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.messages.geometry import Pose
from sim.drive import Base, arc
from sim.people import Person, Walker
from sim.sensor_models import Body
from sim.shapes import Shapes, shapes_around

DT = 0.025
BODY = Body(
    name="round",
    radius_m=0.3,
    max_speed_mps=0.5,
    max_turn_radps=1.0,
    max_acceleration_mps2=0.5,
    max_turn_acceleration_radps2=2.0,
)
FREE = shapely.box(0, 0, 8, 5).difference(shapely.box(5, 1, 6, 2))


def room(circles: tuple[tuple[float, float, float], ...] = ()) -> Shapes:
    rows = np.array(circles, dtype=float).reshape(-1, 3)
    return shapes_around(FREE, shapely.Polygon(), rows, np.zeros(len(rows), dtype=bool))


def base(x: float, y: float, heading: float = 0.0, circles: tuple[tuple[float, float, float], ...] = ()) -> Base:
    return Base(BODY, room(circles), Pose(x_m=x, y_m=y, heading_rad=heading))


def go(robot: Base, forward: float, turn: float, seconds: float, walkers: tuple[Walker, ...] = ()) -> None:
    for _ in range(round(seconds / DT)):
        for walker in walkers:
            walker.walk(DT, [robot])
        robot.step(DT, forward, turn, walkers)


def test_an_arc_is_a_circles() -> None:
    x, y, heading = arc(1.0, 2.0, 0.0, pi, pi / 2)  # radius 2, a quarter
    assert (x, y, heading) == pytest.approx((3.0, 4.0, pi / 2))
    assert arc(0.0, 0.0, 1.0, 2.0, 0.0) == pytest.approx((2 * cos(1.0), 2 * sin(1.0), 1.0))


def test_speed_rises_and_falls_at_its_limits() -> None:
    robot = base(1.0, 3.0)
    go(robot, 9.0, 0.0, 1.0)
    assert robot.forward_mps == pytest.approx(0.5)
    assert robot.x_m == pytest.approx(1.25)  # half a m/s^2 for one second
    go(robot, 9.0, 0.0, 1.0)
    assert robot.x_m == pytest.approx(1.75)
    go(robot, 0.0, 0.0, 2.0)
    assert (robot.forward_mps, robot.x_m) == pytest.approx((0.0, 2.0))
    go(robot, 0.0, -9.0, 1.0)
    assert robot.turn_radps == pytest.approx(-1.0)
    assert robot.heading_rad == pytest.approx(-0.75)
    assert robot.distance_m == pytest.approx(1.0)


def test_a_wall_stops_the_robot_and_counts_once() -> None:
    robot = base(6.5, 4.0)
    go(robot, 0.5, 0.0, 10.0)
    assert 7.699 < robot.x_m <= 7.7
    assert robot.forward_mps == 0.0
    assert robot.contacts.caused == 1
    assert robot.contacts.bearings_rad == pytest.approx((0.0,), abs=1e-6)


def test_it_can_turn_and_drive_away_and_touch_again() -> None:
    robot = base(6.5, 4.0)
    go(robot, 0.5, 0.0, 5.0)
    go(robot, 0.0, 1.0, 1.0)
    assert robot.heading_rad > 0.5
    go(robot, -0.3, 0.0, 2.0)
    assert robot.contacts.bearings_rad == ()
    assert robot.x_m < 7.5
    go(robot, 0.5, 0.0, 5.0)
    assert robot.contacts.caused == 2
    assert robot.contacts.by_others == 0


def test_two_walls_at_once_are_two_contacts() -> None:
    robot = base(7.3, 4.3, pi / 4)
    go(robot, 0.5, 0.0, 5.0)
    go(robot, 0.0, 0.0, 0.1)
    assert robot.contacts.caused == 2
    assert robot.contacts.bearings_rad == pytest.approx((0.0, pi / 2), abs=1e-6)


def test_a_drum_and_a_corner_are_touched_at_their_surface() -> None:
    robot = base(1.0, 3.0, 0.0, ((3.0, 3.0, 0.4),))
    go(robot, 0.5, 0.0, 6.0)
    assert robot.x_m == pytest.approx(3.0 - 0.7, abs=1e-3)
    robot = base(4.0, 2.0, 0.0)
    go(robot, 0.5, 0.0, 6.0)
    assert np.hypot(5 - robot.x_m, 0) == pytest.approx(0.3, abs=1e-3)


@settings(deadline=None, max_examples=60)
@given(
    commands=st.lists(st.tuples(st.floats(-1, 1), st.floats(-2, 2), st.floats(0.1, 3.0)), max_size=12),
    heading=st.floats(-pi, pi),
)
def test_no_command_drives_the_robot_into_a_thing(commands: list[tuple[float, float, float]], heading: float) -> None:
    robot = base(4.4, 1.5, heading, ((3.5, 3.0, 0.2),))
    walker = Walker(Person(path=((1.0, 2.2), (7.0, 2.5)), courteous=False, pause_s=0.0), np.random.default_rng(0))
    solid = FREE.difference(shapely.Point(3.5, 3.0).buffer(0.2, quad_segs=64)).boundary
    for forward, turn, seconds in commands:
        for _ in range(round(seconds / DT)):
            go(robot, forward, turn, DT, (walker,))
            assert solid.distance(shapely.Point(robot.x_m, robot.y_m)) >= 0.3
            assert FREE.contains(shapely.Point(robot.x_m, robot.y_m))
            assert np.hypot(walker.x_m - robot.x_m, walker.y_m - robot.y_m) >= 0.55
            assert robot.distance_m < inf


def test_a_person_without_manners_touches_the_standing_robot_and_it_is_not_its_fault() -> None:
    robot = base(4.0, 3.5)
    walker = Walker(Person(path=((1.0, 3.5), (7.0, 3.5)), courteous=False), np.random.default_rng(0))
    go(robot, 0.0, 0.0, 6.0, (walker,))
    assert (robot.contacts.caused, robot.contacts.by_others) == (0, 1)
    assert robot.contacts.bearings_rad == pytest.approx((pi,), abs=1e-6)
    go(robot, 0.0, 0.0, 6.0, (walker,))  # who has turned round by now
    assert robot.contacts.bearings_rad == ()
    assert robot.contacts.by_others == 1


def test_driving_into_a_person_is_the_robots_fault() -> None:
    robot = base(2.0, 3.5)
    walker = Walker(Person(path=((4.0, 3.5), (4.0, 4.5)), speed_mps=0.01, pause_s=0.0), np.random.default_rng(0))
    go(robot, 0.5, 0.0, 8.0, (walker,))
    assert robot.contacts.caused == 1
    assert robot.contacts.by_others == 0


def test_a_body_larger_than_the_look_around_moves_freely() -> None:
    large = replace(BODY, radius_m=2.2)
    empty = shapes_around(shapely.box(0, 0, 30, 30), shapely.Polygon(), np.zeros((0, 3)), np.zeros(0, dtype=bool))
    robot = Base(large, empty, Pose(x_m=10.0, y_m=10.0, heading_rad=0.0))
    go(robot, 0.5, 0.0, 60.0)
    assert robot.x_m == pytest.approx(27.8, abs=1e-3)
    assert robot.contacts.caused == 1


def test_driving_off_into_a_wall_that_is_all_but_touched_counts() -> None:
    robot = base(7.6985, 4.0)
    go(robot, 0.5, 0.0, 1.0)
    assert robot.contacts.caused == 1
