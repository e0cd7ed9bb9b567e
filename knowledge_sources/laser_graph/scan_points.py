"""A laser sweep as points with the normals of the surfaces that they lie on.

The normal is that of the line fitted to the neighbouring beams' points, as in point-to-line matching (Censi 2008, "An ICP
variant using a point-to-line metric"). Points without enough neighbours on a line bear no normal.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserScan
from knowledge_sources.laser_graph.poses import Floats, transform

HALF_WINDOW = 3  # beams to either side that may share a surface
FEWEST = 4  # points that make a line worth a normal, the middle one counted
FLAT_M = 0.03  # rms distance from the line: a few times the noise of common lasers (0.01 m)


@dataclass(frozen=True, eq=False)
class ScanPoints:
    """The echoes of one sweep in the robot frame, metres: `points` (n, 2), `normals` (n, 2), `flat` (n,): has a normal."""

    points: Floats
    normals: Floats
    flat: npt.NDArray[np.bool_]


def scan_points(scan: LaserScan, mount: Pose, longest_m: float) -> ScanPoints:
    """Return the echoes nearer than `longest_m` of a sweep whose laser stands at `mount` (robot_from_laser)."""
    ranges = np.array([r or 0.0 for r in scan.ranges_m])
    beams = np.flatnonzero((ranges > 0.0) & (ranges < longest_m))
    angles = scan.angle_min_rad + scan.angle_step_rad * beams
    points = ranges[beams, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    robot_from_laser = np.array([mount.x_m, mount.y_m, mount.heading_rad])
    points = transform(robot_from_laser, points)
    normals, flat = _normals(points, beams, ranges[beams] * abs(scan.angle_step_rad))
    towards = robot_from_laser[:2] - points  # walls are seen from one side: normals look at the laser
    normals[np.sum(normals * towards, axis=1) < 0.0] *= -1.0
    return ScanPoints(points, normals, flat)


def _normals(points: Floats, beams: npt.NDArray[np.intp], spacing_m: Floats) -> tuple[Floats, npt.NDArray[np.bool_]]:
    n = len(points)
    if not n:
        return np.zeros((0, 2)), np.zeros(0, dtype=np.bool_)
    others = np.arange(n)[:, None] + np.arange(-HALF_WINDOW, HALF_WINDOW + 1)  # (n, window)
    inside = (others >= 0) & (others < n)
    others = np.clip(others, 0, n - 1)
    away = points[others] - points[:, None, :]
    steps = np.abs(beams[others] - beams[:, None])
    # a surface seen at a slant has its points further apart than one seen straight on: three times as far at 70 degrees
    near = inside & (np.hypot(away[..., 0], away[..., 1]) <= 0.05 + 3.0 * steps * spacing_m[:, None])
    count = near.sum(axis=1)
    weight = near[..., None] / np.maximum(count, 1)[:, None, None]
    centre = (away * weight).sum(axis=1)
    d = away - centre[:, None, :]
    xx, yy, xy = ((d[..., i] * d[..., j] * weight[..., 0]).sum(axis=1) for i, j in ((0, 0), (1, 1), (0, 1)))
    along = 0.5 * np.arctan2(2.0 * xy, xx - yy)
    half, apart = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    across = np.maximum(half - apart, 0.0)
    flat = (count >= FEWEST) & (across <= FLAT_M**2) & (across <= 0.1 * (half + apart))
    return np.stack([-np.sin(along), np.cos(along)], axis=1), flat
