from math import hypot

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.random_wander import RandomWander, RandomWanderParams, random_wander_response
from blackboard.errors import MissionError
from blackboard.messages.geometry import Pose

PARAMS = RandomWanderParams()


def test_a_heading_is_held_while_the_robot_turns_to_it() -> None:
    rng = np.random.default_rng(1)
    held, first = random_wander_response(None, 0.0, 0.0, rng, PARAMS)
    same, second = random_wander_response(held, held.heading_rad, 1.0, rng, PARAMS)
    assert same == held
    assert (second.forward, second.left) == (pytest.approx(PARAMS.strength), pytest.approx(0.0, abs=1e-12))
    assert hypot(first.forward, first.left) == pytest.approx(PARAMS.strength)


def test_after_a_while_comes_another() -> None:
    rng = np.random.default_rng(1)
    held, _ = random_wander_response(None, 0.0, 0.0, rng, PARAMS)
    assert PARAMS.hold_min_s <= held.until_s <= PARAMS.hold_max_s
    other, _ = random_wander_response(held, 0.0, held.until_s, rng, PARAMS)
    assert other.heading_rad != held.heading_rad


@given(st.integers(0, 10_000), st.floats(-3.1, 3.1), st.floats(0.1, 3.0))
def test_headings_stay_within_the_widest_turn(seed: int, heading: float, widest: float) -> None:
    params = RandomWanderParams(widest_turn_rad=widest)
    held, response = random_wander_response(None, heading, 0.0, np.random.default_rng(seed), params)
    off = abs((held.heading_rad - heading + np.pi) % (2 * np.pi) - np.pi)
    assert off <= widest + 1e-9
    assert hypot(response.forward, response.left) == pytest.approx(params.strength)


def test_the_same_seed_wanders_the_same_way(bench) -> None:
    def answers(seed: int) -> list[object]:
        wander = RandomWander(PARAMS, name="random_wander", seed=seed)
        found = []
        for i in range(50):
            bench.at(bench.board.now_s + 1.0, Pose(x_m=0.0, y_m=0.0, heading_rad=0.01 * i))
            found.append(wander.respond(bench.access))
        return found

    assert answers(3) == answers(3)
    assert answers(3) != answers(4)


def test_without_odometry_it_is_silent(bench) -> None:
    assert RandomWander(PARAMS, name="random_wander").respond(bench.access) is None


def test_wrong_parameters_are_refused() -> None:
    with pytest.raises(MissionError, match="hold_max_s"):
        RandomWanderParams(hold_min_s=5.0, hold_max_s=4.0)


def test_selected_anew_it_takes_a_fresh_heading(bench) -> None:
    wander = RandomWander(PARAMS, name="random_wander", seed=3)
    first = wander.respond(bench.at(0.0).access)
    assert wander.respond(bench.at(1.0).access) == first
    wander.select(())
    assert wander.respond(bench.at(1.1).access) != first
