"""What a scan says of chosen places: something answered there, it was seen through, or nothing was learnt.

A laser beam says it of what lies on it, a sonar's cone of all that lies in it. Silence says nothing: it may be a smooth wall at
a slant.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import LaserScan, RobotDescription, SonarScan
from knowledge_sources.sensors import laser_of, sonar_of

Floats = npt.NDArray[np.float64]
Looked = npt.NDArray[np.int8]

SEEN, UNKNOWN, THROUGH = 1, 0, -1
WIDEST_M = 0.5  # of a cone, across: the echo of a wider one may be of something else at the same range


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """n readings with an echo, map frame; metres and radians, (n,) each. Half the width of a laser's beam is half a step."""

    x_m: Floats
    y_m: Floats
    bearing_rad: Floats
    half_width_rad: Floats
    range_m: Floats


def beams_of(scan: SonarScan | LaserScan, robot: RobotDescription, map_from_robot: Pose) -> Beams:
    """Return a scan's readings as they lie in the map; raise BoardError for a sensor that the robot does not have."""
    heard = [(i, r) for i, r in enumerate(scan.ranges_m) if r is not None]
    index, ranges = np.array([i for i, _ in heard], dtype=np.int64), np.array([r for _, r in heard], dtype=np.float64)
    if isinstance(scan, LaserScan):
        pose = map_from_robot @ laser_of(robot, scan.laser).mount
        return Beams(
            x_m=np.full(len(index), pose.x_m),
            y_m=np.full(len(index), pose.y_m),
            bearing_rad=np.asarray(
                pose.heading_rad + scan.angle_min_rad + scan.angle_step_rad * index, dtype=np.float64
            ),
            half_width_rad=np.full(len(index), abs(scan.angle_step_rad) / 2),
            range_m=ranges,
        )
    sonars = [sonar_of(robot, scan.sensors[i]) for i in index.tolist()]
    poses = [map_from_robot @ sonar.mount for sonar in sonars]
    return Beams(
        x_m=np.array([pose.x_m for pose in poses]),
        y_m=np.array([pose.y_m for pose in poses]),
        bearing_rad=np.array([pose.heading_rad for pose in poses]),
        half_width_rad=np.array([sonar.cone_rad / 2 for sonar in sonars]),
        range_m=ranges,
    )


def look(beams: Beams, places: Floats, tolerance_m: float, reach_m: float) -> Looked:
    """Return for each of the places (k, 2) SEEN, THROUGH or UNKNOWN, (k,): hidden, out of reach, or not looked at.

    An echo within `tolerance_m` of a place's distance is of it, unless it was heard in too wide a cone; a longer one passed
    through it.
    """
    if not len(beams.range_m) or not len(places):
        return np.zeros(len(places), dtype=np.int8)
    dx, dy = places[:, :1] - beams.x_m, places[:, 1:] - beams.y_m  # (k, n)
    distance = np.hypot(dx, dy)
    aside = np.arctan2(dy, dx) - beams.bearing_rad
    aside = np.abs(aside - 2.0 * np.pi * np.rint(aside / (2.0 * np.pi)))
    in_it = (aside <= beams.half_width_rad * 1.001) & (distance <= reach_m)
    beyond = beams.range_m - distance
    narrow = 2.0 * beams.half_width_rad * beams.range_m <= WIDEST_M
    seen = (in_it & narrow & (np.abs(beyond) <= tolerance_m)).any(axis=1)
    through = (in_it & (beyond > tolerance_m)).any(axis=1)
    found: Looked = np.where(seen, SEEN, np.where(through, THROUGH, UNKNOWN)).astype(np.int8)
    return found
