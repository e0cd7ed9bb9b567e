"""A mission that ends by its own word: the run stops, says so in one line, and the table has when and why."""

import json
from pathlib import Path

import pytest

from blackboard.command.main import main

SOURCE = '''"""Says after three seconds that nothing is left."""

from blackboard.component import KnowledgeSource
from blackboard.kinds import MISSION, SONAR_SCAN
from blackboard.messages.motion import MissionStatus


class Ender(KnowledgeSource):
    triggers = (SONAR_SCAN,)
    posts = (MISSION,)

    def activate(self, trigger, board):
        if trigger.stamp_s >= {ends_s}:
            board.post(MISSION, MissionStatus(state="done", detail="nothing is left to explore"))
        elif trigger.revision == 1:
            board.post(MISSION, MissionStatus(state="underway"))
'''

MISSION = """
[mission]
duration_s = 6

[robot]
use = "sim.simulated:SimulatedRobot"

[[knowledge_source]]
use = "ender.py:Ender"
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("short.toml").write_text(MISSION)
    return tmp_path


def test_a_mission_that_is_done_says_so(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("ender.py").write_text(SOURCE.format(ends_s=3.0))
    assert main(["run", "short.toml", "--out", "out"]) == 0
    said = capsys.readouterr().out
    assert "short is done after 3.0 s: nothing is left to explore\n" in said
    assert main(["run", "short.toml", "--out", "again", "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert (table["mission"], table["mission_ended_s"]) == ("done", 3.0)
    assert table["mission_detail"] == "nothing is left to explore"
    assert table["time_s"] < 3.2


def test_one_that_is_underway_at_the_end_of_the_time_does_not(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("ender.py").write_text(SOURCE.format(ends_s=300.0))
    assert main(["run", "short.toml", "--out", "out"]) == 0
    said = capsys.readouterr().out
    assert "underway" in said
    assert "short is" not in said
    assert "mission ended" not in said
