"""`ski lines` as a user runs it: a small room in a text file, bad files, and a real office where its map is at hand."""

import json
from pathlib import Path

import numpy as np
import pytest

from blackboard.command.main import main

OFFICE = Path(__file__).resolve().parents[1] / "../shared/data/maps/aria-columbia.map.gz"


@pytest.fixture
def room(tmp_path: Path) -> Path:
    """A room of 4 by 3 m, points every 2 cm with a laser's noise, in a text file."""
    t = np.arange(0.0, 1.0, 0.005)
    sides = [(4 * t, 0 * t), (4 + 0 * t, 3 * t), (4 - 4 * t, 3 + 0 * t), (0 * t, 3 - 3 * t)]
    points = np.concatenate([np.stack(side, axis=1) for side in sides])
    points += np.random.default_rng(0).normal(0.0, 0.01, points.shape)
    path = tmp_path / "room.csv"
    path.write_text("x,y\n" + "".join(f"{x:.4f},{y:.4f}\n" for x, y in points))
    return path


def test_a_room_in_a_text_file(room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for out in ("one", "two"):
        assert main(["lines", str(room), "--out", str(tmp_path / out), "--json"]) == 0
    table = json.loads(capsys.readouterr().out.partition("\n}")[0] + "}")
    assert table["lines"] == 4
    assert "drawn_found_fraction" not in table
    names = sorted(p.name for p in (tmp_path / "one").iterdir())
    assert names == ["board.jsonl", "lines.geojson", "overview.png"]
    for name in names:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    features = json.loads((tmp_path / "one" / "lines.geojson").read_text())["features"]
    assert sorted(round(f["properties"]["length_m"]) for f in features) == [3, 3, 4, 4]
    assert main(["why", f"observations/feature/line/{features[0]['id']}", "--in", str(tmp_path / "one")]) == 0
    assert "supported_points" in capsys.readouterr().out


def test_nothing_moves_in_it(room: Path, tmp_path: Path) -> None:
    assert main(["lines", str(room), "--out", str(tmp_path / "out"), "--gif", "--duration", "5"]) == 0
    assert not (tmp_path / "out" / "map.gif").exists()


def test_faults_are_one_line(room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.txt"
    bad.write_text("1 2\nthere\n")
    assert main(["lines", str(bad), "--out", str(tmp_path / "out")]) == 2
    assert main(["lines", str(tmp_path / "rom.csv"), "--out", str(tmp_path / "out")]) == 2
    assert main(["lines", str(room), "--set", "line_finder.window_m=0", "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 3
    assert "bad.txt: line 2: 'there'" in said[0]
    assert "there is no such file; did you mean 'room.csv'?" in said[1]
    assert "window_m" in said[2]
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(not OFFICE.is_file(), reason=f"there is no {OFFICE}")
def test_the_lines_of_a_real_office(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["lines", str(OFFICE), "--out", str(tmp_path / "out"), "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["drawn_found_fraction"] >= 0.75
    assert table["lines_not_drawn_fraction"] <= 0.30
    assert table["drawn_near_points_fraction"] == pytest.approx(0.90, abs=0.01)
