"""Where the robot was at a stamp: between two poses, after the newest, and when nobody can say."""

from math import pi

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.kinds import MAP_FROM_ODOM, ODOM_FROM_ROBOT
from blackboard.messages.geometry import Pose
from blackboard.vocabulary import Vocabulary
from knowledge_sources.poses import LONGEST_GAP_S, LONGEST_REACH_S, READS, map_from_robot_at, moved_on


def board_with(*poses: tuple[float, float, float]) -> tuple[Board, Access]:
    """Put poses (stamp, x, heading) on a board."""
    board = Board(Vocabulary())
    for stamp_s, x_m, heading_rad in poses:
        pose = Pose(x_m=x_m, y_m=0.0, heading_rad=heading_rad)
        board.post(ODOM_FROM_ROBOT, pose, source="wheels", stamp_s=stamp_s)
    return board, Access(board, "reader", READS, ())


def found(access: Access, stamp_s: float) -> tuple[Pose, tuple[Entry[Pose], ...]]:
    answer = map_from_robot_at(access, stamp_s)
    assert answer is not None
    return answer


def test_at_a_pose_s_own_stamp_it_is_that_pose() -> None:
    _, access = board_with((1.0, 0.0, 0.0), (2.0, 4.0, 0.0), (3.0, 9.0, 0.0))
    pose, supports = found(access, 2.0)
    assert pose.x_m == 4.0
    assert [e.revision for e in supports] == [2]


def test_between_two_poses_it_is_interpolated() -> None:
    _, access = board_with((1.0, 0.0, 3.0), (2.0, 4.0, -3.0))
    pose, supports = found(access, 1.25)
    assert pose.x_m == pytest.approx(1.0)
    assert pose.heading_rad == pytest.approx(3.0 + 0.25 * (2 * pi - 6.0))  # the short way, through pi
    assert [e.revision for e in supports] == [1, 2]


def test_after_the_newest_it_goes_on_at_the_same_speed_for_a_moment() -> None:
    _, access = board_with((1.0, 0.0, 0.0), (1.1, 0.05, 0.1))
    pose, supports = found(access, 1.3)
    assert (pose.x_m, pose.heading_rad) == pytest.approx((0.15, 0.3))
    assert [e.revision for e in supports] == [1, 2]
    assert map_from_robot_at(access, 1.1 + LONGEST_REACH_S + 0.01) is None


def test_poses_a_microsecond_apart_give_no_speed() -> None:
    # Repaired stamps may lie so; 1 cm in a microsecond would be 10 km/s.
    _, access = board_with((1.0, 0.0, 0.0), (1.1, 0.05, 0.0), (1.100001, 0.06, 0.0))
    assert found(access, 1.2)[0].x_m == pytest.approx(0.12, abs=1e-3)  # 6 cm in the last 0.1 s
    _, access = board_with((1.1, 0.05, 0.0), (1.100001, 0.06, 0.0))
    assert found(access, 1.2)[0].x_m == 0.06


def test_a_single_pose_serves_for_a_moment_before_and_after() -> None:
    _, access = board_with((1.0, 7.0, 0.0))
    assert found(access, 0.9)[0].x_m == found(access, 1.1)[0].x_m == 7.0
    assert map_from_robot_at(access, 1.0 - LONGEST_REACH_S - 0.01) is None


def test_a_long_gap_is_not_bridged() -> None:
    _, access = board_with((0.0, 0.0, 0.0), (LONGEST_GAP_S + 1.0, 8.0, 0.0))
    assert map_from_robot_at(access, 1.5) is None
    assert found(access, LONGEST_GAP_S + 0.9)[0].x_m == 8.0
    assert found(access, 0.1)[0].x_m == 0.0


def test_without_poses_there_is_none() -> None:
    _, access = board_with()
    assert map_from_robot_at(access, 1.0) is None


def test_the_newest_correction_applies() -> None:
    board, access = board_with((1.0, 2.0, 0.0))
    turn = Pose(x_m=1.0, y_m=0.0, heading_rad=pi / 2)
    board.post(MAP_FROM_ODOM, turn, source="rereference", stamp_s=5.0)
    pose, supports = found(access, 1.0)
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((1.0, 2.0, pi / 2))
    assert [e.key.rsplit("/", 1)[1] for e in supports] == ["odom_from_robot", "map_from_odom"]


def test_a_pose_counts_after_a_step_or_a_turn() -> None:
    last = Pose(x_m=1.0, y_m=0.0, heading_rad=3.1)
    assert moved_on(None, last, 0.1, 0.1)
    assert not moved_on(last, Pose(x_m=1.09, y_m=0.0, heading_rad=-3.1), 0.1, 0.1)  # 0.083 rad across the half turn
    assert moved_on(last, Pose(x_m=1.0, y_m=0.1, heading_rad=3.1), 0.1, 0.1)
    assert moved_on(last, Pose(x_m=1.0, y_m=0.0, heading_rad=2.99), 0.1, 0.1)
