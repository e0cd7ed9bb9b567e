"""How people walk, wait and turn round."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from blackboard.errors import MissionError
from sim.people import ARM_M, Person, Walker

DT = 0.025


class Disc(NamedTuple):
    x_m: float
    y_m: float
    radius_m: float


FAR = Disc(100.0, 100.0, 0.3)
STROLL = Person(path=((0.0, 0.0), (4.0, 0.0)), speed_mps=0.8, pause_s=0.0)


def walk(walker: Walker, seconds: float, robot: Disc = FAR) -> None:
    for _ in range(round(seconds / DT)):
        walker.walk(DT, [robot])


def walker(person: Person) -> Walker:
    return Walker(person, np.random.default_rng(0))


def test_there_and_back() -> None:
    somebody = walker(STROLL)
    walk(somebody, 2.5)
    assert (somebody.x_m, somebody.y_m) == pytest.approx((2.0, 0.0))
    walk(somebody, 5.0)
    assert somebody.x_m == pytest.approx(2.0, abs=0.05)
    walk(somebody, 2.5)
    assert somebody.x_m == pytest.approx(0.0, abs=0.05)


def test_round_and_round() -> None:
    square = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0))
    somebody = walker(replace(STROLL, path=square))
    seen = []
    for _ in range(8):
        walk(somebody, 1.25)
        seen.append((somebody.x_m, somebody.y_m))
    middles = [(1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1), (0, 0)]
    assert np.array(seen) == pytest.approx(np.array(middles, dtype=float), abs=0.1)
    walk(somebody, 1.25)
    assert (somebody.x_m, somebody.y_m) == pytest.approx((1.0, 0.0), abs=0.15)


def test_pauses_at_waypoints() -> None:
    somebody = walker(replace(STROLL, pause_s=10.0))
    walk(somebody, 5.0 + 4.9)
    assert somebody.x_m == 4.0  # the shortest pause is 5 s
    walk(somebody, 15.0)
    assert somebody.x_m < 4.0


def test_a_courteous_person_stops_an_arms_length_before_the_robot_then_turns_round() -> None:
    somebody = walker(replace(STROLL, patience_s=4.0))
    robot = Disc(3.0, 0.0, 0.3)
    walk(somebody, 4.0, robot)
    assert somebody.waiting
    assert 3.0 - somebody.x_m == pytest.approx(0.3 + 0.25 + ARM_M, abs=0.03)
    walk(somebody, 4.0, robot)
    assert somebody.x_m < 1.9
    assert not somebody.waiting


def test_a_courteous_person_walks_on_when_the_robot_gives_way() -> None:
    somebody = walker(STROLL)
    walk(somebody, 4.0, Disc(3.0, 0.0, 0.3))
    walk(somebody, 1.0)
    assert somebody.x_m > 2.5


def test_the_robot_behind_or_beside_is_not_in_the_way() -> None:
    for robot in (Disc(-0.7, 0.0, 0.3), Disc(2.0, 0.9, 0.3)):
        somebody = walker(STROLL)
        walk(somebody, 2.5, robot)
        assert somebody.x_m == pytest.approx(2.0)


@pytest.mark.parametrize("courteous", [True, False])
def test_nobody_walks_into_the_robot(courteous: bool) -> None:
    somebody = walker(replace(STROLL, courteous=courteous, patience_s=1.0))
    for _ in range(4000):
        somebody.walk(DT, [Disc(2.0, 0.3, 0.3)])
        assert np.hypot(somebody.x_m - 2.0, somebody.y_m - 0.3) >= 0.55


@pytest.mark.parametrize(
    ("key", "value"),
    [("speed_mps", 0.0), ("pause_s", -1.0), ("radius_m", 0.0), ("patience_s", -1.0), ("path", ((0.0, 0.0),))],
)
def test_impossible_people_are_refused(key: str, value: object) -> None:
    with pytest.raises(MissionError, match=key):
        replace(STROLL, **{key: value})  # type: ignore[arg-type]
