"""Knowledge sources of which nothing was kept: they take up what stands on the board, and number on above all that stood."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry
from blackboard.grid import UNKNOWN, Grid
from blackboard.kinds import (
    GRID,
    LINE,
    LINE_SET,
    MAP_FROM_ODOM,
    MODEL_LINE,
    MOTIVATION,
    NEW_AREA_VISITED,
    ODOM_FROM_ROBOT,
    POSE_ESTIMATE,
    ROBOT,
    SONAR_SCAN,
    SUPPORTED_POINTS,
    TARGET,
    TRAP,
    VERDICT,
)
from blackboard.messages.geometry import IDENTITY, Point, Pose, pack_array
from blackboard.messages.model import LineSet, ModelLine, PoseEstimate
from blackboard.messages.motion import Motivation
from blackboard.messages.sensing import RobotDescription, SonarScan, SonarSensor
from blackboard.messages.symbols import Target, Trap
from blackboard.messages.world import Line, PointSet
from blackboard.vocabulary import Vocabulary
from knowledge_sources.eou_grid import EouGrid
from knowledge_sources.eou_params import EouGridParams
from knowledge_sources.filter_raw import FilterRaw, FilterRawParams
from knowledge_sources.frontier_targets import FrontierTargets, FrontierTargetsParams
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_lines import JointLines
from knowledge_sources.line_finder import LineFinder
from knowledge_sources.line_finder_params import LineFinderParams
from knowledge_sources.routes import Routes, RoutesParams
from knowledge_sources.standing_hypotheses import Episodes, Found, Names, Reason
from knowledge_sources.verdicts import Verdicts

VOCABULARY = Vocabulary()
MOUNT = Pose(x_m=0.3, y_m=0.0, heading_rad=0.0)
ONE_SONAR = RobotDescription(
    name="one",
    radius_m=0.3,
    max_speed_mps=1.0,
    max_turn_radps=1.0,
    max_acceleration_mps2=0.5,
    sonars=(SonarSensor(mount=MOUNT, cone_rad=0.2, max_range_m=8.0),),
)
TRAPPED = Trap(trap="cycling", place=Point(x_m=0.0, y_m=0.0), size_m=1.0)


def robot_at(board: Board, now_s: float, heading_rad: float = 0.0) -> None:
    board.now_s = now_s
    if board.newest(ROBOT) is None:
        board.post(ROBOT, ONE_SONAR, source="robot")
        board.post(MAP_FROM_ODOM, IDENTITY, source="odometry")
    board.post(ODOM_FROM_ROBOT, Pose(x_m=0.0, y_m=0.0, heading_rad=heading_rad), source="odometry")


def hear(board: Board, source: KnowledgeSource[Any], range_m: float) -> None:
    scan = board.post(SONAR_SCAN, SonarScan(sensors=(0,), ranges_m=(range_m,)), source="robot")
    source.activate(scan, access(board, source))


def access(board: Board, source: KnowledgeSource[Any]) -> Access:
    return Access(board, source.name, VOCABULARY, source.posts)


def after(board: Board, gone: Iterable[Entry[Any]] = ()) -> Board:
    there = Board(VOCABULARY)
    there.load([*board.select(), *gone])
    there.now_s = board.now_s
    return there


def retracted(board: Board, kind: Any, id_: str, source: str) -> Entry[Any]:
    gone: list[Entry[Any]] = []
    board.subscribe(board.key(kind, id_), gone.append)
    board.retract(kind, id_, source=source)
    return gone[-1]


def test_the_grid_goes_on_from_the_tiles_that_stand() -> None:
    def grid_source() -> EouGrid:
        return EouGrid(EouGridParams(post_interval_s=0.0), name="grid")

    board, source = Board(VOCABULARY), grid_source()
    for number in range(5):
        robot_at(board, number * 0.2)
        hear(board, source, 3.0)
    there, second = after(board), grid_source()
    second.resume(None, access(there, second))
    robot_at(there, 2.0, heading_rad=3.0)  # it looks elsewhere now
    hear(there, second, 2.0)
    grid = Grid.from_tiles(entry.value for entry in there.entries(GRID))
    assert grid is not None
    seen_before, seen_now, never = grid.values_at(np.array([(2.0, 0.0), (-1.0, 0.15), (0.0, 4.0)])).tolist()
    assert seen_before < UNKNOWN
    assert seen_now < UNKNOWN
    assert never == UNKNOWN
    before = {entry.id: entry for entry in board.entries(GRID)}
    for entry in there.entries(GRID):
        old = before.get(entry.id)
        assert old is None or entry.revision in (old.revision, old.revision + 1)


def test_points_that_stand_in_a_batch_are_not_gathered_twice() -> None:
    board, source = (
        Board(VOCABULARY),
        FilterRaw(FilterRawParams(batch_points=10, min_step_m=0.0, use_grid=False), name="raw"),
    )
    for number in range(8):
        robot_at(board, number * 0.2)
        hear(board, source, 3.0)
    state = source.state()
    for number in range(8, 10):
        robot_at(board, number * 0.2)
        hear(board, source, 3.0)
    assert board.newest(SUPPORTED_POINTS) is not None
    second = FilterRaw(source.params, name="raw")
    second.resume(state, access(board, second))
    for number in range(10, 19):
        robot_at(board, number * 0.2)
        hear(board, second, 3.0)
    batch = board.newest(SUPPORTED_POINTS)
    assert batch is not None
    assert batch.revision == 1  # nine points since


def test_lines_of_a_batch_that_was_not_searched_to_its_end_are_taken_back() -> None:
    board = Board(VOCABULARY)
    start, end = Point(x_m=0.0, y_m=1.0), Point(x_m=2.0, y_m=1.0)
    line = Line(start=start, end=end, alpha_rad=1.5, rho_m=1.0, sigma_rho_m=0.01, support=20)
    for id_ in ("1-0", "1-1", "2-0", "3-0"):
        board.post(LINE, line, id=id_, source="lines")
    board.post(LINE_SET, LineSet(batch=2, lines=("2-0",)), source="lines")
    source = LineFinder(LineFinderParams(keep_batches=2), name="lines")
    source.resume(None, access(board, source))
    assert [entry.id for entry in board.entries(LINE)] == ["1-0", "1-1", "2-0"]
    robot_at(board, 1.0)
    few = pack_array(np.zeros((3, 2), dtype=np.float32))
    points = PointSet(
        points=few, sensed_from=few, half_cone_rad=pack_array(np.full(3, 0.1, dtype=np.float32)), dropped=0
    )
    for _ in range(3):
        batch = board.post(SUPPORTED_POINTS, points, source="raw")
        source.activate(batch, access(board, source))
    assert [entry.id for entry in board.entries(LINE)] == [
        "2-0"
    ]  # the oldest went with the third batch; 1 and 2 were known


def test_names_go_on_above_those_that_stood() -> None:
    names = Names("frontier", 0.5)
    names.resume({"frontier-2": (1.0, 0.0)}, last=7)
    assert names.name([(1.1, 0.0), (5.0, 0.0)]) == ["frontier-2", "frontier-8"]


def test_the_last_number_counts_what_was_retracted_and_nothing_of_others() -> None:
    board = Board(VOCABULARY)
    place = Point(x_m=0.0, y_m=0.0)
    target = Target(place=place, stand=place, reason="frontier", size_m=1.0)
    for id_ in ("frontier-3", "frontier-x", "line_end-9", "frontier-5"):
        board.post(TARGET, target, id=id_, source="targets")
    gone = retracted(board, TARGET, "frontier-5", "targets")
    there = after(board, [gone])
    assert Access(there, "targets", (), (TARGET,)).last_number(TARGET, "frontier-") == 5
    assert Access(board, "targets", (), (TARGET,)).last_number(TARGET, "frontier-") == 5
    assert Access(there, "targets", (), (TARGET,)).last_number(TARGET) == 0


def test_an_episode_that_lasts_is_the_same_and_the_next_is_another() -> None:
    board = Board(VOCABULARY)
    hand = Access(board, "traps", (), (TRAP,))
    Episodes(TRAP, "cycling").keep(hand, Found(TRAPPED, (), [Reason("so")]), "gone")
    for holds in (True, False, True):
        episodes: Episodes[Trap] = Episodes(TRAP, "cycling")
        episodes.resume(hand)
        episodes.keep(hand, Found(TRAPPED, (), [Reason("so")]) if holds else None, "gone")
    assert [entry.id for entry in board.entries(TRAP)] == ["cycling-2"]


def test_targets_that_stand_are_kept_or_taken_back_with_their_verdicts() -> None:
    board = Board(VOCABULARY)
    source = FrontierTargets(FrontierTargetsParams(), name="targets")
    hand, place = access(board, source), Point(x_m=50.0, y_m=0.0)
    target = Target(place=place, stand=place, reason="frontier", size_m=1.0)
    for id_ in ("frontier-3", "frontier-4"):
        entry = hand.post(TARGET, target, id=id_)
        Verdicts("endorsements").judge(hand, entry)
    board.retract(TARGET, "frontier-4", source="targets")
    source.resume(None, hand)
    assert [entry.id for entry in board.entries(VERDICT)] == ["target.frontier-3"]
    robot_at(board, 1.0)
    grid = Grid(0.05)
    grid.cover(-1.0, -1.0, 1.0, 1.0)
    grid.cells[:] = 0
    for tile in grid.take_changed():
        board.post(GRID, tile, id=f"{tile.column}_{tile.row}", source="grid")
    source.finish(hand)
    assert [entry.id for entry in board.entries(TARGET) if entry.id == "frontier-3"] == []
    assert all(int(str(entry.id).rpartition("-")[2]) > 4 for entry in board.entries(TARGET))


def test_the_joint_estimate_begins_where_the_pose_and_the_lines_stand() -> None:
    board = Board(VOCABULARY)
    robot_at(board, 3.0)
    board.post(MAP_FROM_ODOM, Pose(x_m=1.0, y_m=2.0, heading_rad=0.5), source="odometry")
    covariance = (0.04, 0.0, 0.0, 0.01, 0.0, 0.0025)
    board.post(POSE_ESTIMATE, PoseEstimate(map_from_robot=IDENTITY, covariance=covariance), source="joint")
    line = ModelLine(
        theta_rad=0.0,
        rho_m=-3.0,
        d_m=1.0,
        half_length_m=2.0,
        sigma_theta_rad=0.01,
        sigma_rho_m=0.02,
        covariance_theta_rho_m_rad=0.0,
        inherited_sigma_theta_rad=0.0,
        inherited_sigma_rho_m=0.0,
        faces_left=False,
        start=Point(x_m=-1.0, y_m=3.0),
        end=Point(x_m=3.0, y_m=3.0),
        observations=4,
    )
    board.post(MODEL_LINE, line, id="12", source="joint")
    source = JointLines(JointLinesParams(), name="joint")
    hand = Access(board, "joint", VOCABULARY, source.posts)
    source.resume(None, hand)
    robot_at(board, 3.2)
    hear(board, source, 2.0)
    estimate = board.newest(POSE_ESTIMATE)
    assert estimate is not None
    pose = estimate.value.map_from_robot
    assert np.allclose((pose.x_m, pose.y_m, pose.heading_rad), (1.0, 2.0, 0.5), atol=0.3)
    assert hand.last_number(MODEL_LINE) == 12
    assert board.entries(NEW_AREA_VISITED) == []


def test_a_route_that_was_asked_for_meanwhile_is_sought_with_the_next_tile() -> None:
    board, source = Board(VOCABULARY), Routes(RoutesParams(), name="routes")
    board.post(MOTIVATION, Motivation(on=True, number=3, parameters=(1.0, 0.0)), id="path_following", source="rules")
    tile_trigger = source.triggers[1]
    assert tile_trigger.when is not None
    tile = object()
    assert not tile_trigger.when(tile)
    source.resume(None, access(board, source))
    assert tile_trigger.when(tile)
