"""A laser's sweep: where its beams look, what they measure, what they miss."""

from math import cos, pi, radians

import numpy as np
import pytest
import shapely

from sim.laser import laser_sweep, sweep_ranges
from sim.sensor_models import LaserModel
from sim.shapes import Shapes, shapes_around


def room() -> Shapes:
    free = shapely.box(0, 0, 8, 5)
    return shapes_around(free, shapely.Polygon(), np.zeros((0, 3)), np.zeros(0, dtype=bool))


def sweep(model: LaserModel, x: float, y: float, heading: float, seed: int = 0) -> np.ndarray:
    return sweep_ranges(laser_sweep(model), x, y, heading, room(), model, np.random.default_rng(seed))


HALF_TURN = LaserModel(beams=181, field_rad=pi, max_range_m=20.0, noise_m=0.0)


def test_half_a_turn_in_a_room() -> None:
    ranges = sweep(HALF_TURN, 3.0, 2.0, 0.0)
    assert ranges[[0, 90, 180]].tolist() == pytest.approx([2.0, 5.0, 3.0])
    assert ranges[100] == pytest.approx(5.0 / cos(radians(10)))


def test_the_laser_may_sit_anywhere_and_look_anywhere() -> None:
    model = LaserModel(beams=3, field_rad=pi, max_range_m=20.0, noise_m=0.0, x_m=0.5, y_m=0.25, heading_rad=pi)
    ranges = sweep(model, 3.0, 2.0, pi / 2)  # stands at (2.75, 2.5), looks down
    assert ranges.tolist() == pytest.approx([2.75, 2.5, 5.25])


@pytest.mark.parametrize("beams", [4, 7, 360, 683])
@pytest.mark.parametrize("field_deg", [240.0, 360.0])
def test_more_than_half_a_turn_is_the_same_beam_by_beam(beams: int, field_deg: float) -> None:
    model = LaserModel(beams=beams, field_rad=radians(field_deg), max_range_m=20.0, noise_m=0.0)
    ranges = sweep(model, 3.0, 2.0, 0.3)
    assert ranges.shape == (beams,)
    first = laser_sweep(model).first_rad
    for beam in range(0, beams, max(1, beams // 12)):
        direction = first + beam * model.step_rad
        single = LaserModel(beams=3, field_rad=0.01, max_range_m=20.0, noise_m=0.0, heading_rad=direction)
        assert ranges[beam] == pytest.approx(sweep(single, 3.0, 2.0, 0.3)[1])


def test_noise_range_and_missed_beams() -> None:
    model = LaserModel(beams=181, field_rad=pi, max_range_m=5.5, noise_m=0.02, missed_fraction=0.25)
    exact = sweep(HALF_TURN, 3.0, 2.0, 0.0)
    ranges = np.array([sweep(model, 3.0, 2.0, 0.0, seed) for seed in range(50)])
    near = exact < 5.3
    back = np.isfinite(ranges[:, near])
    assert back.mean() == pytest.approx(0.75, abs=0.02)
    assert (ranges[:, near] - exact[near])[back].std() == pytest.approx(0.02, rel=0.05)
    assert np.isinf(ranges[:, exact > 5.7]).all()
