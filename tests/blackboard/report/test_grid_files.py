from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image

from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, Grid, KnownPart
from blackboard.report.grid_files import grid_picture, map_pixels, picture_factor, write_grid_png, write_ros_map

ROOM = [[0, 0, 128], [128, 255, 0]]  # row 0 is the lower one


def read_yaml(path: Path) -> dict[str, str]:
    return dict(line.split(": ", 1) for line in path.read_text().splitlines())


def classes(pixels: np.ndarray, occupied_thresh: float, free_thresh: float) -> np.ndarray:
    """Read pixels as map_server does in trinary mode with negate 0: 100 occupied, 0 free, -1 unknown."""
    p = (255 - pixels.astype(np.float64)) / 255.0
    return np.where(p > occupied_thresh, 100, np.where(p < free_thresh, 0, -1))


def test_the_map_is_written_row_by_row_from_the_highest_y(make_grid, tmp_path):
    write_ros_map(make_grid(ROOM, -1.0, 2.5), tmp_path)
    expected = b"P5\n# 0.050 m/pix\n3 2\n255\n" + bytes([205, 0, 254, 254, 254, 205])
    assert (tmp_path / "map.pgm").read_bytes() == expected


def test_the_yaml_names_the_lower_left_corner_and_the_thresholds(make_grid, tmp_path):
    write_ros_map(make_grid(ROOM, -1.0, 2.5), tmp_path)
    facts = read_yaml(tmp_path / "map.yaml")
    assert facts["image"] == "map.pgm"
    assert facts["mode"] == "trinary"
    assert float(facts["resolution"]) == 0.05
    assert facts["origin"] == "[-1.000000, 2.500000, 0.000000]"
    assert facts["negate"] == "0"
    assert (float(facts["occupied_thresh"]), float(facts["free_thresh"])) == (0.65, 0.196)


@given(arrays(np.uint8, st.tuples(st.integers(1, 9), st.integers(1, 9))))
def test_reading_the_map_back_gives_the_grids_classes(cells):
    read = classes(map_pixels(KnownPart(cells, 0.0, 0.0, 0.05)), 0.65, 0.196)[::-1]
    assert np.array_equal(read == 100, cells >= OCCUPIED_MIN)
    assert np.array_equal(read == 0, cells <= EMPTY_MAX)


def test_pillow_reads_the_map_file(make_grid, tmp_path):
    write_ros_map(make_grid(ROOM), tmp_path)
    facts = read_yaml(tmp_path / "map.yaml")
    with Image.open(tmp_path / facts["image"]) as image:
        read = classes(np.asarray(image), float(facts["occupied_thresh"]), float(facts["free_thresh"]))
    assert read[::-1].tolist() == [[0, 0, -1], [-1, 100, 0]]


def test_a_small_grid_is_enlarged_with_y_up(make_grid, tmp_path):
    grid = make_grid(ROOM)
    write_grid_png(grid, tmp_path / "grid.png")
    with Image.open(tmp_path / "grid.png") as image:
        assert image.size == (999, 666)
        assert image.getpixel((0, 665)) == 254  # lower left: empty
        assert image.getpixel((500, 0)) == 20  # upper middle: occupied
        assert image.getpixel((0, 0)) == 205  # upper left: unknown


def test_a_large_grid_keeps_a_pixel_a_cell(make_grid):
    grid = make_grid(np.full((3, 1200), 128))
    assert picture_factor(grid) == 1
    assert grid_picture(grid).shape == (3, 1200)


@given(st.integers(0, 254))
def test_greys_never_grow_lighter_towards_occupied(value):
    greys = grid_picture(KnownPart(np.array([[value, value + 1]], np.uint8), 0.0, 0.0, 0.05))
    assert greys[0, 0] >= greys[0, -1]


def test_a_grid_off_the_board_will_do(tmp_path):
    grid = Grid(0.05)
    grid.cover(0.0, 0.0, 1.0, 1.0)
    write_ros_map(grid, tmp_path)
    assert (tmp_path / "map.pgm").read_bytes().startswith(b"P5\n# 0.050 m/pix\n64 64\n255\n")
