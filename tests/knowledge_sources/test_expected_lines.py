"""Expected lines on a board: what is in view from where the robot is in the map, told again when it has moved."""

import numpy as np

from blackboard.board import Board
from blackboard.control import Control
from blackboard.kinds import EXPECTED_LINES, MAP_FROM_ODOM, MODEL_LINE, NEW_AREA_VISITED, ODOM_FROM_ROBOT
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.model import ModelLine, NewAreaVisited
from blackboard.vocabulary import Vocabulary
from knowledge_sources.expected_lines import ExpectedLinesParams, ExpectedLinesSource
from knowledge_sources.line_estimates import as_model_line, from_ends


def line(x0: float, y0: float, x1: float, y1: float) -> ModelLine:
    return as_model_line(from_ends((x0, y0), (x1, y1), np.eye(2) * 1e-4, False), 0.0, 0.0, 1)


def bench() -> tuple[Board, Control]:
    board = Board(Vocabulary(), robot="k2a")
    source = ExpectedLinesSource(ExpectedLinesParams(), name="expected_lines")
    control = Control(board, [source], strict=True)
    board.post(MODEL_LINE, line(-2.0, 2.0, 2.0, 2.0), id="1", source="match_merge")
    board.post(MODEL_LINE, line(-2.0, 22.0, 2.0, 22.0), id="2", source="match_merge")
    doubtful = NewAreaVisited(line=line(-2.0, 1.0, -0.3, 1.0), seen_from=Point(x_m=0.0, y_m=0.0))
    board.post(NEW_AREA_VISITED, doubtful, id="3", source="match_merge")
    return board, control


def stand_at(board: Board, control: Control, x_m: float, y_m: float) -> None:
    board.now_s += 2.0
    board.post(ODOM_FROM_ROBOT, Pose(x_m=x_m, y_m=y_m, heading_rad=0.0), source="odometry_pose")
    control.run_cycle()


def test_what_is_in_view_is_told_with_the_lines_that_it_stands_on() -> None:
    board, control = bench()
    stand_at(board, control, -0.7, 0.0)
    entry = board.newest(EXPECTED_LINES)
    assert entry is not None
    assert (entry.value.model, entry.value.new_areas) == (("1",), ("3",))  # what is in doubt hides nothing
    assert board.key(MODEL_LINE, "1") in [s.key for s in entry.supports]


def test_the_map_counts_not_odometry() -> None:
    board, control = bench()
    board.post(MAP_FROM_ODOM, Pose(x_m=0.0, y_m=20.0, heading_rad=0.0), source="re_reference")
    stand_at(board, control, 0.0, 0.0)
    entry = board.newest(EXPECTED_LINES)
    assert entry is not None
    assert entry.value.model == ("2",)


def test_told_again_only_from_elsewhere() -> None:
    board, control = bench()
    for x in (0.0, 0.1, 0.15, 0.25):
        stand_at(board, control, x, 0.0)
    entry = board.newest(EXPECTED_LINES)
    assert entry is not None
    assert entry.revision == 2
