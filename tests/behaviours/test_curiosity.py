from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.curiosity import Curiosity, CuriosityParams, Spin, curiosity_response
from blackboard.errors import MissionError
from blackboard.messages.geometry import Pose, wrap_angle


@given(st.floats(-3.1, 3.1), st.floats(0.01, 1.5), st.sampled_from([-1.0, 1.0]))
def test_it_turns_once_about_wherever_it_began(start: float, step: float, sense: float) -> None:
    params = CuriosityParams(rate_radps=sense * 0.5)
    spin, turned, heading = Spin(), 0.0, start
    spin, response = curiosity_response(spin, heading, 0.0, params)
    while response is not None:
        assert response.turn_radps == params.rate_radps
        assert (response.forward, response.left) == (0.0, 0.0)
        heading, turned = wrap_angle(heading + sense * step), turned + step
        spin, response = curiosity_response(spin, heading, 0.0, params)
    assert 2 * pi - 1e-6 <= turned <= 2 * pi + step + 1e-6


def test_turning_back_does_not_count() -> None:
    params = CuriosityParams()
    spin = Spin()
    for heading in (0.0, 1.0, 0.5, 0.0, -1.0):
        spin, _ = curiosity_response(spin, heading, 0.0, params)
    assert spin.turned_rad == pytest.approx(-1.0)
    assert not spin.done


def test_it_gives_up_when_it_is_kept_from_turning() -> None:
    params = CuriosityParams(patience_s=30.0)
    spin, response = curiosity_response(Spin(), 0.0, 5.0, params)
    assert response is not None
    spin, response = curiosity_response(spin, 0.1, 34.9, params)
    assert response is not None
    spin, response = curiosity_response(spin, 0.1, 35.0, params)
    assert response is None
    assert curiosity_response(spin, 0.1, 36.0, params)[0].done


def test_through_the_board_it_is_done_and_stays_so(bench) -> None:
    curiosity = Curiosity(CuriosityParams(), name="curiosity")
    assert curiosity.respond(bench.access) is None
    answers = []
    for i in range(80):
        bench.at(0.1 * i, Pose(x_m=0.0, y_m=0.0, heading_rad=wrap_angle(0.1 * i)))
        answers.append(curiosity.respond(bench.access) is not None)
    assert answers == [True] * 63 + [False] * 17  # 63 readings are 6.2 rad apart
    assert curiosity.done()


def test_wrong_parameters_are_refused() -> None:
    with pytest.raises(MissionError, match="rate_radps"):
        CuriosityParams(rate_radps=0.0)
