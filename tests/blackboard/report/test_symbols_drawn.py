"""Corners and targets in the overview."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from blackboard.messages.geometry import Point
from blackboard.messages.symbols import Corner, Target
from blackboard.report import palette
from blackboard.report.overview import write_overview


def pixels(result, path, colour):
    write_overview(result, path)
    with Image.open(path) as picture:
        found = np.argwhere((np.asarray(picture.convert("RGB")) == colour).all(axis=2))
    return found[found[:, 0] < found[:, 0].max() - 60] if len(found) else found  # without the legend's sample


def corner(shape: str, bisector_rad: float) -> Corner:
    return Corner(
        place=Point(x_m=1.5, y_m=1.0), sigma_x_m=0.02, sigma_y_m=0.02, correlation=0.0, opening_rad=1.57,
        bisector_rad=bisector_rad, shape=shape, gap_m=0.0, lines=("a", "b"),  # type: ignore[arg-type]
    )  # fmt: skip


def test_a_target_is_drawn_where_it_lies(result, tmp_path):
    targets = [
        Target(place=Point(x_m=x, y_m=1.0), stand=Point(x_m=1.0, y_m=1.0), reason="frontier", size_m=1.0)
        for x in (1.0, 2.0)
    ]
    left, right = (pixels(replace(result, targets=[t]), tmp_path / "a.png", palette.TARGET_COLOUR) for t in targets)
    assert len(left) > 50
    assert right[:, 1].mean() > left[:, 1].mean() + 100
    assert right[:, 0].mean() == pytest.approx(left[:, 0].mean(), abs=1.0)
    assert len(pixels(result, tmp_path / "a.png", palette.TARGET_COLOUR)) == 0


def test_a_corner_s_mark_stands_where_there_is_room(result, tmp_path):
    columns = [
        pixels(replace(result, corners=[corner(shape, 0.0)]), tmp_path / "a.png", palette.CORNER_COLOUR)[:, 1].mean()
        for shape in ("concave", "convex")
    ]
    assert columns[0] > columns[1]  # a concave one within its angle, which opens to the right
    assert len(pixels(result, tmp_path / "a.png", palette.CORNER_COLOUR)) == 0


def test_a_crowded_legend_fits(result, tmp_path):
    target = Target(place=Point(x_m=1.0, y_m=1.0), stand=Point(x_m=1.0, y_m=1.0), reason="frontier", size_m=1.0)
    write_overview(replace(result, corners=[corner("unknown", 1.0)], targets=[target]), tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as picture:
        foot = np.asarray(picture.convert("L"))[-100:, -20:]
    assert foot.min() > 200  # nothing runs off to the right
