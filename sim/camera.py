"""A simple camera that tells colours: along its field of view, which stretches show a coloured thing that nothing hides.

It sees what its rays meet first: walls, things and people hide what is behind them, so that a thing half hidden looks narrow, and
two of one colour side by side look like one. It measures no range. Where a stretch ends it is told with noise; some are
missed, and now and then it sees one where none is.
"""

from collections.abc import Sequence
from itertools import groupby

import numpy as np
import numpy.typing as npt
import shapely

from blackboard.messages.sensing import Blob
from sim.raycast import Fans, cast
from sim.sensor_models import CameraModel
from sim.shapes import Floats, Shapes
from sim.world import Coloured

ON_M = 1e-3  # a ray that ends this near to a thing's surface ends on it
WIDEST_FALSE_RAD = 0.2  # of what is seen where nothing is


def camera_fan(model: CameraModel) -> Fans:
    """Return the camera's rays in the robot's frame."""
    return Fans(
        x_m=np.array([model.x_m]),
        y_m=np.array([model.y_m]),
        first_rad=np.array([model.heading_rad - model.field_rad / 2.0]),
        step_rad=model.field_rad / (model.rays - 1),
        rays=model.rays,
    )


def look(
    fan: Fans,
    shapes: Shapes,
    things: Sequence[Coloured],
    model: CameraModel,
    rng: np.random.Generator,
) -> tuple[Blob, ...]:
    """Return what a camera sees from where its fan stands (map frame), by bearing."""
    colours = sorted({thing.colour for thing in things})
    hits = cast(fan, shapes)
    ranges = hits.ranges_m[0]
    near = np.flatnonzero(ranges <= model.max_range_m)
    ends = np.stack(
        [fan.x_m[0] + ranges[near] * hits.direction_x[0, near], fan.y_m[0] + ranges[near] * hits.direction_y[0, near]],
        axis=1,
    )
    shown = np.full(model.rays, -1, dtype=np.intp)  # which colour each ray ends on
    for thing in things:
        shown[near[_on(ends, thing)]] = colours.index(thing.colour)
    first_rad = -model.field_rad / 2.0
    seen = []
    at = 0
    for colour, run in groupby(shown.tolist()):
        count = len(list(run))
        if colour >= 0:
            low, high = first_rad + fan.step_rad * (at - 0.5), first_rad + fan.step_rad * (at + count - 0.5)
            seen.append(_told(max(low, first_rad), min(high, -first_rad), colours[colour], model, rng))
        at += count
    kept = [one for one, missed in zip(seen, rng.random(len(seen)), strict=True) if missed >= model.missed_fraction]
    if rng.random() < model.false_fraction and colours:
        colour_seen = colours[int(rng.integers(len(colours)))]
        bearing, width = rng.uniform(first_rad, -first_rad), rng.uniform(fan.step_rad, WIDEST_FALSE_RAD)
        kept.append(_blob(float(bearing), float(width), colour_seen))
    return tuple(sorted(kept, key=lambda one: one.bearing_rad))


def _on(ends: Floats, thing: Coloured) -> npt.NDArray[np.bool_]:
    """Say which points (n, 2) lie on the surface of a thing."""
    x_min, y_min, x_max, y_max = shapely.bounds(thing.core)
    reach = thing.radius_m + ON_M
    on = (ends[:, 0] >= x_min - reach) & (ends[:, 0] <= x_max + reach)
    on &= (ends[:, 1] >= y_min - reach) & (ends[:, 1] <= y_max + reach)
    if on.any():
        away = shapely.distance(thing.core, shapely.points(ends[on]))
        on[np.flatnonzero(on)] = np.abs(away - thing.radius_m) <= ON_M
    return np.asarray(on, dtype=np.bool_)


def _told(low_rad: float, high_rad: float, colour: str, model: CameraModel, rng: np.random.Generator) -> Blob:
    low, high = np.sort(np.array([low_rad, high_rad]) + model.noise_rad * rng.standard_normal(2))
    return _blob(float(low + high) / 2.0, float(high - low), colour)


def _blob(bearing_rad: float, width_rad: float, colour: str) -> Blob:
    return Blob(bearing_rad=round(bearing_rad, 5), width_rad=round(width_rad, 5), colour=colour)
