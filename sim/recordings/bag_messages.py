"""What single ROS messages say: odometry, where a laser's beams look, sonars; and single ranges gathered to scans."""

from collections.abc import Iterator
from math import isfinite, pi
from struct import Struct
from typing import Any

import numpy as np

from blackboard.messages.base import FAR_M
from blackboard.messages.geometry import Pose
from blackboard.messages.sensing import MAX_BEAMS, Odometry, SonarSensor
from sim.recordings.cones import Fan
from sim.recordings.frames import yaw_of
from sim.recordings.ranges import DECIMALS
from sim.recordings.recording import Echoes, Heard

LITTLE_HEADER, BIG_HEADER = Struct("<III"), Struct(">III")  # seconds, nanoseconds, length of the frame
HEADER_BYTES = 16
TOGETHER_S = 0.005  # ranges no further apart than this were heard together
NARROW_RAD = pi / 180  # the cone of a range sensor that calls itself a ray
MAX_RANGE_M = 1000.0
MAX_SPEED = 100.0  # m/s and rad/s: no more can stand on the board


def stamp_and_frame(raw: bytes, *, ros2: bool) -> tuple[float, str]:
    """Return stamp and frame of a message that begins with a std_msgs/Header, without decoding the rest.

    In ROS 1 the header is sequence, seconds, nanoseconds, frame; in ROS 2 four bytes of encapsulation stand in the place of the
    sequence, the second of which tells the byte order. Raises ValueError where the message is too short.
    """
    if len(raw) < HEADER_BYTES:
        raise ValueError("the message breaks off")
    header = BIG_HEADER if ros2 and not raw[1] & 1 else LITTLE_HEADER
    seconds, nanoseconds, length = header.unpack_from(raw, 4)
    if len(raw) < HEADER_BYTES + length:
        raise ValueError("the message breaks off")
    return seconds + nanoseconds * 1e-9, raw[HEADER_BYTES : HEADER_BYTES + length].rstrip(b"\x00").decode(
        "utf-8", "replace"
    )


def planar_pose(position: Any, rotation: Any) -> Pose | None:
    """Return a pose brought down to the plane; None where it makes no sense."""
    try:
        heading_rad = yaw_of(rotation)
    except ValueError:
        return None
    if not (abs(position.x) <= FAR_M and abs(position.y) <= FAR_M):
        return None
    return Pose(x_m=float(position.x), y_m=float(position.y), heading_rad=heading_rad)


def odometry_of(message: Any) -> Odometry | None:
    """Return the planar odometry of a nav_msgs/Odometry; None where its pose makes no sense."""
    pose, twist = planar_pose(message.pose.pose.position, message.pose.pose.orientation), message.twist.twist
    if pose is None:
        return None
    forward_mps, turn_radps = float(twist.linear.x), float(twist.angular.z)
    if not (abs(forward_mps) <= MAX_SPEED and abs(turn_radps) <= MAX_SPEED):
        forward_mps = turn_radps = 0.0  # drivers that leave the speed out write anything there
    return Odometry(pose=pose, forward_mps=forward_mps, turn_radps=turn_radps)


def fan_of(message: Any, flipped: bool) -> Fan | None:
    """Return where the beams look, mirrored for a laser that hangs upside down; None where that makes no sense."""
    sign = -1.0 if flipped else 1.0
    fan = Fan(sign * float(message.angle_min), sign * float(message.angle_increment), len(message.ranges))
    sensible = abs(fan.angle_min_rad) <= 2 * pi and 0 < abs(fan.angle_step_rad) <= pi and 0 < fan.beams <= MAX_BEAMS
    return fan if sensible else None


def sonar_of(message: Any, mount: Pose) -> SonarSensor:
    """Return the sensor that a sensor_msgs/Range describes."""
    cone_rad = float(message.field_of_view)
    return SonarSensor(
        mount=mount,
        cone_rad=cone_rad if 0 < cone_rad <= 2 * pi else NARROW_RAD,
        max_range_m=reach_of(message.max_range),
    )


def reach_of(max_range_m: float) -> float:
    """Return the range at which nothing came back; drivers that do not know write zero, NaN or infinity."""
    return round(float(max_range_m), DECIMALS) if 0 < max_range_m <= MAX_RANGE_M else MAX_RANGE_M


def nearest_of(min_range_m: float) -> float:
    """Return the smallest range that the sensor can measure."""
    return float(min_range_m) if isfinite(min_range_m) else 0.0


class Together:
    """Gathers single ranges that were heard at the same time."""

    def __init__(self) -> None:
        self._stamp_s = 0.0
        self._ranges: dict[int, float] = {}

    def until(self, stamp_s: float, *, ranged: bool) -> Iterator[Heard]:
        """Yield what was gathered if `stamp_s` is past it; a range of another time ends it too, if earlier."""
        apart_s = stamp_s - self._stamp_s
        if apart_s > TOGETHER_S or (ranged and apart_s < -TOGETHER_S):
            yield from self.flush()

    def add(self, stamp_s: float, sensor: int, range_m: float) -> Iterator[Heard]:
        """Take a range; yield what was gathered before if this sensor spoke already."""
        if sensor in self._ranges:
            yield from self.flush()
        if not self._ranges:
            self._stamp_s = stamp_s
        self._ranges[sensor] = range_m

    def flush(self) -> Iterator[Heard]:
        """Yield what was gathered."""
        if self._ranges:
            sensors = tuple(sorted(self._ranges))
            yield Heard(self._stamp_s, Echoes(sensors, np.array([self._ranges[s] for s in sensors])))
            self._ranges = {}
