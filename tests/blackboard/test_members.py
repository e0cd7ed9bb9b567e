"""Missions of several robots: what is read, what each robot has of its own, and what is refused, with file and line."""

from pathlib import Path

import pytest

from blackboard.errors import MissionError
from blackboard.members import member, members, share_world
from blackboard.mission import Mission, find_mission, load_mission
from blackboard.placement import placement

ROBOTS = """\
[[robot]]
name = "east"
use = "sim.simulated:SimulatedRobot"
world = "lab"
start_x_m = 5.2
start_y_m = 2.4

[[robot]]
name = "west"
use = "sim.simulated:SimulatedRobot"
world = "lab"
start_x_m = 2.8
start_y_m = 2.4
"""
REST = """
[[knowledge_source]]
use = "knowledge_sources.odometry_pose:OdometryPose"

[[behaviour]]
use = "behaviours.random_wander:RandomWander"

[coordinator]
use = "behaviours.superposition:Superposition"
"""


def load(folder: Path, text: str, settings: dict[str, dict[str, object]] | None = None) -> Mission:
    (folder / "pair.toml").write_text(text + REST)
    return load_mission(folder / "pair.toml", settings)


def refusal(folder: Path, text: str) -> str:
    """Return what is said when the robots cannot be: at reading, building or joining."""
    try:
        missions = members(load(folder, text))
        share_world(missions, [its.robot.build(0) for its in missions])
    except MissionError as refused:
        return str(refused)
    return "nothing"


def test_each_robot_has_a_mission_of_its_own(tmp_path: Path) -> None:
    mission = load(tmp_path, ROBOTS)
    assert [spec.name for spec in mission.team] == ["east", "west"]
    east, west = members(mission)
    assert (east.robot.name, west.robot.name) == ("east", "west")
    assert (east.robot.params.start_x_m, west.robot.params.start_x_m) == (5.2, 2.8)
    assert (east.team, [spec.name for spec in east.behaviours]) == ((), ["random_wander"])
    assert member(mission, "west") == west
    with pytest.raises(MissionError, match="there is no robot 'wst'; did you mean 'west'"):
        member(mission, "wst")


def test_random_numbers_are_each_robots_own_and_the_seeds(tmp_path: Path) -> None:
    east, west = members(load(tmp_path, ROBOTS))
    drawn = [its.behaviours[0].build(seed).rng.random() for its, seed in ((east, 1), (west, 1), (east, 2), (east, 1))]
    assert drawn[0] == drawn[3]
    assert len(set(drawn)) == 3


def test_one_robot_is_its_own_and_only_member(tmp_path: Path) -> None:
    mission = load_mission(find_mission("explore-lab"))
    assert mission.team == ()
    assert members(mission) == (mission,)
    named = load(tmp_path, ROBOTS.partition("\n\n")[0] + "\n")
    assert (named.team, named.robot.name) == ((), "east")
    assert named.robot.build(0).description.name == "east"


def test_settings_go_for_all_robots_or_for_one(tmp_path: Path) -> None:
    settings: dict[str, dict[str, object]] = {"robot": {"people": True}, "west": {"start_y_m": 2.0}}
    east, west = members(load(tmp_path, ROBOTS, settings))
    assert (east.robot.params.people, west.robot.params.people) == (True, True)
    assert (east.robot.params.start_y_m, west.robot.params.start_y_m) == (2.4, 2.0)
    with pytest.raises(MissionError, match=r"--set north\.\.\.: the mission has no component 'north'"):
        load(tmp_path, ROBOTS, {"north": {"people": True}})


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"west"', '"east"', "pair.toml:9: [robot]: the name 'east' is taken"),
        ('name = "west"\n', "", "pair.toml:8: [robot]: each robot needs a name of letters, digits, '_' and '-'"),
        ('"west"', '"../west"', "pair.toml:9: [robot]: each robot needs a name"),
        ('"west"', '"behaviour"', "pair.toml:9: [robot]: the name 'behaviour' is taken"),
        ('"west"', '"random_wander"', "the name 'random_wander' is taken"),
        ("2.8", "5.0", "pair.toml:12: [robot]: start_x_m = 5, start_y_m = 2.4: the robot overlaps 'east'"),
        ("2.8", "0.1", "pair.toml:8: [robot]: "),
        ("2.8", "0.1", "starts inside a wall or a thing; move its start, for example to"),
        ("5.2", "0.1", "pair.toml:1: [robot]: "),
        ("2.8\n", "2.8\npeople = true\n", "pair.toml:13: [robot]: people = true is not that of 'east', false"),
    ],
)
def test_what_is_refused(tmp_path: Path, old: str, new: str, told: str) -> None:
    assert told in refusal(tmp_path, ROBOTS.replace(old, new))


def test_another_world_is_refused(tmp_path: Path) -> None:
    first, _, second = ROBOTS.partition("\n\n")
    text = f"{first}\n\n{second.replace('lab', 'hall').replace('2.8', '5.0').replace('2.4', '4.0')}"
    assert "pair.toml:11: [robot]: world = 'hall' is not that of 'east', 'lab'" in refusal(tmp_path, text)


def test_a_robot_that_cannot_share_a_world_is_refused(tmp_path: Path) -> None:
    (tmp_path / "drive.csv").write_text("")
    (tmp_path / "alone.py").write_text(
        "from blackboard.component import Robot\n"
        "from blackboard.messages.sensing import RobotDescription\n\n\n"
        "class Alone(Robot):\n"
        "    description = RobotDescription(\n"
        '        name="a", radius_m=0.3, max_speed_mps=1, max_turn_radps=1, max_acceleration_mps2=1\n    )\n\n'
        "    def advance(self, until_s):\n        yield from ()\n"
    )
    text = ROBOTS.partition("\n\n")[0] + '\n\n[[robot]]\nname = "west"\nuse = "alone.py:Alone"\n'
    assert "pair.toml:8: [robot]: Alone cannot share a world with another robot" in refusal(tmp_path, text)


def test_hosts_are_each_robots_own_but_the_one_with_the_robots(tmp_path: Path) -> None:
    plans = placement(load(tmp_path, ROBOTS))
    names = ["robot", "east.behaviours", "west.behaviours", "east.knowledge_sources", "west.knowledge_sources"]
    assert [plan.name for plan in plans] == names
    assert [plan.of for plan in plans] == ["", "east", "west", "east", "west"]
    together = placement(load(tmp_path, '[hosts.both]\nruns = ["robot", "behaviours"]\n\n' + ROBOTS))
    assert [plan.name for plan in together] == ["both", "east.knowledge_sources", "west.knowledge_sources"]
    assert together[0].behaviours
