"""Trap detectors: a U on the map, cycling, no progress."""

from collections import deque
from math import cos, pi, sin

import numpy as np
import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Support
from blackboard.grid import Grid, tile_id
from blackboard.kinds import GRID, LINE, ODOM_FROM_ROBOT, ROBOT, TRAP, VELOCITY
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.motion import Velocity
from blackboard.messages.sensing import RobotDescription
from blackboard.messages.symbols import Trap
from blackboard.messages.world import Line
from blackboard.vocabulary import Vocabulary
from knowledge_sources.cycling_trap import CyclingTrapParams, Look, Wayfarer
from knowledge_sources.no_progress_trap import Moment, NoProgressTrap, NoProgressTrapParams, no_progress
from knowledge_sources.u_traps import UTraps, UTrapsParams, u_shapes
from knowledge_sources.walls import Wall

RADIUS_M = 0.3
Ends = tuple[float, float, float, float]
U: tuple[Ends, ...] = ((2.0, 0.0, 2.0, 2.0), (0.2, 0.0, 1.9, 0.0), (0.2, 2.0, 1.9, 2.0))  # open to the left


def wall(number: int, ends: Ends) -> Wall:
    x0, y0, x1, y1 = ends
    return Wall(
        number=number, x_m=(x0 + x1) / 2, y_m=(y0 + y1) / 2, theta_rad=float(np.arctan2(y1 - y0, x1 - x0)),
        half_length_m=float(np.hypot(x1 - x0, y1 - y0)) / 2, sigma_rho_m=0.02, sigma_theta_rad=0.01, side=0,
    )  # fmt: skip


def empty(x0: float, y0: float, x1: float, y1: float) -> Grid:
    grid = Grid(0.05)
    grid.cover(-3.0, -3.0, 3.0, 3.0)
    columns = [round((x - grid.x_min_m) / 0.05) for x in (x0, x1)]
    rows = [round((y - grid.y_min_m) / 0.05) for y in (y0, y1)]
    grid.cells[rows[0] : rows[1], columns[0] : columns[1]] = 0
    return grid


def found_in(ends: tuple[Ends, ...], grid: Grid, radius_m: float = RADIUS_M) -> list[str]:
    return [u.name for u in u_shapes([wall(i + 1, e) for i, e in enumerate(ends)], grid, radius_m, UTrapsParams())]


def test_a_u_is_found_with_its_mouth_and_size() -> None:
    (found,) = u_shapes([wall(i + 1, e) for i, e in enumerate(U)], empty(-2, 0.05, 1.9, 1.95), RADIUS_M, UTrapsParams())
    assert found.name == "u-1-2-3"
    assert found.width_m == pytest.approx(2.0)
    assert found.depth_m == pytest.approx(1.8)
    assert abs(found.mouth_rad) == pytest.approx(pi)
    assert found.middle == pytest.approx((1.1, 1.0))
    assert found.holds(1.1, 1.0)
    assert not found.holds(-0.5, 1.0)


def test_what_is_no_u() -> None:
    room = empty(-2, 0.05, 1.9, 1.95)
    assert found_in(U[:2], room) == []  # an arm is missing
    assert found_in(U, empty(1.5, 0.05, 1.9, 1.95)) == []  # not known to be empty
    assert found_in(U, empty(0.3, 0.05, 1.9, 1.95)) == []  # nobody knows whether its mouth is open
    assert found_in(U, room, radius_m=1.1) == []  # too narrow for such a robot
    assert found_in((U[0], U[1], (2.1, 2.0, 2.9, 2.0)), room) == []  # an S: arms on both sides
    closed = empty(-2, 0.05, 1.9, 1.95)
    column = round((0.2 - closed.x_min_m) / 0.05)
    closed.cells[:, column - 2 : column + 2] = 255
    assert found_in(U, closed) == []
    assert found_in((U[0], (1.6, 0.0, 1.9, 0.0), U[2]), room) == []  # too shallow


@pytest.mark.parametrize("turn", [0.5, 1.7, 3.0, -2.0])
def test_a_turned_u_is_a_u(turn: float) -> None:
    c, s = cos(turn), sin(turn)
    turned = tuple((c * a - s * b, s * a + c * b, c * d - s * e, s * d + c * e) for a, b, d, e in U)
    assert found_in(turned, empty(-3, -3, 3, 3)) == ["u-1-2-3"]


