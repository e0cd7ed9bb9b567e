"""What the wheels say becomes the robot's pose in the odometry frame.

Triggered by  observations/signal/odometry             Odometry
Posts         observations/feature/odom_from_robot     Pose
              hypotheses/feature/map_from_odom         Pose: the identity, once, unless another source owns it
"""

from dataclasses import dataclass

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry
from blackboard.kinds import MAP_FROM_ODOM, ODOM_FROM_ROBOT, ODOMETRY
from blackboard.messages.geometry import IDENTITY
from blackboard.messages.sensing import Odometry


@dataclass(frozen=True, slots=True, kw_only=True)
class OdometryPoseParams:
    """Whether this source says where odometry stands in the map."""

    post_map_from_odom: bool = True  # false in a mission where a re-reference source owns it


class OdometryPose(KnowledgeSource[OdometryPoseParams]):
    """Posts the pose at each odometry reading, with the reading's stamp."""

    Params = OdometryPoseParams
    triggers = (ODOMETRY,)
    rating = 100.0  # everything that integrates readings needs it

    def __init__(self, params: OdometryPoseParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self.posts = (ODOM_FROM_ROBOT, MAP_FROM_ODOM) if params.post_map_from_odom else (ODOM_FROM_ROBOT,)

    def activate(self, trigger: Entry[Odometry], board: Access) -> None:
        board.post(ODOM_FROM_ROBOT, trigger.value.pose, supports=[trigger], stamp_s=trigger.stamp_s)
        if self.params.post_map_from_odom and board.newest(MAP_FROM_ODOM) is None:
            board.post(MAP_FROM_ODOM, IDENTITY, supports=[trigger], stamp_s=trigger.stamp_s)
