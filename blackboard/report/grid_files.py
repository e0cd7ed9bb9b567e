"""The grid as files: `grid.png` to look at, `map.pgm` with `map.yaml` for ROS.

Source: ROS map_server, map format (wiki.ros.org/map_server, section 1.1), `trinary` mode: p = (255 - pixel) / 255 is
occupied above occupied_thresh, free below free_thresh, else unknown; the first row of the image is the highest y.
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN
from blackboard.report.palette import grey_levels
from blackboard.report.result import GridView

MAP_OCCUPIED, MAP_FREE, MAP_UNKNOWN = 0, 254, 205  # as map_saver writes them
OCCUPIED_THRESHOLD = 0.65  # map_server's default
FREE_THRESHOLD = 0.196  # likewise: just below (255 - 205) / 255, so that 205 reads as unknown, not free
PICTURE_PX = 1000  # a small grid is enlarged by a whole factor as long as its longer side stays below this


def picture_factor(grid: GridView) -> int:
    """Return how many pixels wide and high a cell is in `grid.png`."""
    return max(1, PICTURE_PX // max(1, int(max(grid.cells.shape))))


def grid_picture(grid: GridView) -> npt.NDArray[np.uint8]:
    """Return the greys of `grid.png`, first row highest y."""
    factor = picture_factor(grid)
    return grey_levels()[grid.cells[::-1]].repeat(factor, axis=0).repeat(factor, axis=1)


def map_pixels(grid: GridView) -> npt.NDArray[np.uint8]:
    """Return the pixels of `map.pgm`, first row highest y."""
    table = np.full(256, MAP_UNKNOWN, dtype=np.uint8)
    table[: EMPTY_MAX + 1] = MAP_FREE
    table[OCCUPIED_MIN:] = MAP_OCCUPIED
    return table[grid.cells[::-1]]


def write_grid_png(grid: GridView, path: Path) -> None:
    """Write the grid as a grey picture with y up."""
    Image.fromarray(grid_picture(grid)).save(path, format="PNG")


def write_ros_map(grid: GridView, folder: Path) -> None:
    """Write `map.pgm` and `map.yaml` into `folder`."""
    pixels = map_pixels(grid)
    rows, columns = pixels.shape
    header = f"P5\n# {grid.cell_m:.3f} m/pix\n{columns} {rows}\n255\n"
    (folder / "map.pgm").write_bytes(header.encode("ascii") + pixels.tobytes())
    (folder / "map.yaml").write_text(
        "image: map.pgm\n"
        "mode: trinary\n"
        f"resolution: {grid.cell_m:.6f}\n"
        f"origin: [{grid.x_min_m:.6f}, {grid.y_min_m:.6f}, 0.000000]\n"
        "negate: 0\n"
        f"occupied_thresh: {OCCUPIED_THRESHOLD}\n"
        f"free_thresh: {FREE_THRESHOLD}\n",
        encoding="ascii",
    )
