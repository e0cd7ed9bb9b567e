"""The object index and `ski find`, on a record made by hand."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from blackboard.board import Board
from blackboard.command.main import main
from blackboard.errors import BoardError
from blackboard.grid import Grid, tile_id
from blackboard.journal import FILE_NAME, JournalWriter, read_journal
from blackboard.kinds import CORNER, GRID, LINE, TARGET, TRAP
from blackboard.messages.geometry import Point
from blackboard.messages.symbols import Corner, Target, Trap
from blackboard.messages.world import Line
from blackboard.object_index import ObjectIndex, read_objects
from blackboard.vocabulary import Vocabulary


def corner(x: float, y: float, shape: str) -> Corner:
    return Corner(
        place=Point(x_m=x, y_m=y), sigma_x_m=0.02, sigma_y_m=0.02, correlation=0.0, opening_rad=1.5, bisector_rad=0.0,
        shape=shape, gap_m=0.0, lines=("a", "b"),  # type: ignore[arg-type]
    )  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Write a record: a line from (0, 1) to (4, 1) on occupied cells, three corners of which one is taken back, a trap."""
    with JournalWriter(tmp_path / FILE_NAME) as journal:
        board = Board(Vocabulary(), robot="k2a", journal=journal)
        grid = Grid(0.05)
        grid.cover(0.0, 0.0, 4.0, 2.0)
        grid.cells[:] = np.where(np.arange(grid.cells.shape[0])[:, None] < 19, 0, 128)
        grid.cells[19:21, :80] = 255
        for tile in grid.take_changed():
            board.post(GRID, tile, id=tile_id(tile), source="grid")
        ends = {"start": Point(x_m=0.0, y_m=1.0), "end": Point(x_m=4.0, y_m=1.0)}
        board.post(LINE, Line(**ends, alpha_rad=1.57, rho_m=1.0, sigma_rho_m=0.02, support=9), id="1-0", source="f")
        board.post(CORNER, corner(0.0, 1.0, "concave"), id="1-2", source="c")
        ends = {"start": Point(x_m=-1e-9, y_m=3.0), "end": Point(x_m=2.0, y_m=2.0)}
        board.post(LINE, Line(**ends, alpha_rad=1.1, rho_m=2.7, sigma_rho_m=0.02, support=9), id="2-0", source="f")
        place, stand = Point(x_m=0.0, y_m=3.0), Point(x_m=1.0, y_m=3.0)
        board.post(TARGET, Target(place=place, stand=stand, reason="frontier", size_m=1.0), id="t-1", source="t")
        board.now_s = 10.0
        entry = board.post(CORNER, corner(4.0, 1.0, "convex"), id="1-3", source="c")
        board.endorse(entry.key, who="c", verdict="for", why="it was seen twice")
        board.post(CORNER, corner(3.0, 1.0, "convex"), id="1-4", source="c")
        trap = Trap(trap="u-shape", place=Point(x_m=2.0, y_m=0.5), size_m=1.0, detail="open towards 90 degrees")
        board.post(TRAP, trap, id="u-1", source="t")
        board.now_s = 20.0
        board.retract(CORNER, "1-4", source="c")
    return tmp_path


def index(folder: Path, at_s: float | None = None) -> ObjectIndex:
    return read_objects(read_journal(folder), Vocabulary(), at_s=at_s)


def ids(found: list[object]) -> list[str]:
    return [o.id for o in found]  # type: ignore[attr-defined]


def test_objects_are_found_by_kind_place_name_area_and_description(folder: Path) -> None:
    objects = index(folder)
    assert ids(objects.find("corner")) == ["1-2", "1-3"]
    assert ids(objects.find("corner", near=(3.0, 1.0))) == ["1-3", "1-2"]
    assert ids(objects.find("corner", near=(3.0, 1.0), within_m=1.5)) == ["1-3"]
    assert ids(objects.find(near=(2.0, 0.6), within_m=0.45)) == ["u-1", "1-0"]  # by the segment, not its middle
    assert ids(objects.find(name="1-2")) == ["1-2"]
    assert ids(objects.find(area=(-1.0, 0.0, 2.5, 0.7))) == ["u-1"]
    assert ids(objects.find("corner", words=["convex"])) == ["1-3"]
    assert ids(objects.find(words=["Open", "degrees"])) == ["u-1"]
    assert objects.find("corner", words=["round"]) == []
    with pytest.raises(BoardError, match="did you mean 'corner'"):
        objects.find("cornr")


