"""Where the robot believes to be, for behaviours that go to places.

Reads  hypotheses/feature/map_from_odom        Pose
       observations/feature/odom_from_robot    Pose
"""

from typing import Any

from blackboard.access import Access
from blackboard.kinds import MAP_FROM_ODOM, ODOM_FROM_ROBOT, Kind
from blackboard.messages.geometry import IDENTITY, Pose

POSE_READS: tuple[Kind[Any], ...] = (MAP_FROM_ODOM, ODOM_FROM_ROBOT)


def map_from_robot(board: Access) -> Pose | None:
    """Return the robot's pose in the map; None before there is any."""
    odometry, correction = board.newest(ODOM_FROM_ROBOT), board.newest(MAP_FROM_ODOM)
    if odometry is None:
        return None
    return (correction.value if correction is not None else IDENTITY) @ odometry.value
