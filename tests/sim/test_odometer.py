"""What the wheels tell: exact without errors, and with them as wrong as the robot's file says."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from blackboard.messages.geometry import Pose
from sim.drive import arc
from sim.odometer import Odometer, drawn
from sim.sensor_models import OdometryModel

START = Pose(x_m=1.0, y_m=2.0, heading_rad=0.5)
PERFECT = OdometryModel()


def drive(model: OdometryModel | None, steps: list[tuple[float, float]], seed: int = 0) -> tuple[Pose, Pose]:
    """Return the true pose and the told one after steps of (distance, turn)."""
    odometer = Odometer(START, model, np.random.default_rng(seed))
    true = START
    for distance, turn in steps:
        x, y, heading = arc(true.x_m, true.y_m, true.heading_rad, distance, turn)
        true = Pose(x_m=x, y_m=y, heading_rad=heading)
        odometer.read(true, abs(distance), abs(turn))
    return true, odometer.pose


WAY = [(0.05, 0.02), (0.05, 0.0), (-0.03, -0.1), (0.0, 0.2)] * 50


def test_exact_wheels_tell_the_truth_bit_by_bit() -> None:
    true, told = drive(None, WAY)
    assert told == true


def test_a_model_without_errors_tells_the_truth() -> None:
    true, told = drive(PERFECT, WAY)
    assert told.distance_m(true) < 1e-9
    assert told.heading_rad == pytest.approx(true.heading_rad)


def test_a_scale_of_distance() -> None:
    _true, told = drive(replace(PERFECT, distance_scale=1.03), [(0.05, 0.0)] * 200)
    assert told.distance_m(START) == pytest.approx(10.3)


def test_a_scale_of_turning() -> None:
    _true, told = drive(replace(PERFECT, turn_scale=0.98), [(0.0, 0.05)] * 100)
    assert told.heading_rad == pytest.approx(0.5 + 4.9 - 2 * pi)
    assert told.distance_m(START) < 1e-9


def test_drift_bends_a_straight_way_into_an_arc() -> None:
    _true, told = drive(replace(PERFECT, drift_rad_per_m=0.01), [(0.05, 0.0)] * 200)
    assert told.heading_rad == pytest.approx(0.6)
    x, y, _heading = arc(1.0, 2.0, 0.5, 10.0, 0.1)
    assert (told.x_m, told.y_m) == pytest.approx((x, y), abs=1e-3)


@pytest.mark.parametrize("step", [0.05, 0.5])
def test_random_errors_grow_with_the_root_of_the_way_however_often_one_looks(step: float) -> None:
    model = replace(PERFECT, distance_noise_m=0.02, heading_noise_rad=0.03)
    told = [drive(model, [(step, 0.0)] * round(4 / step), seed)[1] for seed in range(300)]
    assert np.std([p.heading_rad for p in told]) == pytest.approx(0.03 * sqrt(4), rel=0.12)
    straight = [drive(replace(model, heading_noise_rad=0.0), [(step, 0.0)] * round(4 / step), s)[1] for s in range(300)]
    assert np.std([p.distance_m(START) for p in straight]) == pytest.approx(0.02 * sqrt(4), rel=0.12)


def test_turning_on_the_spot_errs_too() -> None:
    model = replace(PERFECT, turn_noise_rad=0.02)
    told = [drive(model, [(0.0, -0.1)] * 40, seed)[1] for seed in range(300)]
    assert np.std([p.heading_rad for p in told]) == pytest.approx(0.02 * 2.0, rel=0.12)


def test_drawn_wheels_err_by_what_was_given_as_one_sigma() -> None:
    model = OdometryModel(distance_scale=0.98, turn_scale=1.01, drift_rad_per_m=0.003, turn_noise_rad=0.01)
    wheels = [drawn(model, np.random.default_rng(seed)) for seed in range(400)]
    for name, sigma in (("distance_scale", 0.02), ("turn_scale", 0.01), ("drift_rad_per_m", 0.003)):
        off = np.array([getattr(w, name) for w in wheels]) - (0.0 if name == "drift_rad_per_m" else 1.0)
        assert np.std(off) == pytest.approx(sigma, rel=0.1)
        assert abs(off.mean()) < 0.2 * sigma
        assert np.abs(off).max() <= 3.0 * sigma + 1e-12
    assert {w.turn_noise_rad for w in wheels} == {0.01}