def test_what_stood_earlier(folder: Path) -> None:
    assert ids(index(folder, 15.0).find("corner")) == ["1-2", "1-3", "1-4"]
    assert ids(index(folder, 5.0).find("corner")) == ["1-2"]


def test_a_cell_tells_its_state_and_what_it_is_part_of(folder: Path) -> None:
    objects = index(folder)
    assert (objects.cell((2.0, 0.99)).state, objects.cell((2.0, 0.99)).value) == ("occupied", 255)
    assert objects.cell((2.0, 0.5)).state == "empty"
    assert objects.cell((2.0, 1.9)).state == "unknown"
    assert objects.cell((-50.0, 0.0)).state == "unknown"
    assert ids(objects.part_of((2.0, 1.02))) == ["1-0"]
    assert ids(objects.part_of((3.99, 1.0))) == ["1-0", "1-3"]
    assert objects.part_of((2.0, 1.8)) == []


def test_find_on_the_command_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", "corner", "--near", "-1,1", "--in", str(folder)]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith("hypotheses/symbol/corner/1-2 at (0.00, 1.00), 1.00 m away:")
    assert "shape convex" in second
    assert main(["find", "corner", "--name", "1-3", "--in", str(folder), "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert found["kind"] == "hypotheses/symbol/corner"
    assert found["endorsements"] == ["for (c): it was seen twice"]
    assert main(["find", "cell", "--near", "2,0.99", "--in", str(folder)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "(2, 0.99) is occupied (255 of 255)"
    assert said[1].startswith("  part of observations/feature/line/1-0 from (0.00, 1.00) to (4.00, 1.00), 0.01 m away")
    assert main(["find", "line", "--in", str(folder)]) == 0
    assert "/line/2-0 from (0.00, 3.00) to (2.00, 2.00): " in capsys.readouterr().out  # its ends, not its box
    assert main(["find", "target", "--in", str(folder)]) == 0
    assert "at (0.00, 3.00): stand (1.00, 3.00), reason frontier" in capsys.readouterr().out
    assert main(["find", "all", "--words", "nowhere", "--in", str(folder)]) == 0
    assert capsys.readouterr() == ("", "ski: nothing found\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["cornr"], "did you mean 'corner'"),
        (["corner", "--near", "1"], "--near 1: must be X,Y"),
        (["corner", "--near", "1,x"], "--near 1,x: must be X,Y"),
        (["corner", "--near", "1,nan"], "must be X,Y"),
        (["corner", "--within", "1"], "give --near X,Y with it"),
        (["corner", "--near", "1,1", "--within", "-1"], "0 or more"),
        (["corner", "--area", "2,0,1,1"], "x_min,y_min,x_max,y_max"),
        (["cell"], "which cell? give --near X,Y"),
        (["cell", "--near", "1,1", "--words", "convex"], "--words says nothing of a cell"),
        (["corner", "--area", "0,0,1"], "must be X0,Y0,X1,Y1 in metres, such as --area 0,0,4,2.5"),
    ],
)
def test_mistakes_get_one_line(
    arguments: list[str], words: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["find", *arguments, "--in", str(folder)]) == 2
    said = capsys.readouterr()
    assert words in said.err
    assert said.err.count("\n") == 1
    assert said.out == ""


def test_without_a_folder_the_newest_run_is_asked(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["find", "corner"]) == 2
    assert capsys.readouterr().err == "ski: there is no run in runs/; name the output folder of one with --in DIR\n"
    for number, written_s in ((1, 200.0), (2, 100.0)):
        run = tmp_path / f"runs/lab-{number}"
        run.mkdir(parents=True)
        (run / FILE_NAME).write_bytes((folder / FILE_NAME).read_bytes())
        os.utime(run / FILE_NAME, (written_s, written_s))
    assert main(["find", "corner", "--near", "2,3"]) == 0
    said = capsys.readouterr()
    assert said.err == "ski: in runs/lab-1\n"
    assert len(said.out.splitlines()) == 2
    assert main(["why", "hypotheses/symbol/trap/u-1"]) == 0
    assert capsys.readouterr().err == "ski: in runs/lab-1\n"


@pytest.mark.parametrize("text", ["nan", "inf", "x"])
def test_a_time_that_is_none(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for verb in (["find", "corner"], ["why", "hypotheses/symbol/trap/u-1"]):
        assert main([*verb, "--at", text, "--in", str(folder)]) == 2
        assert capsys.readouterr().err == f"ski: --at {text}: must be a number of seconds on the mission's clock\n"
