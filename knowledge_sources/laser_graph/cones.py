"""Readings of wide sensors at a drive's keyframes: arcs where the echoes may have come from, sectors that were free.

A cone heard its nearest echo somewhere on an arc, and nothing nearer anywhere between its edges. Sonars are cones; a laser taken in
sectors, the nearest end in each, gives cones too.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
import numpy.typing as npt

from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan
from knowledge_sources.laser_graph.pose_graph import Indices
from knowledge_sources.laser_graph.poses import Floats

Bools = npt.NDArray[np.bool_]
SAMPLES = 7  # places on an arc: 0.06 m apart on the commonest arcs (15 degrees, 1.5 m)
WIDEST_M = 1.6  # wider arcs say too little of where the echo came from (15 degrees at 6 m, 30 at 3)
NEAREST_M = 0.1  # nearer echoes are of the robot itself, or of the sensor's ringing
SECTOR_RAD = pi / 36  # of a laser: five beams of a common one
MARGIN_M, MARGIN_FRACTION = 0.12, 0.02  # about the end of a cone: range noise, walls that are no lines, pose errors


@dataclass(frozen=True, eq=False)
class Cones:
    """c cones at each of n keyframes, robot frame, metres."""

    mounts: Floats  # (c, 3) robot_from_sensor
    widths_rad: Floats  # (c,)
    arcs: Floats  # (n, c, samples, 2)
    heard: Bools  # (n, c): there was an echo, near enough to say where
    free_m: Floats  # (n, c): how far each cone was empty; 0: not known

    def __len__(self) -> int:
        return len(self.arcs)


def cones_of_sonars(scans: Sequence[SonarScan], robot: RobotDescription) -> Cones:
    """Return what the sonars of a robot heard, one keyframe for each scan."""
    mounts = np.array([(s.mount.x_m, s.mount.y_m, s.mount.heading_rad) for s in robot.sonars]).reshape(-1, 3)
    ranges_m = np.full((len(scans), len(mounts)), np.nan)
    for row, scan in zip(ranges_m, scans, strict=True):
        row[list(scan.sensors)] = [np.nan if r is None else r for r in scan.ranges_m]
    return _cones(mounts, np.array([s.cone_rad for s in robot.sonars]), ranges_m, SAMPLES)


def cones_of_lasers(scans: Sequence[LaserScan], robot: RobotDescription) -> Cones:
    """Return the sweeps of a robot's lasers as cones all round each laser, one keyframe for each sweep."""
    sectors = round(2 * pi / SECTOR_RAD)
    ranges_m = np.full((len(scans), len(robot.lasers) * sectors), np.nan)
    for row, scan in zip(ranges_m, scans, strict=True):
        bearings = scan.angle_min_rad + scan.angle_step_rad * np.arange(len(scan.ranges_m))
        sector = np.floor(np.mod(bearings, 2 * pi) / SECTOR_RAD).astype(np.intp) % sectors
        np.fmin.at(row, scan.laser * sectors + sector, [np.nan if r is None else r for r in scan.ranges_m])
    middles = (np.arange(sectors) + 0.5) * SECTOR_RAD
    mounts = [(m.x_m, m.y_m, m.heading_rad + at) for m in (laser.mount for laser in robot.lasers) for at in middles]
    return _cones(np.array(mounts).reshape(-1, 3), np.full(len(mounts), SECTOR_RAD), ranges_m, 3)


def _cones(mounts: Floats, widths_rad: Floats, ranges_m: Floats, samples: int) -> Cones:
    longest_m = WIDEST_M / widths_rad
    known = np.isfinite(ranges_m)
    heard = known & (ranges_m > NEAREST_M) & (ranges_m < longest_m)
    across = (np.arange(samples) + 0.5) / samples - 0.5
    bearings = mounts[:, 2:] + widths_rad[:, None] * across  # (c, samples)
    directions = np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)
    arcs = mounts[:, None, :2] + np.where(heard, ranges_m, 0.0)[:, :, None, None] * directions
    return Cones(mounts, widths_rad, arcs, heard, np.where(known, np.minimum(ranges_m, longest_m), 0.0))


def depth(cones: Cones, viewers: Indices, points: Floats) -> Floats:
    """Return how deep points lie in what keyframes heard: beyond 1 in the free part of a cone, within 1 at its end, else behind.

    `points` (m, k, 2) are in the robot frame of keyframe `viewers[i]`; what no cone looks at lies at minus infinity.
    """
    deepest = np.full(points.shape[:2], -np.inf)
    places, group = np.unique(cones.mounts[:, :2], axis=0, return_inverse=True)
    for number, place in enumerate(places):  # the cones of one place share out the bearings around it
        members = np.flatnonzero(group.reshape(-1) == number)
        edges = cones.mounts[members, 2] - 0.5 * cones.widths_rad[members]
        starts = np.mod(edges - edges[0], 2 * pi)
        order = np.argsort(starts, kind="stable")
        members, starts = members[order], starts[order]
        x, y = points[..., 0] - place[0], points[..., 1] - place[1]
        bearings = np.mod(np.arctan2(y, x) - edges[0], 2 * pi)
        cone = np.searchsorted(starts, bearings.ravel(), side="right").reshape(bearings.shape) - 1
        inside = bearings < (starts + cones.widths_rad[members])[cone]
        free = np.take_along_axis(cones.free_m[viewers][:, members], cone, axis=1)
        inside &= free > 0.0
        here = (free - np.hypot(x, y)) / (MARGIN_M + MARGIN_FRACTION * free)
        np.maximum(deepest, np.where(inside, here, -np.inf), out=deepest)
    return deepest
