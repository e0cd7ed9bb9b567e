from math import isfinite, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.superposition import Superposition, SuperpositionParams, summed, superposition_velocity
from blackboard.access import Access
from blackboard.board import Board
from blackboard.errors import MissionError
from blackboard.messages.motion import Response, Velocity
from blackboard.messages.sensing import RobotDescription
from blackboard.vocabulary import Vocabulary

PARAMS = SuperpositionParams(weave_rad=0.0)
ROBOT = RobotDescription(name="r", radius_m=0.3, max_speed_mps=1.0, max_turn_radps=2.0, max_acceleration_mps2=0.5)
parts = st.floats(-20.0, 20.0)


def speeds(forward: float, left: float, turn: float = 0.0, last: int = 0, robot: RobotDescription = ROBOT) -> Velocity:
    return superposition_velocity(
        {"a": Response(forward=forward, left=left, turn_radps=turn)}, robot, 0.0, last, PARAMS
    )[1]


def test_responses_are_summed() -> None:
    total = summed(
        {"a": Response(forward=1.0, left=0.5), "b": Response(forward=-0.25, turn_radps=0.3), "c": Response(left=-0.5)}
    )
    assert total == Response(forward=0.75, left=0.0, turn_radps=0.3)


def test_straight_ahead_at_full_speed() -> None:
    assert speeds(1.0, 0.0) == Velocity(forward_mps=PARAMS.cruise_mps, turn_radps=0.0, valid_until_s=PARAMS.valid_for_s)
    assert speeds(5.0, 0.0).forward_mps == PARAMS.cruise_mps
    assert speeds(0.5, 0.0).forward_mps == pytest.approx(0.5 * PARAMS.cruise_mps)


def test_it_slows_by_the_cosine_and_turns_to_the_vector() -> None:
    velocity = speeds(0.5, 0.5 * 3**0.5)  # 60 degrees to the left
    assert velocity.forward_mps == pytest.approx(0.5 * PARAMS.cruise_mps)
    assert velocity.turn_radps == PARAMS.turn_radps
    assert speeds(1.0, 0.1).turn_radps == pytest.approx(PARAMS.turn_gain_per_s * 0.0996686525)  # atan(0.1)
    assert speeds(0.3, 0.03).turn_radps == pytest.approx(0.3015 * PARAMS.turn_gain_per_s * 0.0996686525, rel=1e-3)


def test_a_vector_behind_turns_it_on_the_spot() -> None:
    velocity = speeds(-1.0, 0.2)
    assert velocity.forward_mps == 0.0
    assert velocity.turn_radps == PARAMS.turn_radps


def test_a_turn_that_has_begun_keeps_its_side_while_the_vector_is_behind() -> None:
    assert speeds(-1.0, 0.1, last=-1).turn_radps == -PARAMS.turn_radps
    assert speeds(-1.0, -0.1, last=1).turn_radps == PARAMS.turn_radps
    assert speeds(1.0, 0.5, last=-1).turn_radps > 0.0


def test_turns_are_added_and_a_silent_sum_stands_still() -> None:
    assert speeds(0.0, 0.0, turn=0.5).turn_radps == 0.5
    assert speeds(0.01, 0.01) == Velocity(forward_mps=0.0, turn_radps=0.0, valid_until_s=PARAMS.valid_for_s)


@given(parts, parts.filter(lambda v: v != 0.0), st.floats(-3.0, 3.0), st.sampled_from([-1, 0, 1]))
def test_a_mirrored_sum_mirrors_the_speeds(forward: float, left: float, turn: float, last: int) -> None:
    one, other = speeds(forward, left, turn, last), speeds(forward, -left, -turn, -last)
    assert other.forward_mps == pytest.approx(one.forward_mps)
    assert other.turn_radps == pytest.approx(-one.turn_radps)


@given(parts, parts, st.floats(-100.0, 100.0), st.sampled_from([-1, 0, 1]))
def test_speeds_stay_within_limits(forward: float, left: float, turn: float, last: int) -> None:
    velocity = speeds(forward, left, turn, last)
    assert 0.0 <= velocity.forward_mps <= PARAMS.cruise_mps
    assert isfinite(velocity.turn_radps)
    assert abs(velocity.turn_radps) <= PARAMS.turn_radps


def test_vectors_that_cancel_turn_the_robot_on() -> None:
    against = {"a": Response(forward=1.0), "b": Response(forward=-0.98)}
    side, velocity = superposition_velocity(against, ROBOT, 0.0, -1, PARAMS)
    assert (side, velocity.forward_mps, velocity.turn_radps) == (-1, 0.0, -0.5 * PARAMS.turn_radps)
    side, _ = superposition_velocity(against, ROBOT, 0.0, 0, PARAMS)
    assert side == 1


def test_on_the_way_it_swings_its_heading_and_comes_back() -> None:
    params = SuperpositionParams()
    ahead = {"a": Response(forward=1.0)}
    rates = [superposition_velocity(ahead, ROBOT, 0.01 * i, 0, params)[1].turn_radps for i in range(300)]  # one period
    headings = [0.01 * sum(rates[:i]) for i in range(300)]
    assert max(headings) == pytest.approx(params.weave_rad, abs=0.01)
    assert min(headings) == pytest.approx(-params.weave_rad, abs=0.01)
    assert sum(rates) == pytest.approx(0.0, abs=1e-6)
    standing = superposition_velocity({"a": Response(turn_radps=0.3)}, ROBOT, 0.0, 0, params)[1]
    assert standing.turn_radps == 0.3


def test_the_coordinator_remembers_its_turn() -> None:
    coordinator = Superposition(PARAMS, name="coordinator")
    board = Board(Vocabulary())
    access = Access(board, "coordinator", (), ())
    board.now_s = 3.0
    begun = coordinator.combine({"a": Response(forward=-1.0, left=-0.5)}, ROBOT, access)
    board.now_s = 3.1
    held = coordinator.combine({"a": Response(forward=-1.0, left=0.05)}, ROBOT, access)
    assert begun.turn_radps == held.turn_radps == -PARAMS.turn_radps
    assert held.valid_until_s == 3.1 + PARAMS.valid_for_s


def test_a_slow_robot_is_asked_for_no_more_than_it_can() -> None:
    slow = RobotDescription(name="s", radius_m=0.3, max_speed_mps=0.1, max_turn_radps=0.2, max_acceleration_mps2=0.5)
    assert speeds(1.0, 0.0, robot=slow).forward_mps == pytest.approx(0.1)
    assert speeds(0.0, 1.0, robot=slow).turn_radps == pytest.approx(0.2)


def test_wrong_parameters_are_refused() -> None:
    with pytest.raises(MissionError, match="about_rad"):
        SuperpositionParams(about_rad=pi / 4)
