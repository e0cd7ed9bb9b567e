"""A ring of sonars: cones in which the nearest echo that comes back is heard.

A smooth wall throws sound away beyond a critical angle of incidence and is heard only nearer to the perpendicular, a rough one
at wider angles; edges, right-angled corners and round things send some of it back from everywhere (Leonard and
Durrant-Whyte 1992, chapter 2). What throws sound away still hides what is behind it.
"""

from dataclasses import dataclass
from math import ceil, cos

import numpy as np

from sim.raycast import Fans, Hits, cast, incidence_cosines
from sim.sensor_models import SonarModel
from sim.shapes import Bools, Floats, Ints, Shapes

EDGE_RAD = 1e-9  # a point on the cone's edge is in the cone
VISIBLE_SLACK_M = 0.01  # how far behind its neighbouring rays' hits a corner may lie and still be seen
SHORTEST_CROSS_TALK_FRACTION = (
    0.3  # another's sound, fired earlier, is taken for an echo at 0.3 to 1 of the range it came from
)


@dataclass(frozen=True, slots=True, eq=False)
class Echoes:
    """What one firing of the ring gave, (f,): inf where nothing was heard."""

    ranges_m: Floats
    lost: Bools  # something was there and was not heard
    cross_talk: Bools


def sonar_fans(model: SonarModel) -> Fans:
    """Return the cones as fans of rays in the robot's frame; the outermost rays are the cone's edges."""
    places = model.places()
    steps = max(2, 2 * ceil(model.cone_rad / model.ray_step_rad / 2.0))  # even: one ray is the axis
    return Fans(
        x_m=np.array([p.x_m for p in places]),
        y_m=np.array([p.y_m for p in places]),
        first_rad=np.array([p.heading_rad for p in places]) - model.cone_rad / 2.0,
        step_rad=model.cone_rad / steps,
        rays=steps + 1,
    )


def true_echoes(fans: Fans, shapes: Shapes, model: SonarModel) -> tuple[Floats, Floats]:
    """Return for each cone the range of the nearest echo, and that of the nearest thing, heard or not; inf where none."""
    hits = cast(fans, shapes)
    rough = np.concatenate(
        (shapes.segments.rough, shapes.circle_rough, [False])
    )  # the last stands for nothing, index -1
    least = np.where(rough, cos(model.rough_incidence_rad), cos(model.critical_incidence_rad))
    heard = incidence_cosines(hits, fans, shapes) >= least[hits.thing]
    echo: Floats = np.where(heard, hits.ranges_m, np.inf).min(axis=1)
    _hear_points(echo, hits, fans, *_corners_in_cones(hits, fans, shapes))
    _hear_points(echo, hits, fans, *_circles_in_cones(hits, fans, shapes))
    return echo, np.minimum(hits.ranges_m.min(axis=1), echo)


def fire(echo: Floats, nearest: Floats, model: SonarModel, rng: np.random.Generator) -> Echoes:
    """Return what is heard of true echoes: some are missed, all are noisy, and some are another sonar's."""
    count = len(echo)
    noise = rng.standard_normal(count)
    missed, crossed, share = rng.random((3, count))
    other = (np.arange(count) + rng.integers(1, max(count, 2), count)) % count
    heard = np.where(missed < model.missed_fraction, np.inf, echo)
    lost = (nearest <= model.max_range_m) & (heard > model.max_range_m)
    there = np.isfinite(heard)
    heard[there] += noise[there] * (model.noise_m + model.noise_fraction * heard[there])
    early = echo[other] * (SHORTEST_CROSS_TALK_FRACTION + (1.0 - SHORTEST_CROSS_TALK_FRACTION) * share)
    cross_talk = (crossed < model.cross_talk_fraction) & (early < heard) & (early <= model.max_range_m) & (count > 1)
    heard = np.where(cross_talk, early, heard)
    heard[heard > model.max_range_m] = np.inf
    return Echoes(ranges_m=np.maximum(heard, 0.0), lost=lost, cross_talk=cross_talk)


def _corners_in_cones(hits: Hits, fans: Fans, shapes: Shapes) -> tuple[Ints, Floats, Floats]:
    """Return (cone, bearing, distance) of every corner that echoes and lies in a cone."""
    bearing, s = hits.corner_bearing_rad, shapes.segments
    cone, corner = np.nonzero((bearing >= -EDGE_RAD) & (bearing <= fans.span_rad) & s.corner_echoes)
    away_x, away_y = s.corner_x_m[corner] - fans.x_m[cone], s.corner_y_m[corner] - fans.y_m[cone]
    return cone, bearing[cone, corner], np.sqrt(away_x * away_x + away_y * away_y)


def _circles_in_cones(hits: Hits, fans: Fans, shapes: Shapes) -> tuple[Ints, Floats, Floats]:
    """Return (cone, bearing, distance) of the nearest point of every circle whose centre lies in a cone."""
    bearing = hits.circle_bearing_rad
    cone, circle = np.nonzero((bearing >= -EDGE_RAD) & (bearing <= fans.span_rad))
    return cone, bearing[cone, circle], hits.circle_distance_m[cone, circle] - shapes.circles[2, circle]


def _hear_points(echo: Floats, hits: Hits, fans: Fans, cone: Ints, bearing_rad: Floats, distance_m: Floats) -> None:
    """Lower `echo` to those points that are not hidden: the rays to their left and right say."""
    if not len(cone):
        return
    step = np.clip(bearing_rad / fans.step_rad, 0.0, fans.rays - 1.0)
    left, right = (
        hits.ranges_m[cone, np.ceil(step).astype(np.intp)],
        hits.ranges_m[cone, np.floor(step).astype(np.intp)],
    )
    slack = VISIBLE_SLACK_M + distance_m * fans.step_rad / 2.0  # a wall at 45 degrees that ends in the point
    seen = distance_m <= np.maximum(left, right) + slack
    np.minimum.at(echo, cone[seen], np.maximum(distance_m[seen], 0.0))
