"""Things that are put down and taken away while the robot is there, doors that close, and people who stay a while."""

from pathlib import Path

import numpy as np
import pytest
import shapely

from blackboard.errors import MissionError
from blackboard.kinds import LASER_SCAN
from blackboard.messages.motion import Drive
from sim.people import Person, Walker
from sim.simulated import SimulatedRobot
from sim.simulated_params import SimulatedRobotParams
from sim.world_file import load_world_file

FLOOR = """[floor]
outline = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]
[start]
x_m = 1.0
y_m = 2.0
heading_deg = 0
"""
CHAIR = """[[circle]]
centres = [[3.0, 2.0]]
radius_m = 0.2
from_s = 2.0
until_s = 5.0
"""


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "changing.toml"
    path.write_text(FLOOR + text)
    return path


def robot_in(tmp_path: Path, text: str, *, people: bool = False) -> SimulatedRobot:
    params = SimulatedRobotParams(world=write(tmp_path, text), robot=Path("pioneer"), people=people)
    return SimulatedRobot(params, name="robot", seed=1)


def ahead_m(robot: SimulatedRobot, until_s: float) -> float:
    """Return what the laser's middle beam says last."""
    scans = [r.value for r in robot.advance(until_s) if r.kind is LASER_SCAN]
    return float(scans[-1].ranges_m[90] or np.inf)


def test_a_chair_comes_and_goes(tmp_path: Path) -> None:
    robot = robot_in(tmp_path, CHAIR)
    for _ in range(2):
        assert ahead_m(robot, 1.5) == pytest.approx(5.0, abs=0.1)
        assert shapely.Point(3.0, 2.0).disjoint(robot.truth().solid)
        assert ahead_m(robot, 3.0) == pytest.approx(1.78, abs=0.1)
        assert shapely.Point(3.0, 2.0).within(robot.truth().solid)
        assert ahead_m(robot, 6.0) == pytest.approx(5.0, abs=0.1)
        robot.reset()  # and all over again


def test_what_was_put_down_is_in_the_way(tmp_path: Path) -> None:
    robot = robot_in(tmp_path, CHAIR.replace("until_s = 5.0", ""))
    robot.drive(Drive(forward_mps=0.5, turn_radps=0.0, limited_by="nothing"))
    list(robot.advance(10.0))
    assert robot.true_pose().x_m == pytest.approx(3.0 - 0.2 - 0.26, abs=0.01)
    assert robot.summary()["collisions"] == 1


def test_nothing_is_put_down_on_the_robot(tmp_path: Path) -> None:
    robot = robot_in(tmp_path, CHAIR.replace("[3.0, 2.0]", "[1.1, 2.0]").replace("until_s = 5.0", ""))
    list(robot.advance(3.0))
    here = shapely.Point(1.1, 2.0)
    assert here.disjoint(robot.truth().solid)
    robot.drive(Drive(forward_mps=0.5, turn_radps=0.0, limited_by="nothing"))
    list(robot.advance(6.0))
    assert here.within(robot.truth().solid)  # once it has left
    assert robot.summary()["collisions"] == 0


def test_worlds_by_time(tmp_path: Path) -> None:
    door = (
        "[[wall]]\nline = [[4, 0], [4, 4]]\nfrom_s = 3.0\n[[box]]\ncentre = [5, 1]\nsize = [0.5, 0.5]\nuntil_s = 5.0\n"
    )
    world = load_world_file(write(tmp_path, CHAIR + door))
    assert [at_s for at_s, _ in world.later] == [2.0, 3.0, 5.0]
    assert [len(w.circles) for w in (world, *(w for _, w in world.later))] == [0, 1, 1, 0]
    areas = [w.free.area for w in (world, *(w for _, w in world.later))]
    assert areas == pytest.approx([23.75, 23.75, 23.67, 23.92])


@pytest.mark.parametrize(
    ("was", "by", "says"),
    [("from_s = 2.0", "from_s = -1.0", "from_s"), ("until_s = 5.0", "until_s = 1.0", "after from_s")],
)
def test_impossible_times_are_refused(tmp_path: Path, was: str, by: str, says: str) -> None:
    with pytest.raises(MissionError, match=says):
        load_world_file(write(tmp_path, CHAIR.replace(was, by)))


def test_a_person_stays_exactly_as_long_as_told() -> None:
    walker = Walker(Person(path=((0.0, 0.0), (1.0, 0.0)), stays_s=(3.0, 60.0), speed_mps=1.0), np.random.default_rng(0))
    at = []
    for _ in range(720):
        walker.walk(0.1, [])
        at.append(walker.x_m)
    assert at[28] == 0.0
    assert at[41] == at[630] == 1.0
    assert at[660] < 0.1
    for stays in ((1.0,), (1.0, -1.0)):
        with pytest.raises(MissionError, match="stays_s"):
            Person(path=((0.0, 0.0), (1.0, 0.0)), stays_s=stays)


def test_a_person_does_not_walk_through_a_door_that_was_closed(tmp_path: Path) -> None:
    door = "[[wall]]\nline = [[4, 0], [4, 4]]\nfrom_s = 1.0\n"
    person = "[[person]]\npath = [[5.5, 2.0], [2.5, 2.0]]\nstays_s = [2.0, 0.0]\n"
    robot = robot_in(tmp_path, door + person, people=True)
    list(robot.advance(20.0))
    ((x, _, radius),) = robot.people_at()
    assert x - radius > 4.0


def test_nothing_is_put_down_on_a_person(tmp_path: Path) -> None:
    person = "[[person]]\npath = [[3.1, 2.0], [5.0, 2.0]]\nstays_s = [4.0, 99.0]\n"
    robot = robot_in(tmp_path, CHAIR.replace("until_s = 5.0", "") + person, people=True)
    list(robot.advance(3.0))
    assert shapely.Point(3.0, 2.0).disjoint(robot.truth().solid)
    list(robot.advance(9.0))
    assert shapely.Point(3.0, 2.0).within(robot.truth().solid)
