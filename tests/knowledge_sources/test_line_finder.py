"""The line finder on a board."""

from math import pi, radians

import numpy as np
import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.errors import BoardError, MissionError
from blackboard.kinds import LINE, LINE_SET, ROBOT, SUPPORTED_POINTS
from blackboard.messages.geometry import pack_array
from blackboard.messages.sensing import RobotDescription
from blackboard.messages.world import PointSet
from blackboard.parameters import parse_parameters
from blackboard.vocabulary import Vocabulary
from knowledge_sources.line_finder import LineFinder
from knowledge_sources.line_finder_params import LineFinderParams

ROBOT_OF_60_CM = RobotDescription(
    name="k2a", radius_m=0.3, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0
)


def two_walls() -> PointSet:
    """Return beams from (1, 1) to y = 3, and to x = 4 with a gap of 0.8 m."""
    level = [(x, 3.0) for x in np.linspace(-0.5, 2.5, 60)]
    upright = [(4.0, y) for y in np.linspace(-0.5, 2.9, 80) if not 0.6 < y < 1.4]
    points = np.array(level + upright, dtype=np.float32)
    return PointSet(
        points=pack_array(points),
        sensed_from=pack_array(np.ones_like(points)),
        half_cone_rad=pack_array(np.zeros(len(points), dtype=np.float32)),
    )


def bench(params: LineFinderParams | None = None, robot: bool = True) -> tuple[Board, Access, LineFinder]:
    board = Board(Vocabulary(), robot="k2a")
    if robot:
        board.post(ROBOT, ROBOT_OF_60_CM, source="robot")
    finder = LineFinder(params or LineFinderParams(), name="line_finder")
    return board, Access(board, finder.name, (SUPPORTED_POINTS, *finder.reads), finder.posts), finder


def test_a_batch_becomes_lines_that_know_where_they_come_from() -> None:
    board, access, finder = bench()
    board.now_s = 12.0
    points = board.post(SUPPORTED_POINTS, two_walls(), source="filter_raw", stamp_s=11.5)
    finder.activate(points, access)
    lines = board.entries(LINE)
    assert [entry.id for entry in lines] == [f"{points.revision}-{n}" for n in range(3)]
    for entry in lines:
        assert entry.supports == (points.as_support(),)
        assert entry.stamp_s == 11.5
        assert entry.source == "line_finder"
    level = [e.value for e in lines if abs(e.value.alpha_rad - pi / 2) < radians(1.0)]
    upright = [e.value for e in lines if abs(e.value.alpha_rad) < radians(1.0)]
    assert [round(line.rho_m, 2) for line in level] == [3.0]
    assert [round(line.rho_m, 2) for line in upright] == [4.0, 4.0]
    assert level[0].extent() == pytest.approx((-0.5, 3.0, 2.5, 3.0), abs=0.02)


def test_after_the_lines_of_a_batch_their_ids_are_posted() -> None:
    board, access, finder = bench()
    points = board.post(SUPPORTED_POINTS, two_walls(), source="filter_raw", stamp_s=0.0)
    finder.activate(points, access)
    batch = board.newest(LINE_SET)
    assert batch is not None
    assert batch.value.batch == points.revision
    assert list(batch.value.lines) == [entry.id for entry in board.entries(LINE)]
    assert (batch.supports, batch.stamp_s) == ((points.as_support(),), 0.0)


def test_lines_of_old_batches_are_taken_back() -> None:
    board, access, finder = bench(LineFinderParams(keep_batches=2))
    for second in range(4):
        board.now_s = float(second)
        finder.activate(board.post(SUPPORTED_POINTS, two_walls(), source="filter_raw"), access)
    newest = board.newest(SUPPORTED_POINTS)
    assert newest is not None
    batches = {str(entry.id).split("-")[0] for entry in board.entries(LINE)}
    assert batches == {str(newest.revision - 1), str(newest.revision)}


def test_a_wall_heard_rarely_is_found_when_its_echoes_have_come_together() -> None:
    board, access, finder = bench(LineFinderParams(leftovers=48))
    rng = np.random.default_rng(3)
    places = rng.uniform(-1.0, 1.0, 48)
    for number in range(6):  # eight echoes of y = 2 a batch: too few for a line
        here = np.stack([places[number::6], np.zeros(8)], axis=1).astype(np.float32)
        there = here + np.array([0.0, 2.0], dtype=np.float32)
        cones = np.full(8, radians(6.0), dtype=np.float32)
        points = PointSet(points=pack_array(there), sensed_from=pack_array(here), half_cone_rad=pack_array(cones))
        board.now_s = float(number)
        entry = board.post(SUPPORTED_POINTS, points, source="filter_raw")
        finder.activate(entry, access)
        if number == 1:
            assert board.entries(LINE) == []
    lines = board.entries(LINE)
    assert {round(line.value.rho_m, 3) for line in lines} == {2.0}
    support = lines[-1].supports[0]
    assert support.key == entry.key
    assert support.last - support.first >= 2


def test_what_waits_is_searched_at_the_end() -> None:
    board, access, finder = bench(LineFinderParams(min_support=60, leftovers=4000))
    walls = two_walls()
    cones = pack_array(np.full(walls.points.shape[0], 0.01, dtype=np.float32))
    points = PointSet(points=walls.points, sensed_from=walls.sensed_from, half_cone_rad=cones)
    for second in range(2):
        board.now_s = float(second)
        finder.activate(board.post(SUPPORTED_POINTS, points, source="filter_raw"), access)
    before = len(board.entries(LINE))
    finder.finish(access)
    assert len(board.entries(LINE)) > before


def test_nothing_came_nothing_is_searched() -> None:
    board, access, finder = bench()
    finder.finish(access)
    assert board.entries(LINE) == []


def test_without_the_robot_s_description_it_says_so() -> None:
    board, access, finder = bench(robot=False)
    points = board.post(SUPPORTED_POINTS, two_walls(), source="filter_raw")
    with pytest.raises(BoardError, match="status/robot"):
        finder.activate(points, access)


def test_parameters_come_from_a_mission_in_degrees() -> None:
    params = parse_parameters(LineFinderParams, {"method": "axis", "alpha_step_deg": 2.0}, "mission.toml")
    assert params.alpha_step_rad == pytest.approx(radians(2.0))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("alpha_step_rad", 0.0),
        ("rho_step_m", 0.0),
        ("reach_m", 0.01),
        ("cluster_fraction", 1.5),
        ("min_support", 2),
        ("max_incidence_rad", 2.0),
        ("keep_batches", 0),
        ("fit_distance_m", 0.0),
        ("min_length_m", -1.0),
        ("method", "both"),
    ],
)
def test_parameters_out_of_range_are_refused(key: str, value: object) -> None:
    with pytest.raises(MissionError, match=key):
        parse_parameters(LineFinderParams, {key: value}, "mission.toml")
