"""Odometry through the board: a pose with the reading's stamp, and the odometry frame's place in the map, once."""

from typing import Any

from blackboard.board import Board
from blackboard.component import KnowledgeSource
from blackboard.control import Control
from blackboard.kinds import MAP_FROM_ODOM, ODOM_FROM_ROBOT, ODOMETRY
from blackboard.messages.geometry import IDENTITY, Pose
from blackboard.messages.sensing import Odometry
from blackboard.vocabulary import Vocabulary
from knowledge_sources.odometry_pose import OdometryPose, OdometryPoseParams


def run(source: KnowledgeSource[Any], stamps_s: list[float]) -> Board:
    board = Board(Vocabulary())
    control = Control(board, [source], strict=True)
    for i, stamp_s in enumerate(stamps_s):
        board.now_s = stamp_s + 0.05
        reading = Odometry(pose=Pose(x_m=float(i), y_m=0.0, heading_rad=0.5))
        board.post(ODOMETRY, reading, source="robot", stamp_s=stamp_s)
        control.run_cycle()
    return board


def test_each_reading_becomes_a_pose_at_its_stamp() -> None:
    board = run(OdometryPose(OdometryPoseParams(), name="odometry"), [1.0, 1.1, 1.2])
    entry = board.newest(ODOM_FROM_ROBOT)
    assert entry is not None
    assert (entry.revision, entry.stamp_s, entry.value.x_m) == (3, 1.2, 2.0)
    assert [(s.key, s.first, s.last) for s in entry.supports] == [(board.key(ODOMETRY), 3, 3)]


def test_the_odometry_frame_is_put_into_the_map_once() -> None:
    board = run(OdometryPose(OdometryPoseParams(), name="odometry"), [1.0, 1.1])
    entry = board.newest(MAP_FROM_ODOM)
    assert entry is not None
    assert (entry.value, entry.revision, entry.stamp_s) == (IDENTITY, 1, 1.0)


def test_another_source_may_own_the_odometry_frame() -> None:
    source = OdometryPose(OdometryPoseParams(post_map_from_odom=False), name="odometry")
    assert source.posts == (ODOM_FROM_ROBOT,)
    board = run(source, [1.0])
    assert board.newest(MAP_FROM_ODOM) is None
    board.post(MAP_FROM_ODOM, IDENTITY, source="rereference")  # which would be refused if this source owned it
