"""Outlines of a bitmap: free cells become polygons whose slanted edges are straight and not stairs.

Marching squares through the middles between cells, then Douglas-Peucker simplification. Solid cells that touch at a corner
are taken as joined, so that a wall one cell thin has no holes.
"""

from itertools import combinations

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry.base import BaseGeometry

TOLERANCE_CELLS = 0.6  # stairs of one cell deviate from their slanted edge by at most half a cell


def outline_free(free: npt.NDArray[np.bool_], tolerance_cells: float = TOLERANCE_CELLS) -> BaseGeometry:
    """Return the area of the free cells, (rows, columns), in cells: x to the right, y down. Outside the bitmap nothing is free."""
    padded = np.pad(free, 1)
    corners = [padded[:-1, :-1], padded[:-1, 1:], padded[1:, 1:], padded[1:, :-1]]  # clockwise from above left
    middles = np.array([(0.5, 0.0), (1.0, 0.5), (0.5, 1.0), (0.0, 0.5)])  # of the sides above, right, below, left
    crossed = np.stack([corners[i] != corners[(i + 1) % 4] for i in range(4)])
    saddle = crossed.all(axis=0)
    pieces = []
    for first, second in combinations(range(4), 2):
        rows, columns = np.nonzero(crossed[first] & crossed[second] & ~saddle)
        pieces.append(_pieces(rows, columns, middles[first], middles[second]))
    for corner in range(4):  # cut off each free corner of a saddle: it lies between the side before it and its own
        rows, columns = np.nonzero(saddle & corners[corner])
        pieces.append(_pieces(rows, columns, middles[corner - 1], middles[corner]))
    lines = shapely.multilinestrings(shapely.linestrings(np.concatenate(pieces)))
    area = shapely.build_area(shapely.line_merge(lines))
    return shapely.make_valid(area.simplify(tolerance_cells, preserve_topology=True))


def _pieces(
    rows: npt.NDArray[np.intp],
    columns: npt.NDArray[np.intp],
    start: npt.NDArray[np.float64],
    end: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]:
    """Return one short line in each of these squares between four cells, (k, 2, 2)."""
    origin = np.stack((columns, rows), axis=1) - 0.5  # the padded cell (0, 0) has its middle at (-0.5, -0.5)
    return np.stack((origin + start, origin + end), axis=1)
