"""The Hough transform of echoes into the (alpha, rho) space of lines x cos(alpha) + y sin(alpha) = rho.

Source: Bou-Ghannam 1992, section 5.2.3, steps 1 to 3 (after Hough 1962); votes of cones as in Tardos et al. 2002,
section IV.
"""

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
import numpy.typing as npt

from knowledge_sources.echoes import Array, Echoes, Index, Mask

Votes = npt.NDArray[np.intp]  # (alpha cells, rho cells)


@dataclass(frozen=True, slots=True)
class HoughSpace:
    """The accumulator's cells: alpha over the full circle from 0, rho from 0 up, both seen from an origin in the map
    frame.

    Cell (i, j) holds the normals nearest to i * alpha_step_rad and the distances from j to j + 1 times rho_step_m.
    """

    origin_x_m: float
    origin_y_m: float
    alpha_cells: int  # even: every normal has its opposite
    rho_step_m: float
    rho_cells: int

    @property
    def alpha_step_rad(self) -> float:
        return 2.0 * pi / self.alpha_cells


def accumulate(echoes: Echoes, space: HoughSpace) -> Votes:
    """Return the votes of echoes for the lines that may have sent them (steps 1 and 2).

    An echo votes in each alpha for the one line that would have sent it, up to its largest incidence. For points,
    cones of no width and lines of any direction, that is the transform as the thesis has it.
    """
    cells, step = space.alpha_cells, space.alpha_step_rad
    if len(echoes) == 0:
        return np.zeros((cells, space.rho_cells), dtype=np.intp)
    # Single precision is a ten-thousandth of a cell, and twice as fast.
    single = np.float32
    limit = np.minimum(echoes.reach_rad, pi / 2).astype(single)[:, None]
    widest = int(float(limit.max()) / step) + 1
    # The tables run over both ends of the circle, so that neighbours of 0 degrees need no wrapping: (cells + 2 * pad,).
    pad = widest + 1
    circle = np.arange(-pad, cells + pad + 1)
    cosines, sines = np.cos(circle * step).astype(single), np.sin(circle * step).astype(single)
    nearest = np.rint(echoes.bearing_rad / step).astype(np.intp)
    offsets = np.arange(-widest, widest + 1)
    aside = (offsets * step).astype(single) + (nearest * step - echoes.bearing_rad).astype(single)[
        :, None
    ]  # (n, offsets)
    place = (nearest % cells + pad)[:, None] + offsets
    rho = (echoes.x_m - space.origin_x_m).astype(single)[:, None] * cosines[place]
    rho += (echoes.y_m - space.origin_y_m).astype(single)[:, None] * sines[place]
    path = np.maximum(np.abs(aside) - echoes.half_cone_rad.astype(single)[:, None], single(0.0))
    rho += echoes.range_m.astype(single)[:, None] * np.cos(path)
    # The half-open right angle gives each undirected line through a point one vote, not two at +90 and -90 degrees.
    counted = (aside > -limit) & (aside <= limit)
    rho, alpha = rho[counted], circle[place[counted]]
    # A line between origin and sensor has a negative rho here: seen from the origin it faces the other way.
    alpha = np.where(rho < 0.0, alpha + cells // 2, alpha) % cells
    bins = (np.abs(rho) / single(space.rho_step_m)).astype(np.intp)
    inside = bins < space.rho_cells
    flat = (alpha * space.rho_cells + bins)[inside]
    return np.bincount(flat, minlength=cells * space.rho_cells).reshape(cells, space.rho_cells)


def chance_threshold(votes: Votes, min_votes: float, chance_sigmas: float) -> float:
    """Return how many votes a cell needs to be no chance: so many deviations above the mean of the cells that have any.

    Votes that fall at random are Poisson distributed, so the deviation is the root of the mean.
    """
    used = int(np.count_nonzero(votes))
    mean = float(votes.sum()) / used if used else 0.0
    return max(min_votes, mean + chance_sigmas * sqrt(mean))


def heavy_cells(votes: Votes, threshold: float) -> tuple[Index, Index]:
    """Return the cells (alpha indices, rho indices) with at least `threshold` votes, heaviest first (step 3)."""
    i, j = np.nonzero(votes >= threshold)
    order = np.lexsort((j, i, -votes[i, j]))
    return i[order], j[order]


def heaviest_nearby(votes: Votes, i: Index, j: Index, alpha_reach: int, rho_reach: int) -> Mask:
    """Say which of the cells (i, j) no other one outdoes within this many cells to either side; alpha wraps."""
    padded = np.pad(votes, ((0, 0), (rho_reach, rho_reach)))
    across = np.arange(-alpha_reach, alpha_reach + 1)[:, None]
    along = np.arange(2 * rho_reach + 1)
    around = padded[(i[:, None, None] + across) % len(votes), j[:, None, None] + along]
    heaviest: Mask = votes[i, j] >= around.max(axis=(1, 2), initial=0)
    return heaviest


def cell_lines(space: HoughSpace, i: Index, j: Index) -> tuple[Array, Array]:
    """Return alpha and rho, seen from the space's origin, of the middles of cells."""
    return i.astype(np.float64) * space.alpha_step_rad, (j + 0.5).astype(np.float64) * space.rho_step_m
