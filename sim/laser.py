"""A scanning laser: one range a beam, with noise, and beams that do not come back."""

from dataclasses import dataclass
from math import ceil, pi

import numpy as np

from sim.raycast import Fans, cast
from sim.sensor_models import LaserModel
from sim.shapes import Floats, Shapes


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """A laser's beams as fans of at most half a turn each, in the robot's frame; the last fan's surplus rays are dropped."""

    fans: Fans
    beams: int
    first_rad: float  # in the laser's frame


def laser_sweep(model: LaserModel) -> Sweep:
    """Return the beams of a laser."""
    fans = max(1, ceil(model.beams * model.step_rad / pi - 1e-9)) if model.field_rad > pi + 1e-9 else 1
    rays = ceil(model.beams / fans)
    first = -model.step_rad * (model.beams - 1) / 2.0
    return Sweep(
        fans=Fans(
            x_m=np.full(fans, model.x_m),
            y_m=np.full(fans, model.y_m),
            first_rad=model.heading_rad + first + model.step_rad * rays * np.arange(fans, dtype=np.float64),
            step_rad=model.step_rad,
            rays=rays,
        ),
        beams=model.beams,
        first_rad=first,
    )


def sweep_ranges(
    sweep: Sweep,
    x_m: float,
    y_m: float,
    heading_rad: float,
    shapes: Shapes,
    model: LaserModel,
    rng: np.random.Generator,
) -> Floats:
    """Return one range a beam, (beams,), inf where nothing came back, of a robot that stands at a pose."""
    ranges = cast(sweep.fans.moved(x_m, y_m, heading_rad), shapes).ranges_m.ravel()[: sweep.beams]
    noise = rng.standard_normal(sweep.beams) * model.noise_m
    missed = rng.random(sweep.beams) < model.missed_fraction
    ranges = np.maximum(ranges + noise, 0.0)
    return np.where(missed | (ranges > model.max_range_m), np.inf, ranges)
