"""Several robots in one table and one picture: maps laid on each other, sums, and whose way is whose."""

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from rich.console import Console

from blackboard.errors import OutputError
from blackboard.report import palette
from blackboard.report.team import disagreement, side_by_side, team_table, united
from blackboard.report.team_overview import team_figure, write_team_overview


def test_of_each_cell_the_surest_counts(make_grid):
    one = make_grid([[0, 128, 255], [100, 60, 128]], x_min_m=0.0)
    other = make_grid([[250, 40], [0, 190]], x_min_m=0.05)  # one cell further
    together = united([one, other])
    assert together is not None
    assert together.cells.tolist() == [[0, 250, 255], [100, 0, 190]]
    assert (together.x_min_m, together.y_min_m) == (0.0, 0.0)


def test_maps_far_from_each_other_leave_unknown_between(make_grid):
    together = united([make_grid([[0]], x_min_m=0.0), make_grid([[255]], x_min_m=0.1, y_min_m=-0.05)])
    assert together is not None
    assert together.cells.tolist() == [[128, 128, 255], [0, 128, 128]]
    assert together.y_min_m == pytest.approx(-0.05)


def test_nothing_known_is_nothing_and_cells_must_be_of_one_size(make_grid):
    assert united([]) is None
    assert united([make_grid([[128, 128]])]) is None
    with pytest.raises(OutputError, match="different sizes"):
        united([make_grid([[0]]), make_grid([[0]], cell_m=0.1)])


def test_disagreement_counts_cells_that_both_decided(make_grid):
    one = make_grid([[0, 255, 0, 128, 0]])
    other = make_grid(
        [[0, 128, 255, 255]], x_min_m=0.05
    )  # under cells 1 to 4 of the other: 255/0, 0/128, 128/255, 0/255
    assert disagreement(one, other) == 1.0
    assert disagreement(one, one) == 0.0
    assert disagreement(one, make_grid([[0]], x_min_m=5.0)) is None
    assert disagreement(one, make_grid([[128]])) is None


@pytest.fixture
def results(result, make_grid):
    """Two robots in one room, each of which knows one half of its floor."""
    halves = {"east": (50, 90), "west": (10, 50)}
    made = {}
    for name, (first, last) in halves.items():
        cells = np.full((80, 100), 128)
        cells[10:70, first:last] = 0
        way = result.trajectory.copy()
        way[:, 2] = {"east": 1.0, "west": 2.0}[name]
        table = {"time_s": 30.0, "path_m": 3.0, "distance_m": 3.5, "collisions": 1, "met_robots": 2, "mission": name}
        made[name] = replace(
            result, grid=make_grid(cells, -0.5, -0.5), trajectory=way, true_trajectory=way, table=table
        )
    return made


def test_the_table_of_all_adds_up_and_scores_the_maps_together(results):
    table = team_table(results)
    assert table["robots"] == "east, west"
    assert (table["path_m"], table["collisions"], table["met_each_other"]) == (6.0, 2, 2)
    assert "touched_by_others" not in table
    alone = team_table({"east": results["east"]})
    assert table["reachable_decided_fraction"] > 0.95 > 0.6 > alone["reachable_decided_fraction"]


def test_each_robot_has_a_column():
    tables = {"east": {"robot": "east", "path_m": 1.5, "lines": 3}, "west": {"robot": "west", "path_m": 2.5}}
    console = Console(width=80, file=io.StringIO())
    with console.capture() as captured:
        console.print(side_by_side(tables, "pair"))
    shown = captured.get().splitlines()
    assert [line.split() for line in shown if "path" in line] == [["path", "1.50", "m", "2.50", "m"]]
    assert [line.split() for line in shown if "lines" in line] == [["lines", "3"]]
    assert any(line.split() == ["east", "west"] for line in shown)


def test_each_way_has_its_colour_and_the_picture_is_the_same_each_time(results, tmp_path):
    figure = team_figure(results, "pair", "")
    places = {}
    for name, y_m in (("east", 1.0), ("west", 2.0)):
        x, y = figure.axes[0].transData.transform((3.35, y_m + 0.1))  # in the body at the end of the way
        places[name] = (int(x), int(figure.bbox.height - y))
    for file in ("one.png", "two.png"):
        write_team_overview(results, "pair", "", tmp_path / file)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()
    with Image.open(tmp_path / "one.png") as image:
        assert image.width == 1600
        colours = {name: image.convert("RGB").getpixel(place) for name, place in places.items()}
    assert colours == {"east": palette.BEHAVIOUR_COLOURS[0], "west": palette.BEHAVIOUR_COLOURS[1]}
