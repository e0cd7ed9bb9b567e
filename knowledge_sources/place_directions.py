"""Which way the wall runs at each of many places, as the places around it show."""

from math import pi

import numpy as np

from knowledge_sources.echoes import Array

CELLS = 3  # to a radius
ALIKE_M2 = 1e-8  # places that lie together are one, and one shows no direction
CUT_STEPS = 180  # of half a circle
CUT_WIDTH = 11  # steps: walls within five degrees of the cut would be torn


def local_normals(points: Array, radius_m: float) -> tuple[Array, Array]:
    """Return for points (n, 2) the normal, undirected, of the line through the places around each, and how slender these are.

    The latter is the ratio of their deviations across and along it: 0 on a line, 1 where none runs. Around a place is a disc of
    cells about its own, so that it does not matter how closely places lie.
    """
    column, row = np.floor(points / (radius_m / CELLS)).astype(np.int64).T
    column, row = column - column.min(), row - row.min()
    width = int(column.max()) + 1 + CELLS  # so far a row's end is from the next one's beginning
    cells, cell_of = np.unique(row * width + column, return_inverse=True)
    x, y = (points - points.mean(axis=0)).T
    own = np.stack([np.bincount(cell_of, v, len(cells)) for v in (np.ones(len(x)), x, y, x * x, x * y, y * y)])
    around = np.zeros_like(own)
    for i in range(-CELLS, CELLS + 1):
        for j in range(-CELLS, CELLS + 1):
            if i * i + j * j <= CELLS * CELLS:
                at = np.minimum(np.searchsorted(cells, cells + i * width + j), len(cells) - 1)
                there = cells[at] == cells + i * width + j
                around[:, there] += own[:, at[there]]
    n, sx, sy, sxx, sxy, syy = around
    xx, xy, yy = sxx / n - (sx / n) ** 2, sxy / n - sx * sy / n**2, syy / n - (sy / n) ** 2
    half, difference = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    across, along = np.maximum(half - difference, 0.0), half + difference
    slenderness = np.where(along > ALIKE_M2, np.sqrt(across / np.maximum(along, ALIKE_M2)), 1.0)
    return (np.arctan2(2.0 * xy, xx - yy) / 2.0 + pi / 2.0)[cell_of], slenderness[cell_of]


def facing(normal_rad: Array) -> Array:
    """Return undirected normals as directions of one half of the circle, which is cut where fewest of them are.

    A wall at the cut would have its places face both ways and be found as two.
    """
    step = pi / CUT_STEPS
    counts = np.bincount(((normal_rad % pi) / step).astype(np.intp) % CUT_STEPS, minlength=CUT_STEPS)
    around = sum(np.roll(counts, k) for k in range(-(CUT_WIDTH // 2), CUT_WIDTH // 2 + 1))
    cut = (float(np.argmin(around)) + 0.5) * step
    directed: Array = cut + (normal_rad - cut) % pi
    return directed
