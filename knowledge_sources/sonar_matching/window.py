"""The newest scans, and where their echoes were heard as seen from the robot's newest pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import RobotDescription, SonarScan
from knowledge_sources.sensors import sonar_of
from knowledge_sources.sonar_matching.pose_filter import corrected

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Kept:
    """A scan, and the odometry step to it from the scan kept before."""

    scan: SonarScan
    step: Pose


@dataclass(frozen=True, slots=True, eq=False)
class Heard:
    """Echoes, nearest first: `sensors` (n, 3) x_m, y_m, heading_rad in the newest robot frame; `ranges_m`, `cones_rad` (n,)."""

    sensors: Floats
    ranges_m: Floats
    cones_rad: Floats


def poses_back(kept: Sequence[Kept], errors: Floats) -> list[Pose]:
    """Return the pose of each scan as seen from the last one, by odometry without its errors."""
    poses = [IDENTITY]
    for newer in reversed(kept[1:]):
        poses.append(poses[-1] @ corrected(newer.step, errors).inverse())
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
