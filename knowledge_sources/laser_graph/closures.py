"""Finds where the robot came back to: scans matched to what was seen there on another pass.

Many candidates are tried and a modest fit is enough; what counts is that neighbours on the same pass agree, since a false match
stands alone (notes after Olson 2009, "Recognizing places using spectrally clustered local matches").
"""

from dataclasses import dataclass

import numpy as np

from knowledge_sources.laser_graph.field import Field, Window, lay_field, search
from knowledge_sources.laser_graph.front_end import placed
from knowledge_sources.laser_graph.point_to_line import Surface, align, surface
from knowledge_sources.laser_graph.pose_graph import Indices
from knowledge_sources.laser_graph.poses import Floats, between, compose, wrap
from knowledge_sources.laser_graph.scan_points import ScanPoints

SUBMAP = 3  # scans to either side of the one met again
APART = 15  # scans between two passes: fewer are the same pass
PASSES = 3  # earlier passes that one scan is matched to
FACING_RAD = 1.75  # scans that look further apart share too little
FEWEST_POINTS = 20  # of a scan that is worth a match
LEAST_FIT = 0.5  # mean fit of the search
LEAST_MATCHED = 0.5  # share of points on a line
NEIGHBOURS = 8  # scans to either side whose closures must agree
AGREEING = 2
AGREE_M = 0.35
AGREE_RAD = 0.12


@dataclass(frozen=True, eq=False)
class Closures:
    """Scan `last[k]` lies at `measured[k]` in the frame of scan `first[k]`."""

    first: Indices
    last: Indices
    measured: Floats
    information: Floats

    def __len__(self) -> int:
        return len(self.first)

    @staticmethod
    def of(found: list[tuple[int, int, Floats, Floats]]) -> "Closures":
        """Return closures out of (first, last, measured, information)."""
        return Closures(
            np.array([f[0] for f in found], dtype=np.intp),
            np.array([f[1] for f in found], dtype=np.intp),
            np.array([f[2] for f in found]).reshape(-1, 3),
            np.array([f[3] for f in found]).reshape(-1, 3, 3),
        )


def candidates(
    poses: Floats, near_m: float, every: int, apart: int = APART, facing_rad: float = FACING_RAD
) -> list[tuple[int, int]]:
    """Return pairs (first, last) of scans of different passes within `near_m`: the nearest one of each earlier pass."""
    pairs = []
    for i in range(apart, len(poses), every):
        earlier = poses[: i - apart + 1]
        distance = np.hypot(earlier[:, 0] - poses[i, 0], earlier[:, 1] - poses[i, 1])
        facing = np.abs(wrap(earlier[:, 2] - poses[i, 2]))
        near = np.flatnonzero((distance < near_m) & (facing < facing_rad))
        if not len(near):
            continue
        cost = distance + 0.5 * facing
        passes = np.split(near, np.flatnonzero(np.diff(near) > 3) + 1)
        nearest = sorted((int(p[np.argmin(cost[p])]) for p in passes), key=lambda j: (cost[j], j))
        pairs += [(j, i) for j in nearest[:PASSES]]
    return pairs


def match_all(scans: list[ScanPoints], poses: Floats, pairs: list[tuple[int, int]], window: Window) -> Closures:
    """Match each pair's later scan to the surroundings of the earlier one; return those that fit."""
    found: list[tuple[int, int, Floats, Floats]] = []
    there: tuple[int, Field, Surface] | None = None  # the surroundings of one scan serve all that are matched to it
    for j, i in sorted(pairs):
        if len(scans[i].points) < FEWEST_POINTS or len(scans[j].points) < FEWEST_POINTS:
            continue
        if there is None or there[0] != j:
            there = (j, *_surroundings(scans, poses, j))
        _, field, target = there
        guess = between(poses[j], poses[i])
        start, fit = search(field, scans[i].points[::3], guess, window)
        if fit < LEAST_FIT:
            continue
        flat = scans[i].flat
        result = align(
            target,
            scans[i].points[flat],
            scans[i].normals[flat],
            start,
            start,
            np.diag([1.0, 1.0, 10.0]),
            (0.3, 0.2, 0.1, 0.1),
        )
        if result.matched_fraction >= LEAST_MATCHED:
            found.append((j, i, result.pose, result.information))
    return Closures.of(found)


def _surroundings(scans: list[ScanPoints], poses: Floats, j: int) -> tuple[Field, Surface]:
    around = range(max(j - SUBMAP, 0), min(j + SUBMAP + 1, len(scans)))
    points, normals, flat = placed([scans[k] for k in around], between(poses[j], poses[list(around)]))
    low, high = points.min(axis=0) - 0.2, points.max(axis=0) + 0.2
    return lay_field(points, (low[0], low[1], high[0], high[1])), surface(points[flat], normals[flat])


def agreeing(closures: Closures, poses: Floats, agree_m: float = AGREE_M, agree_rad: float = AGREE_RAD) -> Closures:
    """Return the closures that at least two others of their neighbourhood bear out."""
    if not len(closures):
        return closures
    first, last = closures.first, closures.last
    near = (np.abs(first[:, None] - first) <= 2 * NEIGHBOURS) & (np.abs(last[:, None] - last) <= NEIGHBOURS)
    near &= last[:, None] != last
    one, other = np.nonzero(near)
    expected = compose(
        compose(between(poses[first[one]], poses[first[other]]), closures.measured[other]),
        between(poses[last[other]], poses[last[one]]),
    )
    seen = closures.measured[one]
    agree = np.hypot(expected[:, 0] - seen[:, 0], expected[:, 1] - seen[:, 1]) < agree_m
    agree &= np.abs(wrap(expected[:, 2] - seen[:, 2])) < agree_rad
    keep = np.bincount(one[agree], minlength=len(closures)) >= AGREEING
    return Closures(first[keep], last[keep], closures.measured[keep], closures.information[keep])
