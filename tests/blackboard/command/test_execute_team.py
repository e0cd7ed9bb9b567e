"""A mission of several robots on the command line: folders, tables, the way to each robot's record, and refusals."""

import json
from pathlib import Path

import pytest

from blackboard.command.main import main
from blackboard.mission import find_mission

FILES = ("board.jsonl", "grid.png", "overview.png", "truth.tum")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("team") / "pair"
    assert main(["run", "explore-lab-pair", "--duration", "10", "--out", str(out), "--json"]) == 0
    return out


def test_each_robot_has_a_folder_and_all_have_a_picture(folder: Path) -> None:
    assert sorted(path.name for path in folder.iterdir()) == ["east", "overview.png", "west"]
    for robot in ("east", "west"):
        assert all((folder / robot / name).stat().st_size > 0 for name in FILES)


def test_tables_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "explore-lab-pair", "--duration", "2", "--out", str(tmp_path / "o"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["team"]["robots"] == "east, west"
    assert told["team"]["out"] == str(tmp_path / "o")
    assert {name: table["robot"] for name, table in told["robots"].items()} == {"east": "east", "west": "west"}
    assert told["team"]["path_m"] == pytest.approx(sum(table["path_m"] for table in told["robots"].values()))


def test_tables_for_people(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "explore-lab-pair", "--duration", "2", "--out", str(tmp_path / "o")]) == 0
    told = capsys.readouterr().out
    assert "east" in told
    assert "all together" in told
    assert f"look at {tmp_path / 'o' / 'overview.png'}" in told.replace("\n", "")


def test_why_is_asked_of_one_robot(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["why", "commands/drive", "--in", str(folder / "west")]) == 0
    assert "sonar_scan" in capsys.readouterr().out
    assert main(["why", "commands/drive", "--in", str(folder)]) == 2
    assert f"is a run of several robots (east, west); name one: --in {folder / 'east'}" in capsys.readouterr().err


def test_a_folder_in_use_and_a_wrong_start_are_refused(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "explore-lab-pair", "--out", str(folder)]) == 2
    assert "is not empty" in capsys.readouterr().err
    assert main(["run", "explore-lab-pair", "--out", str(tmp_path / "o"), "--set", "west.start_x_m=5.0"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert f"{find_mission('explore-lab-pair')}:22: [robot]: start_x_m = 5, start_y_m = 2.4: the robot overlaps" in said
    assert not (tmp_path / "o").exists()
