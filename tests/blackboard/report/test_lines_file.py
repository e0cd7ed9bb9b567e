import json

import pytest

from blackboard.report.lines_file import write_lines


def test_a_line_becomes_a_linestring_with_its_properties(make_line, tmp_path):
    write_lines([make_line(0.0, -2.0, 3.0, -2.0, "7-1")], tmp_path / "lines.geojson")
    read = json.loads((tmp_path / "lines.geojson").read_text())
    (feature,) = read["features"]
    assert feature["geometry"] == {"type": "LineString", "coordinates": [[0.0, -2.0], [3.0, -2.0]]}
    assert feature["properties"] == {
        "id": "7-1",
        "length_m": 3.0,
        "support": 40,
        "sigma_rho_m": 0.02,
        "alpha_deg": pytest.approx(-90.0),
        "rho_m": 2.0,
        "stamp_s": 12.5,
    }


def test_the_file_says_that_its_coordinates_are_local_metres(make_line, tmp_path):
    write_lines([make_line(0.0, 0.0, 1.0, 1.0)], tmp_path / "lines.geojson")
    read = json.loads((tmp_path / "lines.geojson").read_text())
    assert read["type"] == "FeatureCollection"
    assert read["coordinates_in"]["units"] == "m"
    assert read["coordinates_in"]["frame"] == "map"


@pytest.mark.parametrize("count", [0, 1, 5])
def test_any_number_of_lines_is_a_collection(make_line, tmp_path, count):
    lines = [make_line(0.0, i, 1.0, i + 0.25, f"1-{i}") for i in range(count)]
    write_lines(lines, tmp_path / "lines.geojson")
    read = json.loads((tmp_path / "lines.geojson").read_text())
    assert [f["id"] for f in read["features"]] == [f"1-{i}" for i in range(count)]
