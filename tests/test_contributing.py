"""The recipes of CONTRIBUTING.md and `ski new` work as they are printed, and are short."""

import re
from pathlib import Path

import pytest

from blackboard.command.main import main
from blackboard.journal import read_journal

TEXT = (Path(__file__).resolve().parents[1] / "CONTRIBUTING.md").read_text(encoding="utf-8")


def block(after: str, language: str) -> str:
    found = re.search(rf"## {after}.*?```{language}\n(.*?)```", TEXT, re.DOTALL)
    assert found is not None
    return found.group(1)


def posts(folder: Path, path: str) -> int:
    return sum(line.key.endswith(path) for line in read_journal(folder))


def test_add_a_knowledge_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = block("Add a knowledge source", "python")
    assert len(source.splitlines()) < 25
    monkeypatch.chdir(tmp_path)
    Path("nearest_echo.py").write_text(source)
    Path("echo.toml").write_text(block("Add a knowledge source", "toml"))
    assert main(["run", "echo.toml", "--duration", "10", "--out", "out"]) == 0
    assert posts(tmp_path / "out", "observations/feature/nearest_echo") > 40  # 5 scans a second
    assert main(["why", "observations/feature/nearest_echo", "--in", "out"]) == 0


def test_add_a_behaviour(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = block("Add a behaviour", "python")
    assert len(source.splitlines()) < 25
    monkeypatch.chdir(tmp_path)
    Path("pirouette.py").write_text(source)
    mission = block("Add a knowledge source", "toml").rpartition("\n\n")[0]
    mission += '\n[[behaviour]]\nuse = "pirouette.py:Pirouette"\n[coordinator]\nuse = "behaviours.superposition:Superposition"\n'
    Path("turn.toml").write_text(mission)
    assert main(["run", "turn.toml", "--duration", "5", "--out", "out"]) == 0
    poses = [line.split() for line in (tmp_path / "out" / "truth.tum").read_text().splitlines()]
    assert abs(float(poses[-1][6])) > 0.3  # it has turned


def test_add_a_rule(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    rule, story = block("Add a rule", "clips"), block("Add a rule", "story")
    assert max(len(rule.splitlines()), len(story.splitlines())) < 25
    monkeypatch.chdir(tmp_path)
    Path("rest.clp").write_text(rule)
    Path("rest.toml").write_text(story)
    assert main(["rules", "check", "rest.clp"]) == 0
    assert "1 file: no errors, no warnings." in capsys.readouterr().out
    assert main(["rules", "test", "rest.toml"]) == 0
    assert "1 of 1 stories are as told" in capsys.readouterr().out
    files = f'rules.files=["arbitration", "{tmp_path / "rest.clp"}"]'
    assert main(["run", "explore-lab", "--set", files, "--duration", "2", "--out", "out"]) == 0
    assert main(["rules", "why-not", "battery-low-stop-wandering", "--in", "out"]) == 0
    assert "kept it from firing" in capsys.readouterr().out


def test_new_knowledge_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "knowledge-source", "echo-counter"]) == 0
    said = capsys.readouterr().out
    table = said.partition("and add:\n\n")[2]
    Path("m.toml").write_text(block("Add a knowledge source", "toml").rpartition("\n\n")[0] + "\n\n" + table)
    assert main(["run", "m.toml", "--duration", "5", "--out", "out"]) == 0
    assert posts(tmp_path / "out", "observations/feature/echo_counter") > 20
    assert main(["new", "knowledge-source", "echo-counter"]) == 2
    assert "echo_counter.py exists already; choose another name" in capsys.readouterr().err
    assert main(["new", "knowledge-source", "2 words"]) == 2
