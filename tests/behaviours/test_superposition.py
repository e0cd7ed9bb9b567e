from math import isfinite, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.superposition import Superposition, SuperpositionParams, summed, superposition_velocity
from blackboard.errors import MissionError
from blackboard.messages.motion import Response, Velocity
from blackboard.messages.sensing import RobotDescription

PARAMS = SuperpositionParams()
parts = st.floats(-20.0, 20.0)


def speeds(robot: RobotDescription, forward: float, left: float, turn: float = 0.0, last: int = 0) -> Velocity:
    return superposition_velocity(Response(forward=forward, left=left, turn_radps=turn), robot, 0.0, last, PARAMS)[1]


def test_responses_are_summed() -> None:
    total = summed(
        {"a": Response(forward=1.0, left=0.5), "b": Response(forward=-0.25, turn_radps=0.3), "c": Response(left=-0.5)}
    )
    assert total == Response(forward=0.75, left=0.0, turn_radps=0.3)


def test_straight_ahead_at_full_speed(ring: RobotDescription) -> None:
    assert speeds(ring, 1.0, 0.0) == Velocity(
        forward_mps=PARAMS.cruise_mps, turn_radps=0.0, valid_until_s=PARAMS.valid_for_s
    )
    assert speeds(ring, 5.0, 0.0).forward_mps == PARAMS.cruise_mps
    assert speeds(ring, 0.5, 0.0).forward_mps == pytest.approx(0.5 * PARAMS.cruise_mps)


def test_it_slows_by_the_cosine_and_turns_to_the_vector(ring: RobotDescription) -> None:
    velocity = speeds(ring, 0.5, 0.5 * 3**0.5)  # 60 degrees to the left
    assert velocity.forward_mps == pytest.approx(0.5 * PARAMS.cruise_mps)
    assert velocity.turn_radps == PARAMS.turn_radps
    assert speeds(ring, 1.0, 0.1).turn_radps == pytest.approx(PARAMS.turn_gain_per_s * 0.0996686525)


def test_a_vector_behind_turns_it_on_the_spot(ring: RobotDescription) -> None:
    velocity = speeds(ring, -1.0, 0.2)
    assert velocity.forward_mps == 0.0
    assert velocity.turn_radps == PARAMS.turn_radps


def test_a_turn_that_has_begun_keeps_its_side_while_the_vector_is_behind(ring: RobotDescription) -> None:
    assert speeds(ring, -1.0, 0.1, last=-1).turn_radps == -PARAMS.turn_radps
    assert speeds(ring, -1.0, -0.1, last=1).turn_radps == PARAMS.turn_radps
    assert speeds(ring, 1.0, 0.5, last=-1).turn_radps > 0.0


def test_turns_are_added_and_a_silent_sum_stands_still(ring: RobotDescription) -> None:
    assert speeds(ring, 0.0, 0.0, turn=0.5).turn_radps == 0.5
    assert speeds(ring, 0.01, 0.01) == Velocity(forward_mps=0.0, turn_radps=0.0, valid_until_s=PARAMS.valid_for_s)


ROBOT = RobotDescription(name="r", radius_m=0.3, max_speed_mps=1.0, max_turn_radps=2.0, max_acceleration_mps2=0.5)


@given(parts, parts.filter(lambda v: v != 0.0), st.floats(-3.0, 3.0), st.sampled_from([-1, 0, 1]))
def test_a_mirrored_sum_mirrors_the_speeds(forward: float, left: float, turn: float, last: int) -> None:
    one, other = speeds(ROBOT, forward, left, turn, last), speeds(ROBOT, forward, -left, -turn, -last)
    assert other.forward_mps == pytest.approx(one.forward_mps)
    assert other.turn_radps == pytest.approx(-one.turn_radps)


@given(parts, parts, st.floats(-100.0, 100.0), st.sampled_from([-1, 0, 1]))
def test_speeds_stay_within_limits(forward: float, left: float, turn: float, last: int) -> None:
    velocity = speeds(ROBOT, forward, left, turn, last)
    assert 0.0 <= velocity.forward_mps <= PARAMS.cruise_mps
    assert isfinite(velocity.turn_radps)
    assert abs(velocity.turn_radps) <= PARAMS.turn_radps


def test_the_coordinator_remembers_its_turn(ring: RobotDescription) -> None:
    coordinator = Superposition(PARAMS, name="coordinator")
    begun = coordinator.combine({"a": Response(forward=-1.0, left=-0.5)}, ring, 3.0)
    held = coordinator.combine({"a": Response(forward=-1.0, left=0.05)}, ring, 3.1)
    assert begun.turn_radps == held.turn_radps == -PARAMS.turn_radps
    assert held.valid_until_s == 3.1 + PARAMS.valid_for_s


def test_a_slow_robot_is_asked_for_no_more_than_it_can() -> None:
    slow = RobotDescription(name="s", radius_m=0.3, max_speed_mps=0.1, max_turn_radps=0.2, max_acceleration_mps2=0.5)
    assert speeds(slow, 1.0, 0.0).forward_mps == pytest.approx(0.1)
    assert speeds(slow, 0.0, 1.0).turn_radps == pytest.approx(0.2)


def test_wrong_parameters_are_refused() -> None:
    with pytest.raises(MissionError, match="about_rad"):
        SuperpositionParams(about_rad=pi / 4)
