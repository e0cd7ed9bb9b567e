"""Lines compared with those that others drew, by hand."""

import numpy as np
import pytest

from blackboard.report.drawn_lines import drawn_lines_table

POINTS = np.stack([np.linspace(0.0, 4.0, 200), np.zeros(200)], axis=1)


def test_nothing_drawn_nothing_said(make_line):
    assert drawn_lines_table([make_line(0, 0, 1, 0).value], None, POINTS) == {}
    assert drawn_lines_table([], np.zeros((0, 4)), POINTS) == {}


def test_shares_of_length(make_line):
    drawn = np.array([[0.0, 0.05, 4.0, 0.05], [0.0, 3.0, 1.0, 3.0]])  # 4 m along the points, 1 m where there are none
    lines = [make_line(0, 0, 3, 0).value, make_line(3, 1, 4, 1).value]  # 3 m on the first, 1 m on none
    table = drawn_lines_table(lines, drawn, POINTS)
    assert table["drawn_lines"] == 2
    assert table["drawn_length_m"] == pytest.approx(5.0)
    assert table["drawn_found_fraction"] == pytest.approx(0.62, abs=0.021)  # 3.1 of 5 m, in pieces of 5 cm
    assert table["drawn_near_points_fraction"] == pytest.approx(0.8)
    assert table["lines_length_m"] == pytest.approx(4.0)
    assert table["lines_not_drawn_fraction"] == pytest.approx(0.25)


@pytest.mark.parametrize(("degrees", "found"), [(2.9, 1.0), (3.1, 0.0)])
def test_a_line_at_an_angle_is_another(make_line, degrees, found):
    rise = np.tan(np.deg2rad(degrees))
    line = make_line(0, -rise / 2, 1, rise / 2).value
    table = drawn_lines_table([line], np.array([[0.0, 0.0, 1.0, 0.0]]), None)
    assert table["drawn_found_fraction"] == pytest.approx(found)
    assert "drawn_near_points_fraction" not in table


def test_nothing_found(make_line):
    table = drawn_lines_table([], np.array([[0.0, 0.0, 1.0, 0.0]]), POINTS)
    assert (table["drawn_found_fraction"], table["lines_length_m"]) == (0.0, 0.0)
    assert "lines_not_drawn_fraction" not in table
