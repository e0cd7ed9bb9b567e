from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from blackboard.messages.sensing import RobotDescription
from blackboard.report import palette
from blackboard.report.overview import main_figures, overview_figure, write_overview
from blackboard.report.result import RunResult


def pixel_of(result: RunResult, x_m: float, y_m: float) -> tuple[int, int]:
    """Return where a place of the map lies in the picture."""
    figure = overview_figure(result)
    x, y = figure.axes[1].transData.transform((x_m, y_m))
    return int(x), int(figure.bbox.height - y)


def colour_at(result: RunResult, folder, x_m: float, y_m: float) -> tuple[int, ...]:
    write_overview(result, folder / "overview.png")
    with Image.open(folder / "overview.png") as image:
        return image.convert("RGB").getpixel(pixel_of(result, x_m, y_m))


@pytest.mark.parametrize(
    ("x_m", "y_m", "colour"),
    [
        (2.025, 1.025, palette.EMPTY_COLOUR),
        (3.525, -0.025, palette.OCCUPIED_COLOUR),
        (4.15, 1.5, palette.UNKNOWN_COLOUR),
        (0.75, 0.0, palette.LINE_COLOUR),
        (3.35, 2.0, palette.ROBOT_COLOUR),  # behind the nose of the robot at its last pose
        (0.35, 2.0, palette.PAPER),  # likewise at its first
    ],
)
def test_places_have_their_colours(result, tmp_path, x_m, y_m, colour):
    assert colour_at(result, tmp_path, x_m, y_m) == colour


def test_the_picture_is_1600_wide_and_the_same_each_time(result, tmp_path):
    for name in ("one.png", "two.png"):
        write_overview(result, tmp_path / name)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()
    with Image.open(tmp_path / "one.png") as image:
        assert image.width == 1600
        assert "Software" not in image.info


def test_a_metre_is_a_metre_both_ways(result):
    x0, y0 = pixel_of(result, 0.0, 0.0)
    x1, y1 = pixel_of(result, 1.0, 1.0)
    assert x1 - x0 == pytest.approx(y0 - y1, abs=2)


@pytest.mark.parametrize("scale", [0.05, 1.0, 10.0, 1000.0])
def test_any_extent_can_be_drawn(result, tmp_path, scale):
    path = result.trajectory.copy()
    path[:, 1:3] *= scale
    write_overview(replace(result, grid=None, lines=[], trajectory=path), tmp_path / "overview.png")


@pytest.mark.parametrize("poses", [0, 1, 2])
def test_little_can_be_drawn(result, tmp_path, poses):
    little = replace(
        result, grid=None, lines=[], trajectory=result.trajectory[:poses], true_trajectory=None, truth=None
    )
    write_overview(little, tmp_path / "overview.png")


def test_a_grid_without_knowledge_can_be_drawn(result, make_grid, tmp_path):
    write_overview(replace(result, grid=make_grid(np.full((64, 64), 128))), tmp_path / "overview.png")
    write_overview(replace(result, grid=make_grid(np.empty((0, 0)))), tmp_path / "overview.png")


@pytest.mark.parametrize("mission", ["a $b^{$ c", "地図", "x" * 300, "two\nlines", ""])
def test_any_mission_name_can_be_a_title(result, tmp_path, mission):
    write_overview(replace(result, mission=mission), tmp_path / "overview.png")


def test_a_users_settings_do_not_change_the_picture(result, tmp_path):
    import matplotlib as mpl

    write_overview(result, tmp_path / "one.png")
    with mpl.rc_context({"font.size": 20, "lines.antialiased": False, "savefig.bbox": "tight", "axes.grid": True}):
        write_overview(result, tmp_path / "two.png")
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()


def test_the_main_figures_are_those_of_the_run(result):
    # 60 x 80 empty cells and 82 occupied ones of 5 cm: 12.2 m²
    assert main_figures(result) == "robot k2a   ·   30 s, 3 m driven   ·   12 m² mapped   ·   1 line"


def test_a_tiny_robot_is_ringed(result, tmp_path):
    tiny: RobotDescription = RobotDescription(
        name="fly", radius_m=0.001, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0
    )
    assert colour_at(replace(result, robot=tiny), tmp_path, 3.475, 2.02) == palette.ROBOT_COLOUR
