"""Outlines of a bitmap: free cells become polygons whose slanted edges are straight and not stairs.

Marching squares through the middles between cells; right-angled corners, which these cut off, are put back where both legs
are straight for a cell and more; then Douglas-Peucker simplification. Solid cells that touch at a corner are taken as
joined, so that a wall one cell thin has no holes.
"""

from itertools import combinations

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry.base import BaseGeometry

LEG_CELLS = 1.0  # a stair's riser is straight for less
TOLERANCE_CELLS = 1.0  # stairs of one cell swing by nearly half a cell to either side of their slanted edge


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
    contours = shapely.line_merge(shapely.multilinestrings(shapely.linestrings(np.concatenate(pieces))))
    rings = [shapely.linearrings(_square(np.asarray(ring.coords)[:-1])) for ring in shapely.get_parts(contours)]
    area = shapely.build_area(shapely.geometrycollections(rings))
    return shapely.make_valid(area.simplify(tolerance_cells, preserve_topology=True))


def _square(ring: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Put back the corners of a closed contour, (k, 2): where it cuts across a corner between two straight legs."""
    step = np.roll(ring, -1, axis=0) - ring
    ring = ring[(np.abs(step - np.roll(step, 1, axis=0)) > 1e-9).any(axis=1)]  # only where it bends
    leg = np.roll(ring, -1, axis=0) - ring  # from each bend to the next
    straight = (np.abs(leg).min(axis=1) < 1e-9) & (np.abs(leg).max(axis=1) > LEG_CELLS - 1e-9)
    cut = (np.abs(np.abs(leg) - 0.5) < 1e-9).all(axis=1) & np.roll(straight, 1) & np.roll(straight, -1)
    before = np.roll(leg, 1, axis=0)
    before /= np.maximum(np.abs(before).max(axis=1, keepdims=True), 1e-9)
    squared = np.where(cut[:, None], ring + 0.5 * before, ring)  # the corner takes the place of the cut's first end
    return np.asarray(squared[~np.roll(cut, 1)])


def _pieces(
    rows: npt.NDArray[np.intp],
    columns: npt.NDArray[np.intp],
    start: npt.NDArray[np.float64],
    end: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]:
    """Return one short line in each of these squares between four cells, (k, 2, 2)."""
    origin = np.stack((columns, rows), axis=1) - 0.5  # the padded cell (0, 0) has its middle at (-0.5, -0.5)
    return np.stack((origin + start, origin + end), axis=1)
