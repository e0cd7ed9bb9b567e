"""The newest scans, and where their echoes were heard as seen from the robot's newest pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, sin

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import IDENTITY, Pose, wrap_angle
from blackboard.messages.sensing import RobotDescription, SonarScan
from knowledge_sources.sensors import sonar_of

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Told:
    """What odometry told at the stamp of a scan: the pose, and the way of the last second at the present speed."""

    odom_from_robot: Pose
    speed: Pose  # m and rad a second, robot frame


@dataclass(frozen=True, slots=True)
class Kept:
    """A scan, what odometry told then, and what it had told at the scan kept before."""

    scan: SonarScan
    told: Told
    before: Told


@dataclass(frozen=True, slots=True, eq=False)
class Heard:
    """Echoes, nearest first: `sensors` (n, 3) x_m, y_m, heading_rad in the newest robot frame; `ranges_m`, `cones_rad` (n,)."""

    sensors: Floats
    ranges_m: Floats
    cones_rad: Floats


def when_heard(told: Told, latency_s: float) -> Pose:
    """Return the odometry pose at which a scan was taken whose stamp is `latency_s` late."""
    way = told.speed
    return told.odom_from_robot @ Pose(
        x_m=-latency_s * way.x_m, y_m=-latency_s * way.y_m, heading_rad=wrap_angle(-latency_s * way.heading_rad)
    )


def corrected_step(before: Told, after: Told, errors: Floats) -> Pose:
    """Return the way from where one scan was taken to where another was, without what odometry and stamps are wrong by.

    `errors` (4,): distance (fraction), turn (fraction), drift (rad per metre), latency (s).
    """
    distance, turn, drift, latency_s = (float(e) for e in errors)
    step = when_heard(before, latency_s).inverse() @ when_heard(after, latency_s)
    turn_rad = step.heading_rad * (1.0 + turn) + drift * hypot(step.x_m, step.y_m)
    half_rad = (turn_rad - step.heading_rad) / 2.0  # the chord of an arc turns by half of what the heading turns
    c, s, scale = cos(half_rad), sin(half_rad), 1.0 + distance
    return Pose(
        x_m=scale * (c * step.x_m - s * step.y_m),
        y_m=scale * (s * step.x_m + c * step.y_m),
        heading_rad=wrap_angle(turn_rad),
    )


def poses_back(kept: Sequence[Kept], errors: Floats) -> list[Pose]:
    """Return the pose of each scan as seen from the last one, by odometry without its errors."""
    poses = [IDENTITY]
    for newer in reversed(kept[1:]):
        poses.append(poses[-1] @ corrected_step(newer.before, newer.told, errors).inverse())
    return poses[::-1]


def heard(
    scans: Sequence[SonarScan], newest_from_robot: Sequence[Pose], robot: RobotDescription, reach_m: float
) -> Heard:
    """Return the echoes within reach of scans taken at these poses; raise BoardError for a sonar that the robot lacks."""
    rows = []
    for scan, pose in zip(scans, newest_from_robot, strict=True):
        c, s = cos(pose.heading_rad), sin(pose.heading_rad)
        for number, range_m in zip(scan.sensors, scan.ranges_m, strict=True):
            sonar = sonar_of(robot, number)
            if range_m is None or range_m > reach_m:
                continue
            mount = sonar.mount
            x_m, y_m = pose.x_m + c * mount.x_m - s * mount.y_m, pose.y_m + s * mount.x_m + c * mount.y_m
            rows.append((x_m, y_m, pose.heading_rad + mount.heading_rad, range_m, sonar.cone_rad))
    table = np.array(rows, dtype=np.float64).reshape(-1, 5)
    table = table[np.argsort(table[:, 3], kind="stable")]
    return Heard(table[:, :3], table[:, 3], table[:, 4])