def test_a_u_on_a_board() -> None:
    board = Board(Vocabulary())
    robot = RobotDescription(
        name="k2a", radius_m=RADIUS_M, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0
    )
    board.post(ROBOT, robot, source="robot")
    for tile in empty(-2, 0.05, 1.9, 1.95).take_changed():
        board.post(GRID, tile, id=tile_id(tile), source="grid")
    for i, (x0, y0, x1, y1) in enumerate(U):
        start, end = Point(x_m=x0, y_m=y0), Point(x_m=x1, y_m=y1)
        value = Line(start=start, end=end, alpha_rad=0.0, rho_m=0.0, sigma_rho_m=0.02, support=30)
        line = board.post(LINE, value, id=str(i), source="finder")
    source = UTraps(UTrapsParams(), name="u_traps")
    access = Access(board, source.name, (LINE, *source.reads), source.posts)
    source.activate(line, access)
    (entry,) = board.entries(TRAP)
    assert entry.value.trap == "u-shape"
    assert "2.0 m wide, 1.8 m deep" in entry.value.detail
    assert len(entry.supports) == 3
    board.retract(LINE, "0", source="finder")
    source.finish(access)
    assert board.entries(TRAP) == []


def walk(rounds: int, radius_m: float, learnt_m2: float, params: CyclingTrapParams) -> list[Trap | None]:
    """Return what is said second by second on a circle, 60 s a round, the map growing by so much a round."""
    wayfarer = Wayfarer(params, 0.6)
    said = []
    for t in range(60 * rounds):
        angle = 2 * pi * t / 60
        look = Look(float(t), radius_m * cos(angle), radius_m * sin(angle), 20.0 + learnt_m2 * t / 60)
        said.append(wayfarer.note(look))
    return said


def test_who_goes_round_and_round_without_learning_cycles() -> None:
    said = walk(4, 2.0, 0.0, CyclingTrapParams())
    assert said[:88] == [None] * 88  # the window is not full
    trap = said[-1]
    assert trap is not None
    assert (trap.place.x_m, trap.place.y_m) == pytest.approx((0.0, 0.0), abs=1.0)
    assert "m driven" in trap.detail


def test_who_learns_or_hardly_moves_does_not_cycle() -> None:
    assert walk(4, 2.0, 0.5, CyclingTrapParams())[-1] is None  # the map grows
    assert walk(4, 0.1, 0.0, CyclingTrapParams())[-1] is None  # stands, rather
    wayfarer = Wayfarer(CyclingTrapParams(), 0.6)
    straight = [wayfarer.note(Look(float(t), 0.3 * t, 0.0, 20.0)) for t in range(240)]
    assert straight[-1] is None  # always new places


def test_a_way_along_the_border_of_two_places_enters_each_once() -> None:
    wayfarer = Wayfarer(CyclingTrapParams(), 0.6)
    said = [wayfarer.note(Look(float(t), 0.3 * t, 0.05 * (-1) ** t, 20.0)) for t in range(240)]
    assert said[-1] is None


def moments(step_m: float, wanted_mps: float) -> "deque[Moment]":
    return deque(Moment(0.5 * i, step_m * (i % 2), 0.0, wanted_mps) for i in range(41))


def test_who_is_told_to_drive_and_stays_makes_no_progress() -> None:
    params = NoProgressTrapParams()
    trap = no_progress(moments(0.1, 0.2), RADIUS_M, params)
    assert trap is not None
    assert trap.size_m == pytest.approx(0.1)
    assert "told to drive 4.0 m in 20 s" in trap.detail
    assert no_progress(moments(0.1, 0.0), RADIUS_M, params) is None  # turns on the spot
    assert no_progress(moments(1.0, 0.2), RADIUS_M, params) is None  # gets somewhere
    assert no_progress(deque(list(moments(0.1, 0.2))[:20]), RADIUS_M, params) is None  # not long enough


def test_no_progress_on_a_board_comes_and_goes() -> None:
    board = Board(Vocabulary())
    robot = RobotDescription(
        name="k2a", radius_m=RADIUS_M, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0
    )
    board.post(ROBOT, robot, source="robot")
    source = NoProgressTrap(NoProgressTrapParams(), name="no_progress_trap")
    access = Access(board, source.name, (ODOM_FROM_ROBOT, *source.reads), source.posts)
    stood = []
    for i in range(120):
        board.now_s = 0.5 * i
        x_m = 0.0 if i < 60 else 0.15 * (i - 60)  # something gives way
        wanted = Velocity(forward_mps=0.3, turn_radps=0.0, valid_until_s=board.now_s + 1.0)
        board.post(VELOCITY, wanted, source="coordinator")
        pose = board.post(ODOM_FROM_ROBOT, Pose(x_m=x_m, y_m=0.0, heading_rad=0.0), source="odometry")
        source.activate(pose, access)
        stood.append(len(board.entries(TRAP)))
    assert stood[:38] == [0] * 38
    assert stood[45] == 1
    assert stood[-1] == 0
    key = board.key(TRAP, "no_progress-1")
    told = board.history.revisions(Support(key, 1, 9))
    assert [e.verdict for e in told[-1].endorsements] == ["for", "against"]
