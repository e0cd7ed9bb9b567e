"""The form in which lines are matched: the thesis's parameters by hand, covariances along a line, the side it was seen from."""

from math import pi, radians, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.messages.geometry import Point, wrap_angle
from blackboard.messages.world import Line
from knowledge_sources.line_estimates import (
    NoiseFloor,
    as_model_line,
    from_ends,
    from_line,
    from_model_line,
    line_covariance,
)

COVARIANCE = np.diag([0.01**2, 0.02**2])
places = st.floats(-20.0, 20.0)


def test_parameters_by_hand() -> None:
    line = from_ends((1.0, 2.0), (3.0, 2.0), COVARIANCE, True)
    assert (line.theta_rad, line.rho_m, line.d_m, line.half_length_m) == (0.0, -2.0, 2.0, 1.0)
    steep = from_ends((3.0, 1.0), (3.0, 5.0), COVARIANCE, True)
    assert steep.theta_rad == pytest.approx(pi / 2)
    assert (steep.rho_m, steep.d_m, steep.half_length_m) == pytest.approx((3.0, 3.0, 2.0))
    assert steep.ends[1] == pytest.approx((3.0, 5.0))


@given(places, places, places, places)
def test_flipping_negates_rho_and_d_and_turns_by_half(x0: float, y0: float, x1: float, y1: float) -> None:
    line = from_ends((x0, y0), (x1, y1), np.array([[4e-4, 1e-4], [1e-4, 4e-4]]), True)
    other = line.flipped()
    assert abs(wrap_angle(other.theta_rad - line.theta_rad)) == pytest.approx(pi)
    assert (other.rho_m, other.d_m) == pytest.approx((-line.rho_m, -line.d_m), abs=1e-9)
    assert not other.faces_left
    assert other.flipped().covariance == pytest.approx(line.covariance)
    # the same place along the line, told from either end, is as sure
    assert other.covariance_at(-1.5)[1, 1] == pytest.approx(line.covariance_at(1.5)[1, 1])


def test_an_offset_is_less_sure_the_further_from_the_middle() -> None:
    line = from_ends((-1.0, 0.0), (1.0, 0.0), COVARIANCE, True)
    # 3 m on, a tilt of 0.01 rad shifts it by 3 cm: 0.02^2 + 0.03^2, and against the normal
    assert line.covariance_at(3.0) == pytest.approx(np.array([[1e-4, -3e-4], [-3e-4, 13e-4]]))
    assert line.covariance_at(0.0) == pytest.approx(COVARIANCE)


def test_sigmas_by_hand() -> None:
    # 5 cm at most: 2 cm a point; 48 points count as 16: theta sqrt(3) 0.02 / (1 m sqrt(16)), offset 0.02 / sqrt(16)
    found = line_covariance(1.0, 0.05, 48, NoiseFloor(theta_rad=1e-9, rho_m=1e-9))
    assert np.sqrt(np.diag(found)) == pytest.approx([sqrt(3.0) * 0.005, 0.005])
    bounded = line_covariance(1.0, 0.0, 48, NoiseFloor(theta_rad=radians(1.0), rho_m=0.03))
    assert np.sqrt(np.diag(bounded)) == pytest.approx([radians(1.0), 0.03])


@pytest.mark.parametrize(("y_m", "left"), [(3.0, True), (-3.0, False)])
def test_the_side_is_that_of_the_sensors(y_m: float, left: bool) -> None:
    line = Line(
        start=Point(x_m=0.0, y_m=0.0),
        end=Point(x_m=2.0, y_m=0.0),
        alpha_rad=0.0,
        rho_m=0.0,
        sigma_rho_m=0.02,
        support=30,
    )
    sensors = np.array([[0.5, y_m], [1.5, y_m / 2]])
    assert from_line(line, sensors, NoiseFloor()).faces_left is left


@given(places, places, places, places, st.booleans())
def test_the_message_holds_the_line(x0: float, y0: float, x1: float, y1: float, left: bool) -> None:
    line = from_ends((x0, y0), (x1, y1), np.array([[4e-4, 1e-4], [1e-4, 4e-4]]), left)
    message = as_model_line(line, 0.01, 0.05, 3)
    back = from_model_line(message)
    assert (back.x_m, back.y_m) == pytest.approx((line.x_m, line.y_m), abs=1e-9)
    assert back.covariance == pytest.approx(line.covariance)
    assert back.faces_left is left
    assert message.sigma_rho_m == pytest.approx(sqrt(4e-4 + 0.05**2))
