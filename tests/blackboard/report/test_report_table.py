import io
import json
from math import inf, nan, pi

import pytest
from rich.console import Console

from blackboard.report.table import describe, show_table, table_json


@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [
        ("path_m", 12.345, ("path", "12.35 m")),
        ("time_s", 2691.25, ("time", "2,691.2 s")),
        ("grid_right_fraction", 0.9876, ("grid right", "98.8 %")),
        ("known_area_m2", 33.04, ("known area", "33.0 m²")),
        ("heading_error_rad", pi / 2, ("heading error", "90.0°")),
        ("collisions", 0, ("collisions", "0")),
        ("posts", 1234567, ("posts", "1,234,567")),
        ("robot", "k2a", ("robot", "k2a")),
        ("mean_speed_mps", 0.25, ("mean speed", "0.25 m/s")),
        ("odd_m", "none", ("odd m", "none")),
    ],
)
def test_units_are_read_off_the_names(name, value, shown):
    assert describe(name, value) == shown


def test_the_table_is_shown_in_its_order_and_takes_markup_literally():
    screen = io.StringIO()
    show_table({"robot": "[red]k2a", "path_m": 3.0}, "wander-lab", Console(file=screen, width=60))
    text = screen.getvalue()
    assert "wander-lab" in text
    assert text.index("[red]k2a") < text.index("3.00 m")


def test_the_table_goes_to_standard_output(capsys):
    show_table({"collisions": 0}, "wander-lab")
    assert "collisions" in capsys.readouterr().out


def test_the_json_form_is_the_same_dict():
    table = {"robot": "k2a", "path_m": 3.25, "collisions": 0}
    assert json.loads(table_json(table)) == table


def test_the_json_form_has_no_numbers_that_json_lacks():
    assert json.loads(table_json({"a_m": nan, "b_m": inf})) == {"a_m": None, "b_m": None}
