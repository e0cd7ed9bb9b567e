"""Where a bag's sensors sit on the robot: chains of transforms (/tf_static, /tf) brought down to the plane."""

from collections.abc import Iterable
from math import atan2
from typing import Any

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import Pose

MAX_TILT_SINE = 0.5  # a sensor that looks more than 30 degrees up or down does not measure in the plane

Transform = npt.NDArray[np.float64]  # (4, 4), homogeneous


def transform_of(translation: Any, rotation: Any) -> Transform:
    """Return the matrix of a ROS translation and quaternion. Raises ValueError where they are no transform."""
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    norm = x * x + y * y + z * z + w * w
    matrix = np.eye(4)
    matrix[:3, 3] = (translation.x, translation.y, translation.z)
    if not (np.isfinite(matrix).all() and 0.25 < norm < 4.0):
        raise ValueError("not a transform")
    s = 2.0 / norm
    matrix[:3, :3] = (
        (1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)),
        (s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)),
        (s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)),
    )
    return matrix


def yaw_of(rotation: Any) -> float:
    """Return the heading of a ROS quaternion. Raises ValueError where it is none."""
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    if not 0.25 < x * x + y * y + z * z + w * w < 4.0:
        raise ValueError("not a rotation")
    return atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def plain_name(frame: str) -> str:
    """Return a frame's name without the leading slash of older systems."""
    return frame.lstrip("/")


class Frames:
    """The frames of a robot's body; the first transform heard between two frames counts."""

    def __init__(self) -> None:
        self._neighbours: dict[str, dict[str, Transform]] = {}

    def add(self, parent: str, child: str, parent_from_child: Transform) -> None:
        """Take note of a transform."""
        if child not in self._neighbours.setdefault(parent, {}):
            self._neighbours[parent][child] = parent_from_child
            self._neighbours.setdefault(child, {})[parent] = np.asarray(np.linalg.inv(parent_from_child), np.float64)

    def chain(self, base: str, frame: str, avoid: Iterable[str] = ()) -> Transform | None:
        """Return base_from_frame by the shortest chain that passes through none of the frames `avoid`; None without one."""
        reached: dict[str, Transform] = {base: np.eye(4)}
        barred = set(avoid)
        queue = [base]
        for here in queue:
            if here == frame:
                return reached[here]
            for there, step in self._neighbours.get(here, {}).items():
                if there not in reached and there not in barred:
                    reached[there] = reached[here] @ step
                    queue.append(there)
        return None


def in_plane(base_from_sensor: Transform) -> tuple[Pose, bool, bool]:
    """Return the mount in the plane, whether the sensor looks along the plane, and whether it hangs upside down."""
    x_axis, z_axis = base_from_sensor[:3, 0], base_from_sensor[:3, 2]
    mount = Pose(
        x_m=round(float(base_from_sensor[0, 3]), 6),
        y_m=round(float(base_from_sensor[1, 3]), 6),
        heading_rad=atan2(float(x_axis[1]), float(x_axis[0])),
    )
    return mount, bool(abs(x_axis[2]) < MAX_TILT_SINE), bool(z_axis[2] < 0)
