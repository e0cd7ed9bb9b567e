"""Which part of the map a picture shows."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from blackboard.grid import UNKNOWN, KnownPart
from blackboard.report.result import GridView, Trajectory

MARGIN_FRACTION = 0.04  # of the longer side, left free around what is known
MIN_MARGIN_M = 0.3
MIN_SIDE_M = 2.0  # a run of one pose still gets a room around it


@dataclass(frozen=True)
class View:
    """A rectangle of the map frame."""

    x_min_m: float
    y_min_m: float
    x_max_m: float
    y_max_m: float

    @property
    def width_m(self) -> float:
        """Side along x."""
        return self.x_max_m - self.x_min_m

    @property
    def height_m(self) -> float:
        """Side along y."""
        return self.y_max_m - self.y_min_m

    def widened(self, lowest: float, highest: float) -> "View":
        """Return the view made wider or higher about its middle until height / width lies between the two."""
        width_m = max(self.width_m, self.height_m / highest)
        height_m = max(self.height_m, self.width_m * lowest)
        x_m, y_m = (self.x_min_m + self.x_max_m) / 2, (self.y_min_m + self.y_max_m) / 2
        return View(x_m - width_m / 2, y_m - height_m / 2, x_m + width_m / 2, y_m + height_m / 2)


def known_part(grid: GridView) -> KnownPart | None:
    """Return the smallest rectangle with every cell that is not unknown; None when nothing is known."""
    known = grid.cells != UNKNOWN
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if not len(rows):
        return None
    r0, r1, c0, c1 = int(rows[0]), int(rows[-1]), int(columns[0]), int(columns[-1])
    x_min_m, y_min_m = grid.x_min_m + c0 * grid.cell_m, grid.y_min_m + r0 * grid.cell_m
    return KnownPart(grid.cells[r0 : r1 + 1, c0 : c1 + 1], x_min_m, y_min_m, grid.cell_m)


def view_of(grid: GridView | None, trajectory: Trajectory, ends: npt.NDArray[np.float64], radius_m: float) -> View:
    """Return the view of all known cells, the robot at all poses, and all lines' `ends` (n, 4), with a margin."""
    corners = [ends[:, :2], ends[:, 2:], trajectory[:, 1:3] - radius_m, trajectory[:, 1:3] + radius_m]
    known = known_part(grid) if grid is not None else None
    if known is not None:
        rows, columns = known.cells.shape
        corners.append(np.array([[0, 0], [columns, rows]]) * known.cell_m + (known.x_min_m, known.y_min_m))
    points = np.concatenate(corners)
    if not len(points):
        points = np.zeros((1, 2))
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    margin_m = max(MIN_MARGIN_M, MARGIN_FRACTION * max(x1 - x0, y1 - y0))
    dx_m = max(margin_m, (MIN_SIDE_M - (x1 - x0)) / 2)
    dy_m = max(margin_m, (MIN_SIDE_M - (y1 - y0)) / 2)
    return View(x0 - dx_m, y0 - dy_m, x1 + dx_m, y1 + dy_m)


def colours_over(grid: GridView, view: View, colours: npt.NDArray[np.uint8]) -> tuple[npt.NDArray[np.uint8], View]:
    """Return the cells inside `view` as colours (rows, columns, 3), first row highest y, and what they cover."""
    rows, columns = grid.cells.shape
    c0 = int(np.clip(np.floor((view.x_min_m - grid.x_min_m) / grid.cell_m), 0, columns))
    c1 = int(np.clip(np.ceil((view.x_max_m - grid.x_min_m) / grid.cell_m), c0, columns))
    r0 = int(np.clip(np.floor((view.y_min_m - grid.y_min_m) / grid.cell_m), 0, rows))
    r1 = int(np.clip(np.ceil((view.y_max_m - grid.y_min_m) / grid.cell_m), r0, rows))
    covered = View(
        grid.x_min_m + c0 * grid.cell_m,
        grid.y_min_m + r0 * grid.cell_m,
        grid.x_min_m + c1 * grid.cell_m,
        grid.y_min_m + r1 * grid.cell_m,
    )
    return colours[grid.cells[r0:r1, c0:c1][::-1]], covered


def scale_bar_m(width_m: float) -> float:
    """Return a round length (1, 2 or 5 times a power of ten) of at most a fifth of the width."""
    wanted_m = width_m / 5.0
    power = 10.0 ** np.floor(np.log10(wanted_m))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted_m * (1 + 1e-9)))


def simplified(points: npt.NDArray[np.float64], step_m: float) -> npt.NDArray[np.intp]:
    """Return the indices of the first and last point, and of those between that lie `step_m` from the one kept before."""
    places = points.tolist()
    kept = [0] if places else []
    for index, (x_m, y_m) in enumerate(places):
        x0_m, y0_m = places[kept[-1]]
        if index and (x_m - x0_m) ** 2 + (y_m - y0_m) ** 2 >= step_m**2:
            kept.append(index)
    if places and kept[-1] != len(places) - 1:
        kept.append(len(places) - 1)
    return np.array(kept, dtype=np.intp)
