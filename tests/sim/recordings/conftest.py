"""Makes small recordings: CARMEN logs of chosen lines, ROS bags of chosen messages."""

from collections.abc import Callable, Sequence
from math import cos, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORE1, STORE2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)
STORE1.register(get_types_from_msg("geometry_msgs/msg/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
Messages = Sequence[tuple[str, float, Any]]


class Ros:
    """Builds messages of one ROS version; stamps in seconds."""

    def __init__(self, version: int) -> None:
        self.store: Any = STORE1 if version == 1 else STORE2
        self.extra: dict[str, Any] = {"seq": 0} if version == 1 else {}

    def make(self, type_: str, **fields: Any) -> Any:
        return self.store.types[type_](**fields)

    def header(self, stamp_s: float, frame: str) -> Any:
        time = self.make("builtin_interfaces/msg/Time", sec=int(stamp_s), nanosec=round(stamp_s % 1 * 1e9))
        return self.make("std_msgs/msg/Header", stamp=time, frame_id=frame, **self.extra)

    def range(
        self,
        stamp_s: float,
        frame: str,
        range_m: float,
        least_m: float = 0.1,
        most_m: float = 5.0,
        cone_rad: float = 0.25,
    ) -> Any:
        return self.make(
            "sensor_msgs/msg/Range",
            header=self.header(stamp_s, frame),
            radiation_type=0,
            field_of_view=cone_rad,
            min_range=least_m,
            max_range=most_m,
            range=range_m,
        )

    def scan(
        self, stamp_s: float, frame: str, ranges: Sequence[float], start_rad: float = -1.5, step_rad: float = 0.5
    ) -> Any:
        return self.make(
            "sensor_msgs/msg/LaserScan",
            header=self.header(stamp_s, frame),
            angle_min=start_rad,
            angle_max=start_rad + step_rad * (len(ranges) - 1),
            angle_increment=step_rad,
            time_increment=0.0,
            scan_time=0.1,
            range_min=0.1,
            range_max=8.0,
            ranges=np.array(ranges, np.float32),
            intensities=np.array([], np.float32),
        )

    def quaternion(self, yaw_rad: float, roll_rad: float = 0.0, pitch_rad: float = 0.0) -> Any:
        cr, sr = cos(roll_rad / 2), sin(roll_rad / 2)
        cp, sp = cos(pitch_rad / 2), sin(pitch_rad / 2)
        cy, sy = cos(yaw_rad / 2), sin(yaw_rad / 2)
        return self.make(
            "geometry_msgs/msg/Quaternion",
            x=sr * cp * cy - cr * sp * sy,
            y=cr * sp * cy + sr * cp * sy,
            z=cr * cp * sy - sr * sp * cy,
            w=cr * cp * cy + sr * sp * sy,
        )

    def odometry(
        self, stamp_s: float, x_m: float, y_m: float = 0.0, yaw_rad: float = 0.0, base: str = "base_link"
    ) -> Any:
        zero = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        forward = self.make("geometry_msgs/msg/Vector3", x=0.5, y=0.0, z=0.0)
        pose = self.make(
            "geometry_msgs/msg/Pose",
            position=self.make("geometry_msgs/msg/Point", x=x_m, y=y_m, z=0.0),
            orientation=self.quaternion(yaw_rad),
        )
        return self.make(
            "nav_msgs/msg/Odometry",
            header=self.header(stamp_s, "odom"),
            child_frame_id=base,
            pose=self.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36)),
            twist=self.make(
                "geometry_msgs/msg/TwistWithCovariance",
                twist=self.make("geometry_msgs/msg/Twist", linear=forward, angular=zero),
                covariance=np.zeros(36),
            ),
        )

    def transforms(self, *places: tuple[str, str, float, float, float], roll_rad: float = 0.0) -> Any:
        """Each place: parent, child, x, y, yaw."""
        return self.make(
            "tf2_msgs/msg/TFMessage",
            transforms=[
                self.make(
                    "geometry_msgs/msg/TransformStamped",
                    header=self.header(0.0, parent),
                    child_frame_id=child,
                    transform=self.make(
                        "geometry_msgs/msg/Transform",
                        translation=self.make("geometry_msgs/msg/Vector3", x=x_m, y=y_m, z=0.3),
                        rotation=self.quaternion(yaw_rad, roll_rad),
                    ),
                )
                for parent, child, x_m, y_m, yaw_rad in places
            ],
        )

    def string(self, text: str) -> Any:
        return self.make("std_msgs/msg/String", data=text)


@pytest.fixture
def ros1() -> Ros:
    return Ros(1)


@pytest.fixture
def ros2() -> Ros:
    return Ros(2)


@pytest.fixture
def write_bag() -> Callable[..., Path]:
    """Write messages (topic, time of receipt, message) to a ROS 1 bag, or an MCAP or sqlite3 folder of ROS 2."""

    def write(path: Path, messages: Messages, form: str = "mcap") -> Path:
        store: Any = STORE1 if form == "ros1" else STORE2
        plugin = StoragePlugin.SQLITE3 if form == "sqlite3" else StoragePlugin.MCAP
        writer: Any = Writer1(path) if form == "ros1" else Writer2(path, version=9, storage_plugin=plugin)
        with writer:
            connections: dict[str, Any] = {}
            for topic, received_s, message in messages:
                type_ = message.__msgtype__
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, type_, typestore=store)
                raw = store.serialize_ros1(message, type_) if form == "ros1" else store.serialize_cdr(message, type_)
                writer.write(connections[topic], round(received_s * 1e9), raw)
        return path

    return write


@pytest.fixture
def small_log() -> list[str]:
    """A drive of 1 m along x with a scan of 180 beams at its middle and at its end."""
    lines = ["# CARMEN Logfile", "PARAM robot_width 0.5 nohost 0"]
    for i in range(11):
        stamp = f"{1000 + 0.1 * i:.6f} host {1000 + 0.1 * i:.6f}"
        lines.append(f"ODOM {0.1 * i:.6f} 0.000000 0.000000 1.0 0.0 0.0 {stamp}")
        if i in (5, 10):
            ranges = " ".join(["81.83"] + ["2.50"] * 178 + ["81.91"])
            pose = f"{0.1 * i:.6f} 0.000000 0.000000"
            lines.append(f"FLASER 180 {ranges} {pose} {pose} {stamp}")
    return lines
