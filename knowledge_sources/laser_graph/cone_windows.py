"""What some keyframes of cones saw together, and how two such windows lie to each other.

One reading of a ring says too little to be placed; a window of them, carved, is a patch of walls. Points of a window bear the
normal of the line through their neighbours, as those of a scan do.
"""

from collections.abc import Iterable

import numpy as np
from scipy.spatial import cKDTree

from knowledge_sources.laser_graph.closures import Closures
from knowledge_sources.laser_graph.cones import Bools, Cones
from knowledge_sources.laser_graph.field import Field, Raster, Window, lay_field, search
from knowledge_sources.laser_graph.point_to_line import Surface, align, surface
from knowledge_sources.laser_graph.poses import Floats, between, transform
from knowledge_sources.laser_graph.scan_points import ScanPoints

HALF_WINDOW = 7  # keyframes to either side in the window that is placed
HALF_SUBMAP = 9  # and in what it is matched to, which must reach further
CONE_RASTER = Raster(cell_m=0.1, sigma_m=0.16)  # what carving leaves of an arc is about as thick
WALL_SIGMA_M = 0.1  # of a carved point about its wall
THIN_M = 0.07  # nearer points of a window count once
NORMAL_REACH_M = 0.35  # neighbours that tell a point's wall: two cells of the raster to either side
NORMAL_POINTS = 12
FEWEST_NEIGHBOURS = 5
SLENDER = 0.15  # variance across, of the whole: what is left of two arcs of one wall is more slender
FEWEST_POINTS = 20  # on walls, for a window to be worth a match
SEARCHED = 200  # points of a window that are searched with
LEAST_MATCHED = 0.5  # share of points on a wall
REACHES_M = (0.5, 0.4, 0.3, 0.25)


def window_points(cones: Cones, poses: Floats, keep: Bools, members: Iterable[int], frame: Floats) -> ScanPoints:
    """Return what is left of the arcs of some keyframes, in `frame`, with the normals of the walls they make."""
    points, sensors = [np.zeros((0, 2))], [np.zeros((0, 2))]
    for i in members:
        pose = between(frame, poses[i])
        points.append(transform(pose, cones.arcs[i][keep[i]]))
        sensors.append(transform(pose, cones.mounts[np.nonzero(keep[i])[0], :2]))
    placed, seen_from = np.concatenate(points), np.concatenate(sensors)
    cells = np.floor(placed / THIN_M).astype(np.int64)
    _, first = np.unique(cells[:, 0] * 2_000_003 + cells[:, 1], return_index=True)
    first.sort()
    return _with_normals(placed[first], seen_from[first])


def _with_normals(points: Floats, seen_from: Floats) -> ScanPoints:
    if len(points) < FEWEST_NEIGHBOURS:
        return ScanPoints(points, np.zeros_like(points), np.zeros(len(points), dtype=np.bool_))
    reach, nearest = cKDTree(points).query(
        points, k=min(NORMAL_POINTS, len(points)), distance_upper_bound=NORMAL_REACH_M
    )
    near = np.isfinite(reach)
    count = near.sum(axis=1)
    away = points[np.where(near, nearest, 0)] - points[:, None, :]
    x, y = np.where(near, away[..., 0], 0.0), np.where(near, away[..., 1], 0.0)
    mean_x, mean_y = x.sum(axis=1) / count, y.sum(axis=1) / count
    xx = (x * x).sum(axis=1) / count - mean_x**2
    yy = (y * y).sum(axis=1) / count - mean_y**2
    xy = (x * y).sum(axis=1) / count - mean_x * mean_y
    along = 0.5 * np.arctan2(2.0 * xy, xx - yy)
    half, apart = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    flat = (count >= FEWEST_NEIGHBOURS) & (half - apart < SLENDER * (half + apart))
    normals = np.stack([-np.sin(along), np.cos(along)], axis=1)
    normals[np.sum(normals * (seen_from - points), axis=1) < 0.0] *= -1.0  # walls are seen from one side
    return ScanPoints(points, normals, flat)


def match_windows(
    cones: Cones, poses: Floats, keep: Bools, pairs: list[tuple[int, int]], window: Window, least_fit: float
) -> Closures:
    """Match the window around each pair's later keyframe to the submap around the earlier one; return those that fit."""
    found: list[tuple[int, int, Floats, Floats]] = []
    submap: tuple[int, Field, Surface] | None = None
    seen: dict[int, ScanPoints] = {}
    barren = -1  # a keyframe around which there are too few points
    for j, i in sorted(pairs):
        if j == barren:
            continue
        if submap is None or submap[0] != j:
            there = window_points(cones, poses, keep, _around(j, HALF_SUBMAP, len(poses)), poses[j])
            if there.flat.sum() < FEWEST_POINTS:
                barren = j
                continue
            low, high = there.points.min(axis=0) - 0.5, there.points.max(axis=0) + 0.5
            field = lay_field(there.points, (low[0], low[1], high[0], high[1]), CONE_RASTER)
            submap = (j, field, surface(there.points[there.flat], there.normals[there.flat]))
        if i not in seen:
            seen[i] = window_points(cones, poses, keep, _around(i, HALF_WINDOW, len(poses)), poses[i])
        here = seen[i]
        if here.flat.sum() < FEWEST_POINTS:
            continue
        thinned = here.points[:: max(1, len(here.points) // SEARCHED)]
        start, fit = search(submap[1], thinned, between(poses[j], poses[i]), window)
        if fit < least_fit:
            continue
        points, normals = here.points[here.flat], here.normals[here.flat]
        result = align(submap[2], points, normals, start, start, np.diag([1.0, 1.0, 10.0]), REACHES_M, WALL_SIGMA_M)
        if result.matched_fraction >= LEAST_MATCHED:
            found.append((j, i, result.pose, result.information))
    return Closures.of(found)


def _around(i: int, half: int, count: int) -> range:
    return range(max(i - half, 0), min(i + half + 1, count))
