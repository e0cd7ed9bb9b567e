"""Mission files: what is read, what is laid over it, and what is refused, with file and line."""

from math import pi
from pathlib import Path
from typing import Any

import pytest

from blackboard.errors import MissionError
from blackboard.mission import Mission, find_mission, load_mission, parse_settings, shipped_missions
from blackboard.runner import Run

TOYS = """
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from blackboard.component import Behaviour, Coordinator, KnowledgeSource, NoParams, Reading, Robot
from blackboard.kinds import ODOMETRY, ODOM_FROM_ROBOT
from blackboard.messages.geometry import IDENTITY
from blackboard.messages.motion import Response, Velocity
from blackboard.messages.sensing import Odometry, RobotDescription
from blackboard.parameters import require


@dataclass(frozen=True, kw_only=True)
class ToyParams:
    half_width_rad: float = 0.5
    reach_m: float = 2.0
    mode: Literal["near", "far"] = "near"
    count: int = 3
    people: bool = False
    file: Path | None = None
    stops: tuple[float, ...] = ()

    def __post_init__(self):
        require(0 < self.reach_m <= 10, "reach_m", self.reach_m, "(0, 10] metres")
        require(0 < self.half_width_rad <= 1.6, "half_width_rad", self.half_width_rad, "(0, 1.6]")


class ToyRobot(Robot):
    Params = ToyParams
    provides = (ODOMETRY,)
    description = RobotDescription(name="toy", radius_m=0.3, max_speed_mps=1, max_turn_radps=1, max_acceleration_mps2=1)

    def advance(self, until_s):
        yield Reading(ODOMETRY, until_s, Odometry(pose=IDENTITY))


class ToySource(KnowledgeSource):
    Params = ToyParams
    triggers = (ODOMETRY,)
    posts = (ODOM_FROM_ROBOT,)

    def activate(self, trigger, board):
        board.post(ODOM_FROM_ROBOT, trigger.value.pose, supports=[trigger])


class ToyBehaviour(Behaviour):
    def respond(self, board):
        return Response(forward=1.0)


class ToyCoordinator(Coordinator):
    def combine(self, responses, robot, now_s):
        return Velocity(forward_mps=1.0, turn_radps=0.0, valid_until_s=now_s + 1)
"""

MISSION = """\
[mission]
duration_s = 5

[robot]
use = "toys.py:ToyRobot"

[[knowledge_source]]
use = "toys.py:ToySource"
name = "first"
rating = 7
half_width_deg = 45
reach_m = 3

[[knowledge_source]]
use = "toys.py:ToySource"
name = "second"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "toys.py").write_text(TOYS)
    return tmp_path


def load(folder: Path, text: str = MISSION, *settings: str) -> Mission:
    (folder / "m.toml").write_text(text)
    return load_mission(folder / "m.toml", parse_settings(settings))


def refusal(folder: Path, text: str, *settings: str) -> str:
    with pytest.raises(MissionError) as caught:
        load(folder, text, *settings)
    words = str(caught.value)
    assert "\n" not in words
    return words


def test_what_is_read(folder: Path) -> None:
    mission = load(folder)
    first, second = mission.knowledge_sources
    assert (mission.name, mission.params.duration_s, first.rating) == ("m", 5.0, 7)
    assert first.params.half_width_rad == pytest.approx(pi / 4)
    assert (first.params.reach_m, second.params.reach_m) == (3.0, 2.0)
    assert mission.safety is not None
    assert mission.safety.name == "safety"


def test_settings_go_over_the_file(folder: Path) -> None:
    mission = load(folder, MISSION, "first.reach_m=4.5", "mission.step_s=0.05", "second.mode=far", "robot.people=true")
    assert (mission.knowledge_sources[0].params.reach_m, mission.params.step_s) == (4.5, 0.05)
    assert (mission.knowledge_sources[1].params.mode, mission.robot.params.people) == ("far", True)
    assert "did you mean 'first'" in refusal(folder, MISSION, "frist.reach_m=1")
    assert "did you mean 'reach_m'" in refusal(folder, MISSION, "first.reech_m=1")
    for bad in ("reach_m=1", "first.reach_m", "=3"):
        with pytest.raises(MissionError, match=r"must be of the form component\.parameter=value"):
            parse_settings([bad])


def test_files_are_found_beside_the_mission(folder: Path) -> None:
    mission = load(folder, MISSION + 'file = "maps/a.yaml"\nstops = [1, 2.5]\n')
    assert mission.knowledge_sources[1].params.file == folder / "maps/a.yaml"
    assert mission.knowledge_sources[1].params.stops == (1.0, 2.5)
    assert load(folder, MISSION + 'file = "lab"\n').knowledge_sources[1].params.file == Path("lab")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "reach_m = 3",
            "reech_m = 3",
            r"m.toml:12: [knowledge_source]: unknown key 'reech_m'; did you mean 'reach_m'?",
        ),
        ("reach_m = 3", "reach_m = 30", r"m.toml:12: [knowledge_source]: reach_m = 30.0 is outside (0, 10] metres"),
        ("reach_m = 3", 'reach_m = "far"', "m.toml:12: [knowledge_source]: reach_m = 'far' must be float, not str"),
        ("reach_m = 3", "reach_m = nan", "m.toml:12: [knowledge_source]: reach_m = nan must be finite"),
        ("reach_m = 3", "reach_m = true", "reach_m = True must be float, not bool"),
        ("reach_m = 3", 'mode = "middle"', "mode = 'middle' must be one of 'near', 'far'"),
        ("reach_m = 3", "count = 2.5", "count = 2.5 must be int, not float"),
        ("reach_m = 3", "stops = 3", "stops = 3 must be a list"),
        ("reach_m = 3", "half_width_rad = 1", "'half_width_rad' is given twice"),
        ("half_width_deg = 45", "half_width_deg = 200", "m.toml:11: [knowledge_source]: half_width_rad = 3.49"),
        ("[mission]", "[mision]", "m.toml:1: [mision]: unknown table 'mision'; did you mean 'mission'?"),
        ("duration_s = 5", "duration_s = 0", "m.toml:2: [mission]: duration_s = 0.0 is outside (0, 1e7] seconds"),
        ("duration_s = 5", "duration_s = = 5", "m.toml: not valid TOML"),
        (
            "toys.py:ToyRobot",
            "toys.py:ToyRobt",
            "m.toml:5: [robot]: use = 'toys.py:ToyRobt': 'toys.py' has no 'ToyRobt'; did you mean 'ToyRobot'?",
        ),
        ("toys.py:ToyRobot", "toys.py:ToySource", "ToySource is no Robot"),
        ("toys.py:ToyRobot", "toyz.py:ToyRobot", "toyz.py'; the path is relative to the mission file"),
        (
            "toys.py:ToyRobot",
            "blackboard.bord:X",
            "there is no module 'blackboard.bord'; did you mean 'blackboard.board'?",
        ),
        ("toys.py:ToyRobot", "toys.py", "must be 'package.module:Class' or 'file.py:Class'"),
        ('use = "toys.py:ToyRobot"', "", "m.toml:4: [robot]: 'use' is missing"),
        ('[robot]\nuse = "toys.py:ToyRobot"', "", "there is no [robot] table"),
        ('name = "second"', 'name = "first"', "m.toml:15: [knowledge_source]: the name 'first' is taken"),
        ('name = "second"', 'name = "a b"', "m.toml:16: [knowledge_source]: name = 'a b'"),
        ("rating = 7", 'rating = "high"', "m.toml:10: [knowledge_source]: rating = 'high' must be a number"),
        ("[[knowledge_source]]", "[knowledge_source]", "m.toml"),
    ],
)
def test_refusals(folder: Path, old: str, new: str, words: str) -> None:
    assert old in MISSION
    assert words in refusal(folder, MISSION.replace(old, new))


def test_the_safety_layer_cannot_be_left_out(folder: Path) -> None:
    text = MISSION + '\n[safety]\nuse = "toys.py:ToyBehaviour"\n'
    assert "the safety layer cannot be replaced" in refusal(folder, text)


BEHAVIOURS = """
[[behaviour]]
use = "toys.py:ToyBehaviour"
name = "high"
inhibits = ["low"]

