"""What of a simulated world can be seen: the edges of its free floor.

An edge runs so that the free floor lies on its left; a solid without an inside (a line) has an edge on either side.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry.polygon import orient

from blackboard.component import WorldTruth

Segments = npt.NDArray[np.float64]  # (n, 4): x and y of the start, x and y of the end, m

STRAIGHT_M = 0.01  # corners that stand out less than this are no corners (Douglas and Peucker 1973)


def free_floor(truth: WorldTruth) -> Any:
    """Return the floor outside of solids, a shapely geometry."""
    areas = [part for part in shapely.get_parts(truth.solid) if shapely.get_dimensions(part) == 2]
    return shapely.difference(truth.floor, shapely.union_all(areas))


def surface(truth: WorldTruth) -> Any:
    """Return the boundary between free floor and all else, solids without an inside included, a shapely geometry."""
    thin = [part for part in shapely.get_parts(truth.solid) if shapely.get_dimensions(part) < 2]
    return shapely.union_all([shapely.boundary(free_floor(truth)), *thin])


def wall_edges(truth: WorldTruth) -> Segments:
    """Return the straight edges of the free floor, corners below STRAIGHT_M smoothed away."""
    chains: list[npt.NDArray[np.float64]] = []
    for part in shapely.get_parts(free_floor(truth)):
        if isinstance(part, shapely.Polygon) and not part.is_empty:
            polygon = orient(part)  # outer ring counter-clockwise, holes clockwise: floor on the left of both
            chains += [_ring_from_a_corner(shapely.get_coordinates(r)) for r in (polygon.exterior, *polygon.interiors)]
    for part in shapely.get_parts(truth.solid):
        if shapely.get_dimensions(part) == 1:
            there = shapely.get_coordinates(part)
            chains += [there, there[::-1]]
    edges = [_edges(chain) for chain in chains]
    return np.concatenate(edges) if edges else np.empty((0, 4))


@dataclass(frozen=True)
class Samples:
    """Points along segments, each standing for a piece of length: `points` (n, 2), unit `directions` (n, 2), `weights_m` (n,)."""

    points: npt.NDArray[np.float64]
    directions: npt.NDArray[np.float64]
    weights_m: npt.NDArray[np.float64]


def sample(segments: Segments, step_m: float) -> Samples:
    """Return the midpoints of equal pieces of each segment, no longer than `step_m`; segments without length give none."""
    spans = segments[:, 2:] - segments[:, :2]
    lengths = np.hypot(spans[:, 0], spans[:, 1])
    counts = np.where(lengths > 0, np.ceil(lengths / step_m - 1e-9), 0).astype(np.int64)
    owner = np.repeat(np.arange(len(segments)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    fractions = (number + 0.5) / counts[owner]
    return Samples(
        points=segments[owner, :2] + fractions[:, None] * spans[owner],
        directions=spans[owner] / lengths[owner, None],
        weights_m=lengths[owner] / counts[owner],
    )


def _ring_from_a_corner(ring: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the closed ring started at its point farthest from the middle, which is a corner for certain."""
    opened = ring[:-1]
    start = int(np.argmax(((opened - opened.mean(axis=0)) ** 2).sum(axis=1)))
    rolled = np.roll(opened, -start, axis=0)
    return np.concatenate([rolled, rolled[:1]])


def _edges(chain: npt.NDArray[np.float64]) -> Segments:
    kept = shapely.get_coordinates(shapely.simplify(shapely.LineString(chain), STRAIGHT_M, preserve_topology=False))
    edges = np.concatenate([kept[:-1], kept[1:]], axis=1)
    return np.asarray(edges[(edges[:, :2] != edges[:, 2:]).any(axis=1)])
