"""The panels of a run: which there are, what they say, and that the page is the same each time."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from blackboard.report import palette
from blackboard.report.figure_drawing import contrast_of
from blackboard.report.figure_panels import led_s, panels_of, pieces_by_lead
from blackboard.report.figures import figures_page, write_figures
from blackboard.report.milestones import Lead, Milestones


def test_the_panels_and_their_words(result, milestones):
    panels = panels_of(result, milestones)
    assert [(p.title, p.thesis) for p in panels] == [
        ("Way under the behaviours", "6.1"),
        ("Grid after the first scan", "6.2 a"),
        ("Grid after 6 scans", "6.2 c"),
        ("Grid after 51 scans", "6.3"),
        ("First 2-D lines", "6.4"),
        ("Raw points", "6.5"),
        ("Filtered points", "6.6"),
        ("Second 2-D lines", "6.7"),
        ("First and second lines", "6.8"),
        ("Merged lines over both", "6.9"),
        ("Targets, in the order of the visits", ""),
        ("The map at the end", ""),
    ]
    captions = {p.title: p.caption for p in panels}
    assert captions["Way under the behaviours"] == "3 m in 30 s"
    assert captions["Grid after 51 scans"] == "at 10 s, 12.2 m²"  # 60 x 80 cells empty, 82 occupied, of 0.0025 m²
    assert captions["Second 2-D lines"] == "1 line, 4.0 m, 512 points, 10 to 20 s"
    assert captions["Merged lines over both"] == "2 lines, 5.5 m at 21 s"
    assert captions["Targets, in the order of the visits"] == "1 reached, 1 blocked"
    assert [label for _, label in panels[0].samples] == ["curiosity 12 s", "random wander 18 s"]


def test_times_count_from_the_start(result, milestones):
    late = result.trajectory + np.array([1000.0, 0.0, 0.0, 0.0])
    moved = replace(
        milestones,
        scans=[replace(stage, stamp_s=stage.stamp_s + 1000.0) for stage in milestones.scans],
        second=replace(milestones.second, from_s=1010.0, stamp_s=1020.0),
    )
    captions = {p.thesis: p.caption for p in panels_of(replace(result, trajectory=late), moved)}
    assert captions["6.3"] == "at 10 s, 12.2 m²"
    assert captions["6.7"] == "1 line, 4.0 m, 512 points, 10 to 20 s"


def test_what_a_mission_does_not_have_is_left_out(result, milestones, tmp_path):
    assert [p.title for p in panels_of(result, Milestones())] == ["Way", "The map at the end"]
    assert not write_figures(result, Milestones(), tmp_path / "figures.png")
    assert not (tmp_path / "figures.png").exists()
    no_model = panels_of(result, replace(milestones, merged=None, visits=()))
    assert "6.9" not in [p.thesis for p in no_model]
    assert not any(p.title.startswith("Targets") for p in no_model)
    points_only = replace(result, grid=None, trajectory=np.empty((0, 4)), lines=[])
    assert write_figures(points_only, milestones, tmp_path / "figures.png")


def test_the_page_is_the_same_each_time(result, milestones, tmp_path):
    for name in ("one.png", "two.png"):
        write_figures(result, milestones, tmp_path / name)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()
    with Image.open(tmp_path / "one.png") as image:
        assert image.width == 1600
        assert "Software" not in image.info


def test_places_have_their_colours(result, milestones, tmp_path):
    panels = panels_of(result, milestones)
    figure = figures_page(result, milestones, panels)
    write_figures(result, milestones, tmp_path / "figures.png")
    by_title = dict(zip([p.title for p in panels], figure.axes[1:], strict=True))
    looked = [
        ("Way under the behaviours", 1.0, 2.0, palette.BEHAVIOUR_COLOURS[0]),  # at 5 s
        ("Way under the behaviours", 3.0, 2.0, palette.BEHAVIOUR_COLOURS[1]),
        ("First 2-D lines", 0.75, 0.0, palette.LINE_COLOUR),
        ("Second 2-D lines", 2.0, 3.0, palette.SECOND_LINE_COLOUR),
        ("Merged lines over both", 1.0, 0.0, palette.INK),
    ]
    with Image.open(tmp_path / "figures.png") as image:
        for title, x_m, y_m, colour in looked:
            x, y = by_title[title].transData.transform((x_m, y_m))
            assert image.convert("RGB").getpixel((int(x), int(figure.bbox.height - y))) == colour, title


def test_who_led_where(path):
    leads = [Lead(stamp_s=1.0, behaviour="a"), Lead(stamp_s=10.0, behaviour=""), Lead(stamp_s=20.0, behaviour="a")]
    assert led_s(leads, 30.0) == {"a": 19.0}
    pieces = pieces_by_lead(path, leads)  # a pose every half second
    assert [(name, piece[0, 0], piece[-1, 0]) for name, piece in pieces] == [
        ("", 0.0, 0.5), ("a", 0.5, 9.5), ("", 9.5, 19.5), ("a", 19.5, 30.0),
    ]  # fmt: skip


def test_faint_cells_are_shown_stronger(make_grid):
    assert contrast_of(make_grid([[100, 140]])) == pytest.approx(127 / 12)
    assert contrast_of(make_grid([[0, 255]])) == 1.0
    assert contrast_of(make_grid([[0, 128]])) == 1.0
