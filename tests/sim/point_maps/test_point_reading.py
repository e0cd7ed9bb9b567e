"""Files of points: what is read, and what each bad file is told."""

import gzip
from pathlib import Path

import numpy as np
import pytest

from blackboard.errors import RecordingError
from sim.point_maps import reading
from sim.point_maps.reading import read_points

ARIA = """2D-Map
MinPos: -1000 0
NumPoints: 3
Resolution: 20
NumLines: 1
Cairn: Goal -3961 -8481 0.000000 "" ICON "Goal 1"
LINES
-1000 0 2000 500
DATA
-1000 0
0 250
2000 500
"""


def written(tmp_path: Path, text: str, name: str = "a.map") -> Path:
    path = tmp_path / name
    path.write_bytes(gzip.compress(text.encode()) if name.endswith(".gz") else text.encode())
    return path


@pytest.mark.parametrize("name", ["a.map", "a.map.gz", "of_any_name"])
@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_an_aria_map_is_millimetres(tmp_path: Path, name: str, ending: str) -> None:
    found = read_points(written(tmp_path, ARIA.replace("\n", ending), name))
    assert found.points.tolist() == [[-1.0, 0.0], [0.0, 0.25], [2.0, 0.5]]
    assert found.lines.tolist() == [[-1.0, 0.0, 2.0, 0.5]]


def test_an_aria_map_without_lines_or_counts(tmp_path: Path) -> None:
    found = read_points(written(tmp_path, "2D-Map\nDATA\n1000 0\n"))
    assert found.points.tolist() == [[1.0, 0.0]]
    assert found.lines.shape == (0, 4)


@pytest.mark.parametrize(
    "text",
    [
        "1 2\n3 4.5\n",
        "# seen\n1,2\n\n3, 4.5\n",
        "1;2\n3 ; 4.5\n",
        "1\t2\n3\t4.5\n",
        "x,y\n1,2\n3,4.5\n",
        "\ufeffx_m y_m\n1 2\n3 4.5\n",
        '"t","y (m)","x (m)"\n0,2,1\n1,4.5,3\n',
        "1 2 0.7\n3 4.5 0.7\n",
    ],
)
def test_text_of_x_and_y(tmp_path: Path, text: str) -> None:
    assert read_points(written(tmp_path, text, "p.csv")).points.tolist() == [[1.0, 2.0], [3.0, 4.5]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "the file is empty; expected an ARIA map"),
        ("\n\n", "the file is empty"),
        ("# nothing\n", "there is no point in it"),
        ("x,y\n", "there is no point in it"),
        ("1 2\n3\n", "line 2: '3' does not begin with x and y in metres"),
        ("1 2\n3 four\n", "line 2: '3 four' does not begin with x and y"),
        ("t x y\n0 1 2\n1 2\n", "line 3: '1 2' has no number in column 2 or 3; correct it"),
        ("1 2\nnan 3\n", "line 2: a coordinate is not within 10000 m"),
        ("1000000 2\n", "line 1: a coordinate is not within 10000 m of the origin; give metres"),
        ("1 2\n\x00\n", "line 2: no text"),
        ("2D-Map\nNumPoints: 0\nDATA\n", "there is no point in it"),
        (ARIA.replace("0 250\n", ""), "promises 3 lines below DATA and there are 2: the file breaks off"),
        (ARIA.replace("-1000 0 2000 500\n", ""), "promises 1 lines below LINES and there are 0"),
        (ARIA.replace("0 250", "0 two"), "line 11: '0 two' below DATA is not x y in mm; correct or remove the line"),
        (ARIA.replace("2000 500\nDATA", "2000\nDATA"), "line 8: '-1000 0 2000' below LINES is not x1 y1 x2 y2 in mm"),
    ],
)
def test_a_bad_file_is_told_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(RecordingError) as caught:
        read_points(written(tmp_path, text))
    assert said in str(caught.value)
    assert "a.map: " in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_no_file(tmp_path: Path) -> None:
    written(tmp_path, ARIA, "office.map")
    with pytest.raises(RecordingError, match=r"there is no such file; did you mean 'office.map'"):
        read_points(tmp_path / "ofice.map")
    with pytest.raises(RecordingError, match="is a folder; name the file in it"):
        read_points(tmp_path)


def test_a_broken_gzip_file(tmp_path: Path) -> None:
    rows = "".join(f"{x} {y}\n" for x, y in np.random.default_rng(0).uniform(-9.0, 9.0, (2000, 2)))
    whole = gzip.compress(rows.encode())
    (tmp_path / "p.gz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(RecordingError, match=r"breaks off or is damaged after line \d+ .*copy the file again"):
        read_points(tmp_path / "p.gz")


def test_too_many_points(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "MAX_POINTS", 2)
    with pytest.raises(RecordingError, match="line 3: more than 2 points; thin them out"):
        read_points(written(tmp_path, "1 2\n3 4\n5 6\n"))
