from math import cos, hypot, isfinite, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.avoid_obstacles import AvoidObstacles, AvoidObstaclesParams, avoid_obstacles_response, repulsive_force
from behaviours.near_echoes import Near
from blackboard.errors import MissionError

PARAMS = AvoidObstaclesParams()
RADIUS_M = 0.3
echoes = st.lists(st.tuples(st.floats(0.0, 3.0), st.floats(-3.1, 3.1)), max_size=20)


def near(range_m: float, bearing_rad: float) -> Near:
    return (range_m + RADIUS_M, bearing_rad, 0.1, 0.0, True)


def test_one_echo_pushes_by_the_square_of_its_nearness() -> None:
    forward, left = repulsive_force([near(0.5, 0.0)], RADIUS_M, PARAMS)
    assert (forward, left) == (pytest.approx(-4.0), pytest.approx(0.0))


def test_forces_of_the_ring_are_summed() -> None:
    # 0.5 m ahead, 1 m to the left, 2 m behind: F = (-4 + 1/4, -1)
    force = repulsive_force([near(0.5, 0.0), near(1.0, pi / 2), near(2.0, pi)], RADIUS_M, PARAMS)
    assert force == (pytest.approx(-3.75), pytest.approx(-1.0))


def test_only_the_nearest_of_a_sector_counts() -> None:
    force = repulsive_force([near(0.9, 0.1), near(0.5, 0.0), near(0.7, -0.1)], RADIUS_M, PARAMS)
    assert force == (pytest.approx(-4.0), pytest.approx(0.0))


def test_it_is_silent_below_the_threshold() -> None:
    assert avoid_obstacles_response([near(PARAMS.threshold_m + 0.01, 0.0)], RADIUS_M, PARAMS) is None
    assert avoid_obstacles_response([near(PARAMS.threshold_m - 0.01, 0.0)], RADIUS_M, PARAMS) is not None
    assert avoid_obstacles_response([], RADIUS_M, PARAMS) is None


def test_opposite_walls_balance() -> None:
    assert avoid_obstacles_response([near(0.3, pi / 2), near(0.3, -pi / 2)], RADIUS_M, PARAMS) is None


def test_close_by_it_outweighs_full_speed() -> None:
    at_balance = avoid_obstacles_response([near(PARAMS.balance_m, 0.0)], RADIUS_M, PARAMS)
    closer = avoid_obstacles_response([near(0.5 * PARAMS.balance_m, 0.0)], RADIUS_M, PARAMS)
    assert at_balance is not None
    assert closer is not None
    assert at_balance.forward == pytest.approx(-1.0)
    assert closer.forward == pytest.approx(-4.0)


@given(echoes)
def test_a_mirrored_world_mirrors_the_response(points: list[tuple[float, float]]) -> None:
    force = repulsive_force([near(r, b) for r, b in points], RADIUS_M, PARAMS)
    mirrored = repulsive_force([near(r, -b) for r, b in points], RADIUS_M, PARAMS)
    assert mirrored == (pytest.approx(force[0], abs=1e-6), pytest.approx(-force[1], abs=1e-6))


@given(echoes, st.integers(0, 11))
def test_a_turned_world_turns_the_force(points: list[tuple[float, float]], sectors: int) -> None:
    turn = sectors * pi / 6
    forward, left = repulsive_force([near(r, b) for r, b in points], RADIUS_M, PARAMS)
    turned = repulsive_force([near(r, b + turn) for r, b in points], RADIUS_M, PARAMS)
    assert turned == (
        pytest.approx(cos(turn) * forward - sin(turn) * left, abs=1e-6),
        pytest.approx(sin(turn) * forward + cos(turn) * left, abs=1e-6),
    )


@given(echoes)
def test_the_response_is_bounded(points: list[tuple[float, float]]) -> None:
    response = avoid_obstacles_response([near(r, b) for r, b in points], RADIUS_M, PARAMS)
    if response is not None:
        assert isfinite(response.forward)
        assert hypot(response.forward, response.left) <= 20.0 + 1e-9
        assert response.turn_radps == 0.0


def test_through_the_board_it_remembers_what_the_newest_scan_lost(bench) -> None:
    avoid = AvoidObstacles(PARAMS, name="avoid_obstacles")
    assert avoid.respond(bench.access) is None
    bench.at(0.0).hear({0: 0.3})
    first = avoid.respond(bench.access)
    bench.at(0.2).hear({0: None})
    second = avoid.respond(bench.access)
    assert first is not None
    assert first == second
    assert first.forward == pytest.approx(-((PARAMS.balance_m / 0.3) ** 2))


def test_wrong_parameters_are_refused() -> None:
    with pytest.raises(MissionError, match="threshold_m"):
        AvoidObstaclesParams(threshold_m=0.1)