[[behaviour]]
use = "toys.py:ToyBehaviour"
name = "low"

[coordinator]
use = "toys.py:ToyCoordinator"
"""


def test_inhibition_goes_downwards(folder: Path) -> None:
    mission = load(folder, MISSION.partition("[[")[0] + BEHAVIOURS)
    assert mission.behaviours[0].wiring.inhibits == ("low",)
    assert "there is no behaviour 'lov'; did you mean" in refusal(
        folder, MISSION + BEHAVIOURS.replace('["low"]', '["lov"]')
    )
    assert "must stand before 'high'" in refusal(folder, MISSION + BEHAVIOURS.replace('["low"]', '["high"]'))
    assert "behaviours need a [coordinator]" in refusal(folder, MISSION + BEHAVIOURS.partition("[coordinator]")[0])


def test_a_broken_file_is_shown(folder: Path) -> None:
    (folder / "broken.py").write_text("import nothing_of_that_name\n")
    assert "broken.py' cannot be imported (ModuleNotFoundError" in refusal(
        folder, MISSION.replace("toys.py:ToyRobot", "broken.py:ToyRobot")
    )


def test_a_component_from_a_single_file_runs(folder: Path) -> None:
    text = MISSION.replace('[[knowledge_source]]\nuse = "toys.py:ToySource"\nname = "second"\n', "")
    run = Run(load(folder, text))
    run.run()
    assert len(run.trajectory()) == 51  # a pose every 0.1 s of 5 s, both ends included
    assert run.sources[0].rating == 7.0


def test_shipped_missions_are_found_by_name() -> None:
    assert set(shipped_missions()) >= {"wander-lab", "map-recording"}
    with pytest.raises(MissionError, match="there is no mission 'explore-lap'; did you mean 'explore-lab'"):
        find_mission("explore-lap")
    with pytest.raises(MissionError, match=r"there is no mission file 'x\.toml'"):
        find_mission("x.toml")


def test_unreadable_files(tmp_path: Path) -> None:
    cases: list[tuple[Any, str]] = [(b"\xff\xfe", "cannot be read"), (b"[mission", "not valid TOML")]
    for data, words in cases:
        (tmp_path / "m.toml").write_bytes(data)
        with pytest.raises(MissionError, match=words):
            load_mission(tmp_path / "m.toml")
    with pytest.raises(MissionError, match="this is a folder"):
        load_mission(tmp_path)
