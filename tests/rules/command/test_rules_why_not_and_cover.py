"""`ski rules why-not` and `ski rules cover` on a run through the command line."""

import json
from pathlib import Path

import pytest

from blackboard.command.main import main


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twenty seconds of the exploring robot: it looks around, and begins to wander."""
    folder = tmp_path_factory.mktemp("run") / "out"
    assert main(["run", "explore-lab", "--duration", "20", "--seed", "1", "--out", str(folder)]) == 0
    return folder


def test_why_not(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rules", "why-not", "looked-around-choose", "--at", "5", "--in", str(out)]) == 0
    told = capsys.readouterr().out
    assert "kept it from firing: no fact matches it." in told
    assert "(behaviour (id curiosity)" in told
    assert "outcome is underway, wanted reached" in told
    assert "It had never fired until then." in told
    assert main(["rules", "why-not", "looked-around-choose", "--in", str(out), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["could_fire"], len(data["fired"])) == (False, 1)
    assert main(["rules", "why-not", "look-around-choose", "--in", str(out)]) == 2
    assert "did you mean 'looked-around-choose'?" in capsys.readouterr().err


def test_cover(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rules", "cover", str(out), str(out), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    counts = {rule["rule"]: rule["firings"] for rule in data["rules"]}
    assert data["runs"] == 2
    assert counts["looked-around-choose"] == 2  # once in either
    assert counts["nothing-left-done"] == 0
    assert main(["rules", "cover", str(out / "nowhere")]) == 2
    assert "name the output folder of a run" in capsys.readouterr().err


def test_why_reaches_rule_facts_and_readings(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["why", "commands/drive", "--at", "8", "--in", str(out), "--picture", str(out / "why.png")]) == 0
    told = capsys.readouterr().out
    assert "curiosity was asked to act" in told
    assert "because rule mode-asks-for-behaviour fired at" in told
    assert "it matched (mode look-around), (uses look-around curiosity)" in told
    assert "observations/signal/sonar_scan" in told
    assert (out / "why.png").stat().st_size > 10_000
