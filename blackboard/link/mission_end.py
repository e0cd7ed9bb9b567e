"""When a mission is over, and for whom."""

from blackboard.assembly import Assembly
from blackboard.board import Board
from blackboard.kinds import MISSION


def mission_over(board: Board) -> bool:
    """Say whether the mission has come to its end by its own word."""
    status = board.newest(MISSION)
    return status is not None and status.value.state != "underway"


def ends(assembly: Assembly) -> bool:
    """Say whether everything stands still when the robot's mission is over: one of several robots keeps out of the others' way."""
    return not assembly.mission.robot.of
