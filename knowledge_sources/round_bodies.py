"""Round bodies of a given size in one sweep of a laser, whatever sticks out of them.

A circle of that size goes through two points of a cluster, and most of the others lie on it; then one is fitted to those.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import radians

import numpy as np
import numpy.typing as npt

from knowledge_sources.looks import Beams

Floats = npt.NDArray[np.float64]

MOST_PAIRS = 300
STEPS = 5  # of Gauss-Newton; it converges in three


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyLimits:
    """What counts as a body of the model."""

    radius_m: float
    radius_error_m: float = 0.03  # a laser's noise of 1 cm on some twenty points of half a circle leaves about 1 cm
    part_m: float = 0.2  # so far something may stick out of it
    part_wedge_rad: float = radians(60)  # on one side only, as seen from the body's middle: else it is another thing
    jump_m: float = (
        0.3  # neighbouring beams whose ranges differ by more met different things: more than a part sticks out
    )
    reach_m: float = 2.5  # further off too few beams meet it
    tolerance_m: float = 0.025  # two and a half times a laser's noise
    least_points: int = 7
    least_arc_rad: float = radians(110)  # of the body; of a whole one some 150 degrees are in view, of a corner fewer


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundBody:
    """A circle that the points of one sweep lie on."""

    x_m: float
    y_m: float
    radius_m: float
    points: int


def clusters(beams: Beams, jump_m: float, reach_m: float) -> list[Floats]:
    """Return the points (n, 2) of what stands free before its background: what is beside its ends lies behind them."""
    ranges = beams.range_m
    if len(ranges) < 2:
        return []
    widest = 2.5 * float(beams.half_width_rad.max())  # a missing beam parts two clusters
    apart = (np.abs(np.diff(ranges)) > jump_m) | (np.abs(np.diff(beams.bearing_rad)) > widest)
    bounds = [0, *(np.flatnonzero(apart) + 1).tolist(), len(ranges)]
    points = np.stack(
        [beams.x_m + ranges * np.cos(beams.bearing_rad), beams.y_m + ranges * np.sin(beams.bearing_rad)], axis=1
    )
    found = []
    for first, past in pairwise(bounds):
        free_left = first == 0 or ranges[first - 1] > ranges[first]
        free_right = past == len(ranges) or ranges[past] > ranges[past - 1]
        if free_left and free_right and float(ranges[first:past].min()) <= reach_m:
            found.append(points[first:past])
    return found


def round_body(points: Floats, sensor: tuple[float, float], limits: BodyLimits) -> RoundBody | None:
    """Return the body that a cluster shows, seen from the sensor's place; None where it shows none of that size."""
    if len(points) < limits.least_points:
        return None
    centres = _centres(points, sensor, limits.radius_m)
    if not len(centres):
        return None
    off = np.abs(np.hypot(points[:, 0] - centres[:, :1], points[:, 1] - centres[:, 1:]) - limits.radius_m)
    on = off <= limits.tolerance_m  # (centres, points)
    best = int(np.argmax(on.sum(axis=1)))
    kept = points[on[best]]
    if len(kept) < limits.least_points:
        return None
    x, y, radius = _fit(kept, centres[best], limits.radius_m)
    away = np.hypot(kept[:, 0] - x, kept[:, 1] - y) - radius
    angles = np.unwrap(np.arctan2(kept[:, 1] - y, kept[:, 0] - x))
    if (
        abs(radius - limits.radius_m) > limits.radius_error_m
        or float(np.sqrt(np.mean(away * away))) > limits.tolerance_m / 1.5
        or float(np.ptp(angles)) < limits.least_arc_rad
        or not _is_part(points[~on[best]] - np.array([x, y]), radius, limits)
    ):
        return None
    return RoundBody(x_m=x, y_m=y, radius_m=radius, points=len(kept))


def _is_part(rest: Floats, radius_m: float, limits: BodyLimits) -> bool:
    """Say whether what is not on the body, relative to its middle, may be its part."""
    if not len(rest):
        return True
    reach_m = radius_m + limits.part_m + 2 * limits.tolerance_m
    angles = np.arctan2(rest[:, 1], rest[:, 0])
    mean = np.arctan2(np.sin(angles).sum(), np.cos(angles).sum())
    aside = angles - mean
    aside = np.abs(aside - 2.0 * np.pi * np.rint(aside / (2.0 * np.pi)))
    return float(np.hypot(rest[:, 0], rest[:, 1]).max()) <= reach_m and float(aside.max()) <= limits.part_wedge_rad / 2


def _centres(points: Floats, sensor: tuple[float, float], radius_m: float) -> Floats:
    """Return the centres (m, 2) of circles of this radius through pairs of points, on the side away from the sensor."""
    first, second = np.triu_indices(len(points), k=2)
    ends, chord = points[first], points[second] - points[first]
    length = np.hypot(chord[:, 0], chord[:, 1])
    usable = np.flatnonzero((length >= 0.5 * radius_m) & (length < 2.0 * radius_m))
    usable = usable[:: max(1, -(-len(usable) // MOST_PAIRS))]
    middle, chord, length = (ends + chord / 2)[usable], chord[usable], length[usable]
    up = np.sqrt(radius_m**2 - length**2 / 4) / np.maximum(length, 1e-9)
    normal = np.stack([-chord[:, 1], chord[:, 0]], axis=1) * up[:, None]
    away = middle - np.array(sensor)
    side = np.where((normal * away).sum(axis=1) >= 0.0, 1.0, -1.0)
    centres: Floats = middle + normal * side[:, None]
    return centres


def _fit(points: Floats, centre: Floats, radius_m: float) -> tuple[float, float, float]:
    """Return the circle x, y, radius that lies nearest to the points."""
    state = np.array([centre[0], centre[1], radius_m])
    for _ in range(STEPS):
        to = points - state[:2]
        distance = np.maximum(np.hypot(to[:, 0], to[:, 1]), 1e-9)
        slopes = np.stack([-to[:, 0] / distance, -to[:, 1] / distance, -np.ones(len(points))], axis=1)
        state = state - np.linalg.lstsq(slopes, distance - state[2], rcond=None)[0]
    return float(state[0]), float(state[1]), float(state[2])
