"""What a robot is, and what its sensors and wheels say."""

from math import pi
from typing import Annotated

from msgspec import Meta

from blackboard.messages.base import Angle, Fraction, Index, Message, Name, Range, Speed, TurnRate
from blackboard.messages.geometry import Pose

MAX_SONARS = 256
MAX_BEAMS = 8192
MAX_BLOBS = 1000

Echo = Range | None  # None: nothing came back


class SonarSensor(Message, frozen=True, kw_only=True):
    """One ultrasonic sensor: `mount` is robot_from_sonar, the cone's full width is `cone_rad`."""

    mount: Pose
    cone_rad: Annotated[float, Meta(gt=0.0, le=2 * pi)]
    max_range_m: Annotated[float, Meta(gt=0.0, le=1000.0)]


class LaserSensor(Message, frozen=True, kw_only=True):
    """One scanning laser: `mount` is robot_from_laser."""

    mount: Pose
    max_range_m: Annotated[float, Meta(gt=0.0, le=1000.0)]


class CameraSensor(Message, frozen=True, kw_only=True):
    """One camera that tells colours: `mount` is robot_from_camera, its field of view lies symmetrically about its heading."""

    mount: Pose
    field_rad: Annotated[float, Meta(gt=0.0, le=2 * pi)]
    max_range_m: Annotated[float, Meta(gt=0.0, le=1000.0)]


class RobotDescription(Message, frozen=True, kw_only=True):
    """The body and sensors of a robot, as its TOML file or its recording tells them."""

    name: Name
    radius_m: Annotated[float, Meta(gt=0.0, le=100.0)]
    max_speed_mps: Annotated[float, Meta(gt=0.0, le=100.0)]
    max_turn_radps: Annotated[float, Meta(gt=0.0, le=100.0)]
    max_acceleration_mps2: Annotated[float, Meta(gt=0.0, le=1000.0)]
    sonars: Annotated[tuple[SonarSensor, ...], Meta(max_length=MAX_SONARS)] = ()
    lasers: Annotated[tuple[LaserSensor, ...], Meta(max_length=16)] = ()
    cameras: Annotated[tuple[CameraSensor, ...], Meta(max_length=16)] = ()
    bumper: bool = False


class SonarScan(Message, frozen=True, kw_only=True):
    """Echoes of some or all sonars, taken at the entry's stamp: `ranges_m[i]` is that of sonar number `sensors[i]`."""

    sensors: Annotated[tuple[Index, ...], Meta(max_length=MAX_SONARS)]
    ranges_m: Annotated[tuple[Echo, ...], Meta(max_length=MAX_SONARS)]

    def __post_init__(self) -> None:
        if len(self.sensors) != len(self.ranges_m):
            raise ValueError(f"ranges_m has {len(self.ranges_m)} values for {len(self.sensors)} sensors")


class LaserScan(Message, frozen=True, kw_only=True):
    """One sweep of laser number `laser`: beam i looks along angle_min_rad + i * angle_step_rad in the laser's frame."""

    laser: Index = 0
    angle_min_rad: Angle
    angle_step_rad: Annotated[float, Meta(ge=-pi, le=pi)]
    ranges_m: Annotated[tuple[Echo, ...], Meta(max_length=MAX_BEAMS)]


class Blob(Message, frozen=True, kw_only=True):
    """A stretch of one colour: `bearing_rad` of its middle in the camera's frame, and how wide it looks."""

    bearing_rad: Angle
    width_rad: Annotated[float, Meta(ge=0.0, le=2 * pi)]
    colour: Name


class BlobScan(Message, frozen=True, kw_only=True):
    """All that camera number `camera` saw at once."""

    camera: Index = 0
    blobs: Annotated[tuple[Blob, ...], Meta(max_length=MAX_BLOBS)]


class Odometry(Message, frozen=True, kw_only=True):
    """What the wheels say: the pose in the robot's own odometry frame, which starts anywhere, and the speeds."""

    pose: Pose
    forward_mps: Speed = 0.0
    turn_radps: TurnRate = 0.0


class Bumper(Message, frozen=True, kw_only=True):
    """Contact: the directions in the robot frame in which something is touched; none of them: free."""

    bearings_rad: Annotated[tuple[Angle, ...], Meta(max_length=64)]


class Battery(Message, frozen=True, kw_only=True):
    """Charge left, of a full battery."""

    charge_fraction: Fraction
