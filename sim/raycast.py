"""Rays against segments and circles, for fans of rays: a sonar's cone is a small fan, a laser's sweep a large one.

Each thing is tried only with the rays of the interval of bearings that it covers, so the cost goes with what is seen and not
with rays times things.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
import numpy.typing as npt

from sim.shapes import Bools, Floats, Ints, Shapes

TURN = 2.0 * pi
EDGE_ON = 1e-12  # sine of the angle between a ray and a segment that it runs along
SEAM = 1e-9  # in ray steps: a ray through the corner of two segments must meet one of them


@dataclass(frozen=True, slots=True, eq=False)
class Fans:
    """f fans of `rays` rays each, `step_rad` apart; metres and radians in the frame of the shapes. No fan spans more than pi."""

    x_m: Floats  # (f,) where the rays start
    y_m: Floats
    first_rad: Floats  # (f,) direction of the first ray
    step_rad: float
    rays: int

    @property
    def span_rad(self) -> float:
        return self.step_rad * (self.rays - 1)

    def moved(self, x_m: float, y_m: float, heading_rad: float) -> "Fans":
        """Return the fans of a body that stands at a pose, these being given in the body's frame."""
        c, s = cos(heading_rad), sin(heading_rad)
        return Fans(
            x_m=x_m + c * self.x_m - s * self.y_m,
            y_m=y_m + s * self.x_m + c * self.y_m,
            first_rad=self.first_rad + heading_rad,
            step_rad=self.step_rad,
            rays=self.rays,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Hits:
    """What the rays met first. Bearings count from a fan's first ray and lie in (span - 2 pi, span]."""

    ranges_m: Floats  # (f, rays), inf where nothing is met
    thing: Ints  # (f, rays): a segment's index, or that of a circle plus the number of segments; -1: nothing
    direction_x: Floats  # (f, rays)
    direction_y: Floats
    corner_bearing_rad: Floats  # (f, n)
    circle_bearing_rad: Floats  # (f, c)
    circle_distance_m: Floats  # (f, c) to the centre


def cast(fans: Fans, shapes: Shapes) -> Hits:
    """Return what each ray of each fan meets first."""
    span, step, rays = fans.span_rad, fans.step_rad, fans.rays
    angle = fans.first_rad[:, None] + step * np.arange(rays)
    dir_x, dir_y = np.cos(angle), np.sin(angle)
    ox, oy, first = fans.x_m[:, None], fans.y_m[:, None], fans.first_rad[:, None]

    s = shapes.segments
    corner = _bearing(s.corner_y_m - oy, s.corner_x_m - ox, first, span)
    low = corner[:, s.end]  # seen from its right side, a segment runs clockwise
    extent = corner[:, s.start] - low
    extent[extent < 0.0] += TURN
    fan, thing, in_fan = _pairs(low, low + extent, extent < pi, step, rays)
    ray = fan * rays + in_fan
    ax, ay = s.start_x_m[thing] - fans.x_m[fan], s.start_y_m[thing] - fans.y_m[fan]
    ex, ey = s.edge_x_m[thing], s.edge_y_m[thing]
    dx, dy = dir_x.ravel()[ray], dir_y.ravel()[ray]
    slant = dx * ey - dy * ex
    distance = np.full(len(ray), np.inf)  # of a segment seen edge-on: its neighbours are met
    np.divide(ax * ey - ay * ex, slant, out=distance, where=np.abs(slant) > EDGE_ON * s.length_m[thing])

    to_x, to_y = shapes.circles[0] - ox, shapes.circles[1] - oy
    centre_m = np.sqrt(to_x * to_x + to_y * to_y)
    circle = _bearing(to_y, to_x, first, span)
    if len(shapes.circle_rough):
        radius = shapes.circles[2]
        half = np.arcsin(np.minimum(radius / np.maximum(centre_m, 1e-9), 1.0))
        low = circle - half
        low[low <= span - TURN] += TURN  # centred beyond the fan's last ray, but reaching into it
        fan, which, in_fan = _pairs(low, low + 2.0 * half, centre_m > radius, step, rays)
        if len(fan):
            ray_c = fan * rays + in_fan
            cx, cy = to_x[fan, which], to_y[fan, which]
            dx, dy = dir_x.ravel()[ray_c], dir_y.ravel()[ray_c]
            off_axis = dx * cy - dy * cx
            half_chord = np.sqrt(np.maximum(radius[which] ** 2 - off_axis * off_axis, 0.0))
            ray = np.concatenate((ray, ray_c))
            distance = np.concatenate((distance, dx * cx + dy * cy - half_chord))
            thing = np.concatenate((thing, which + len(s.start)))

    ranges = np.full(dir_x.size, np.inf)
    np.minimum.at(ranges, ray, distance)
    first_met = distance <= ranges[ray]
    met = np.full(dir_x.size, -1, dtype=np.intp)
    met[ray[first_met]] = thing[first_met]
    return Hits(
        ranges_m=np.maximum(ranges, 0.0).reshape(-1, rays),
        thing=met.reshape(-1, rays),
        direction_x=dir_x,
        direction_y=dir_y,
        corner_bearing_rad=corner,
        circle_bearing_rad=circle,
        circle_distance_m=centre_m,
    )


def incidence_cosines(hits: Hits, fans: Fans, shapes: Shapes) -> Floats:
    """Return the cosine of each ray's angle of incidence, (f, rays): 1 is perpendicular; 0 where nothing was met."""
    s = shapes.segments
    segments = len(s.start)
    beyond = np.zeros(len(shapes.circle_rough) + 1)  # circles, and -1 for nothing
    along_x = np.concatenate((s.edge_x_m / s.length_m, beyond))[hits.thing]
    along_y = np.concatenate((s.edge_y_m / s.length_m, beyond))[hits.thing]
    cosine: Floats = np.abs(hits.direction_y * along_x - hits.direction_x * along_y)
    fan, ray = np.nonzero(hits.thing >= segments)
    if len(fan):
        x, y, radius = shapes.circles[:, hits.thing[fan, ray] - segments]
        cx, cy = x - fans.x_m[fan], y - fans.y_m[fan]
        off_axis = (hits.direction_x[fan, ray] * cy - hits.direction_y[fan, ray] * cx) / radius
        cosine[fan, ray] = np.sqrt(np.maximum(1.0 - off_axis * off_axis, 0.0))
    return cosine


def _bearing(dy: Floats, dx: Floats, first_rad: Floats, span_rad: float) -> Floats:
    """Return directions counted from the first ray, in (span - 2 pi, span]."""
    bearing = np.arctan2(dy, dx)
    bearing -= first_rad
    bearing -= TURN * np.ceil((bearing - span_rad) / TURN)
    return bearing


def _pairs(low: Floats, high: Floats, possible: Bools, step_rad: float, rays: int) -> tuple[Ints, Ints, Ints]:
    """Return (fan, thing, ray) for every ray inside the interval of bearings [low, high] of a thing, (f, k) each."""
    lowest = np.ceil(np.maximum(low, 0.0) / step_rad - SEAM)
    highest = np.floor(np.minimum(high / step_rad, rays - 1.0) + SEAM)
    count = highest - lowest + 1.0
    fan, thing = np.nonzero((count > 0.0) & possible)
    number = count[fan, thing].astype(np.intp)
    before: npt.NDArray[np.intp] = np.cumsum(number) - number
    shift = lowest[fan, thing].astype(np.intp) - before
    ray = np.arange(int(number.sum()), dtype=np.intp) + np.repeat(shift, number)
    return np.repeat(fan, number), np.repeat(thing, number), ray
