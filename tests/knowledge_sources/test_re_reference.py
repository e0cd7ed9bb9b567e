"""The re-reference on a board: applied with its size and covariance, or refused as a conflict."""

from collections.abc import Sequence

import pytest

from blackboard.board import Board
from blackboard.control import Control
from blackboard.kinds import (
    LINE_MATCHES,
    LINE_SET,
    MAP_FROM_ODOM,
    ODOM_FROM_ROBOT,
    POSE_CONFLICT,
    POSE_ESTIMATE,
    RE_REFERENCE,
)
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.model import LineMatch, LineMatches, LineSet
from blackboard.vocabulary import Vocabulary
from knowledge_sources.re_reference import ReReferenceParams, ReReferencer


def match(number: int, theta: float, x: float, y: float, offset: float, turn: float = 0.0) -> LineMatch:
    return LineMatch(
        observed=f"1-{number}",
        model=str(number),
        theta_rad=theta,
        middle=Point(x_m=x, y_m=y),
        turn_rad=turn,
        offset_m=offset,
        covariance=(1e-4, 0.0, 1e-4),
        model_sigma_theta_rad=0.0,
        model_sigma_rho_m=0.02,
    )


def drive_and_match(matches: Sequence[LineMatch], batches: int = 1) -> Board:
    """Drive 4 m ahead in odometry, and then match lines."""
    board = Board(Vocabulary(), robot="k2a")
    control = Control(board, [ReReferencer(ReReferenceParams(), name="re_reference")], strict=True)
    for i in range(41):
        board.now_s = i / 10
        board.post(ODOM_FROM_ROBOT, Pose(x_m=i / 10, y_m=0.0, heading_rad=0.0), source="odometry_pose")
    for batch in range(1, batches + 1):
        value = LineSet(batch=batch, lines=tuple(m.observed for m in matches))
        board.post(LINE_SET, value, source="line_finder")
        control.run_cycle()
        board.post(LINE_MATCHES, LineMatches(batch=batch, matches=tuple(matches)), source="match_merge")
        control.run_cycle()
    return board


def test_a_correction_is_applied_with_its_supports_and_size() -> None:
    # a level wall, normal down, is 5 cm lower than seen; a steep one, normal to the right, 10 cm further on
    board = drive_and_match([match(1, 0.0, 4.0, 2.0, 0.05), match(2, 1.5707963, 6.0, 0.0, 0.10)])
    said, moved = board.newest(RE_REFERENCE), board.newest(MAP_FROM_ODOM)
    assert said is not None
    assert moved is not None
    assert said.value.applied
    assert said.value.shift.x_m == pytest.approx(0.1, abs=0.01)
    assert -0.05 < said.value.shift.y_m < -0.03  # odometry, sure that it went straight on, holds a little against it
    robot = moved.value @ Pose(x_m=4.0, y_m=0.0, heading_rad=0.0)
    assert (robot.x_m, robot.y_m) == pytest.approx((4.0 + said.value.shift.x_m, said.value.shift.y_m))
    assert robot.heading_rad == pytest.approx(said.value.turn_rad)
    assert board.key(LINE_MATCHES) in [s.key for s in moved.supports]
    assert said.value.lines == ("1-1", "1-2")


def test_the_covariance_is_kept() -> None:
    board = drive_and_match([match(1, 0.0, 4.0, 2.0, 0.0)])
    entry = board.newest(POSE_ESTIMATE)
    assert entry is not None
    assert entry.revision == 2  # before and after
    assert entry.value.map_from_robot.x_m == pytest.approx(4.0)
    xx, _, _, yy, _, _ = entry.value.covariance
    assert xx**0.5 == pytest.approx(0.03 * 4.0, rel=0.01)  # along the wall odometry alone speaks
    assert yy**0.5 == pytest.approx(0.02, rel=0.01)  # across it the wall does, as well as it is known itself


def test_in_a_corridor_the_robot_is_not_moved_along_it() -> None:
    board = drive_and_match([match(1, 0.0, 4.0, 1.0, 0.03), match(2, 0.0, 4.0, -1.0, 0.03)])
    moved = board.newest(MAP_FROM_ODOM)
    assert moved is not None
    robot = moved.value @ Pose(x_m=4.0, y_m=0.0, heading_rad=0.0)
    assert robot.x_m == pytest.approx(4.0, abs=1e-9)
    assert -0.03 < robot.y_m < -0.02  # odometry, sure that it went straight on, holds a little against it


def test_a_jump_that_cannot_be_is_refused_and_becomes_a_conflict() -> None:
    board = drive_and_match([match(1, 0.0, 4.0, 2.0, 1.0), match(2, 0.0, 4.0, -2.0, 1.0)])
    said, conflicts = board.newest(RE_REFERENCE), board.entries(POSE_CONFLICT)
    assert said is not None
    assert not said.value.applied
    assert board.newest(MAP_FROM_ODOM) is None
    assert [entry.id for entry in conflicts] == ["1"]
    assert conflicts[0].value.refused == said.value
    assert "2 lines ask for a jump" in conflicts[0].value.why


def test_without_matches_nothing_moves_and_that_is_said() -> None:
    board = drive_and_match([])
    said = board.newest(RE_REFERENCE)
    assert said is not None
    assert (said.value.applied, said.value.lines) == (True, ())
    assert board.newest(MAP_FROM_ODOM) is None


def test_the_same_lines_again_make_the_pose_no_surer_than_they_are() -> None:
    board = drive_and_match([match(1, 0.0, 4.0, 2.0, 0.0), match(2, 1.5707963, 6.0, 0.0, 0.0)], batches=20)
    entry = board.newest(POSE_ESTIMATE)
    assert entry is not None
    assert entry.value.covariance[0] ** 0.5 == pytest.approx(0.02, rel=0.01)
