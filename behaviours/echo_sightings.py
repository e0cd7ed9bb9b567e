"""What a scan says about the nearest few metres: where something was heard, and how far each sensor looked."""

from math import cos, pi, sin
from typing import NamedTuple

from blackboard.messages.sensing import Bumper, LaserScan, RobotDescription, SonarScan

LASER_SECTOR_RAD = pi / 36  # a laser scan is thinned to the nearest beam of each 5 degrees


class Look(NamedTuple):
    """One sensor's view, robot frame: from (x_m, y_m) to an echo, or to `range_m` with nothing heard."""

    x_m: float
    y_m: float
    heading_rad: float
    half_cone_rad: float
    range_m: float
    echo: bool


class Sighting(NamedTuple):
    """Where something was heard: robot frame, on the axis of a cone that is `half_cone_rad` wide to either side."""

    x_m: float
    y_m: float
    half_cone_rad: float


def sonar_looks(scan: SonarScan, robot: RobotDescription) -> list[Look]:
    """Return the view of each sonar in the scan; sensors that the description does not name are left out."""
    looks = []
    for index, range_m in zip(scan.sensors, scan.ranges_m, strict=True):
        if index >= len(robot.sonars):
            continue
        sonar = robot.sonars[index]
        mount, limit_m = sonar.mount, sonar.max_range_m
        heard = range_m is not None and range_m < limit_m
        reach_m = range_m if range_m is not None and heard else limit_m
        looks.append(Look(mount.x_m, mount.y_m, mount.heading_rad, 0.5 * sonar.cone_rad, reach_m, heard))
    return looks


def laser_looks(scan: LaserScan, robot: RobotDescription) -> list[Look]:
    """Return the nearest beam of each 5 degrees as a look of that width; a sector without echo is left out."""
    if scan.laser >= len(robot.lasers) or scan.angle_step_rad == 0.0:
        return []
    laser = robot.lasers[scan.laser]
    mount, limit_m = laser.mount, laser.max_range_m
    step_rad, ranges_m = scan.angle_step_rad, scan.ranges_m
    per_sector = max(1, round(LASER_SECTOR_RAD / abs(step_rad)))
    half_rad = 0.5 * per_sector * abs(step_rad)
    looks = []
    for first in range(0, len(ranges_m), per_sector):
        nearest_m, beam = limit_m, -1
        for i in range(first, min(first + per_sector, len(ranges_m))):
            range_m = ranges_m[i]
            if range_m is not None and range_m < nearest_m:
                nearest_m, beam = range_m, i
        if beam >= 0:
            heading_rad = mount.heading_rad + scan.angle_min_rad + beam * step_rad
            looks.append(Look(mount.x_m, mount.y_m, heading_rad, half_rad, nearest_m, True))
    return looks


def sightings(looks: list[Look], within_m: float) -> list[Sighting]:
    """Return where the looks ended in an echo, as far as that is `within_m` of the robot's centre."""
    found = []
    for x, y, heading, half_cone, range_m, echo in looks:
        if echo and range_m <= 2.0 * within_m:
            px, py = x + range_m * cos(heading), y + range_m * sin(heading)
            if px * px + py * py <= within_m * within_m:
                found.append(Sighting(px, py, half_cone))
    return found


def contacts(bumper: Bumper, robot: RobotDescription) -> list[Sighting]:
    """Return what the bumper touches, as points on the rim."""
    return [Sighting(robot.radius_m * cos(b), robot.radius_m * sin(b), 0.0) for b in bumper.bearings_rad]
