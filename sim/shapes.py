"""What rays and bodies meet: the boundary of solid things as segments, and round things, in arrays.

Segments run with the solid on their left, so that only those seen from their right can be hit.
"""

from dataclasses import dataclass, field
from math import hypot, pi, radians

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.intp]
Bools = npt.NDArray[np.bool_]

EDGE_TURN_RAD = radians(20.0)  # a solid's corner sharper than this scatters sound
CORNER_SLACK_RAD = radians(25.0)  # a room's corner within this of a right angle throws sound back where it came from
NEIGHBOURHOOD_MARGIN_M = 1.0  # how far the robot goes before what is near is looked up anew


@dataclass(frozen=True, slots=True, eq=False)
class Segments:
    """n corners and s segments between them; metres, map frame. `rough` gives an echo at any angle of incidence."""

    corner_x_m: Floats  # (n,)
    corner_y_m: Floats
    corner_echoes: Bools  # (n,) edges and corners that sound comes back from
    start: Ints  # (s,) index of the corner where a segment starts
    end: Ints
    rough: Bools  # (s,)
    start_x_m: Floats = field(init=False)  # (s,) what follows is derived, to be at hand
    start_y_m: Floats = field(init=False)
    edge_x_m: Floats = field(init=False)  # from start to end
    edge_y_m: Floats = field(init=False)
    length_m: Floats = field(init=False)

    def __post_init__(self) -> None:
        x, y = self.corner_x_m[self.start], self.corner_y_m[self.start]
        edge_x, edge_y = self.corner_x_m[self.end] - x, self.corner_y_m[self.end] - y
        derived = {"start_x_m": x, "start_y_m": y, "edge_x_m": edge_x, "edge_y_m": edge_y}
        for name, values in {**derived, "length_m": np.hypot(edge_x, edge_y)}.items():
            object.__setattr__(self, name, values)

    def only(self, chosen: Bools) -> "Segments":
        """Return the chosen segments, (s,), and their corners."""
        start, end = self.start[chosen], self.end[chosen]
        used = np.unique(np.concatenate((start, end)))
        return Segments(
            corner_x_m=self.corner_x_m[used],
            corner_y_m=self.corner_y_m[used],
            corner_echoes=self.corner_echoes[used],
            start=np.searchsorted(used, start),
            end=np.searchsorted(used, end),
            rough=self.rough[chosen],
        )


@dataclass(frozen=True, slots=True, eq=False)
class Shapes:
    """Segments and c circles. A thing's index is that of a segment, or that of a circle plus the number of segments."""

    segments: Segments
    circles: Floats  # (3, c): x, y, radius
    circle_rough: Bools  # (c,)

    def distances_m(self, x_m: float, y_m: float) -> tuple[Floats, Floats, Floats]:
        """Return for each thing, (s + c,), its distance from a place, and the vector (x, y) to its nearest point."""
        s = self.segments
        ax, ay = s.start_x_m - x_m, s.start_y_m - y_m
        along = -(ax * s.edge_x_m + ay * s.edge_y_m) / (s.length_m * s.length_m)
        along = np.minimum(np.maximum(along, 0.0), 1.0)
        to_x, to_y = ax + along * s.edge_x_m, ay + along * s.edge_y_m
        distance = np.sqrt(to_x * to_x + to_y * to_y)
        if not len(self.circle_rough):
            return distance, to_x, to_y
        cx, cy = self.circles[0] - x_m, self.circles[1] - y_m
        centre = np.sqrt(cx * cx + cy * cy)
        surface = centre - self.circles[2]
        share = surface / np.maximum(centre, 1e-12)
        return (
            np.concatenate((distance, surface)),
            np.concatenate((to_x, cx * share)),
            np.concatenate((to_y, cy * share)),
        )

    def within(self, x_m: float, y_m: float, reach_m: float) -> "Shapes":
        """Return only what lies within `reach_m` of a place."""
        near = self.distances_m(x_m, y_m)[0] <= reach_m
        segment, circle = near[: len(self.segments.start)], near[len(self.segments.start) :]
        return Shapes(
            segments=self.segments.only(segment),
            circles=self.circles[:, circle],
            circle_rough=self.circle_rough[circle],
        )

    def with_rough_circles(self, circles: Floats) -> "Shapes":
        """Return these shapes and more circles, (3, k)."""
        return Shapes(
            segments=self.segments,
            circles=np.concatenate((self.circles, circles), axis=1),
            circle_rough=np.concatenate((self.circle_rough, np.ones(circles.shape[1], bool))),
        )


class Neighbourhood:
    """The shapes that can matter within `reach_m` of the robot, looked up anew only when it has moved on."""

    def __init__(self, shapes: Shapes, reach_m: float) -> None:
        self._all = shapes
        self._reach_m = reach_m
        self._near = shapes
        self._centre: tuple[float, float] | None = None

    def at(self, x_m: float, y_m: float) -> Shapes:
        """Return what lies within reach of a place, and perhaps a little more."""
        if self._centre is None or hypot(x_m - self._centre[0], y_m - self._centre[1]) > NEIGHBOURHOOD_MARGIN_M:
            self._centre = (x_m, y_m)
            self._near = self._all.within(x_m, y_m, self._reach_m + NEIGHBOURHOOD_MARGIN_M)
        return self._near


def shapes_around(free: BaseGeometry, rough_things: BaseGeometry, circles: Floats, circle_rough: Bools) -> Shapes:
    """Return the boundary of the free floor as shapes; what lies on the boundary of `rough_things` is rough.

    `circles` is (c, 3): x, y, radius; they are not cut out of `free`.
    """
    rings = []
    for part in shapely.get_parts(free):
        oriented = orient(part)  # free floor on the left; reversed below
        rings += [oriented.exterior, *oriented.interiors]
    points = [np.asarray(ring.coords)[-1:0:-1] for ring in rings]  # (k, 2) each, last point dropped
    corner = np.concatenate(points) if points else np.zeros((0, 2))
    following = _following(np.array([len(p) for p in points], dtype=np.intp))
    middle = (corner + corner[following]) / 2.0
    rough = shapely.distance(shapely.points(middle), rough_things.boundary) < 1e-4
    segments = Segments(
        corner_x_m=corner[:, 0].copy(),
        corner_y_m=corner[:, 1].copy(),
        corner_echoes=_echoing_corners(corner, following),
        start=np.arange(len(corner), dtype=np.intp),
        end=following,
        rough=np.asarray(rough, dtype=bool),
    )
    return Shapes(segments=segments, circles=circles.T.copy(), circle_rough=circle_rough)


def _following(lengths: Ints) -> Ints:
    """Return for each corner the index of the next on its ring."""
    ends = np.cumsum(lengths)
    following = np.arange(1, int(lengths.sum()) + 1, dtype=np.intp)
    if len(ends):
        following[ends - 1] = ends - lengths
    return following


def _echoing_corners(corner: Floats, following: Ints) -> Bools:
    """Return which corners sound comes back from, whatever the angle: a solid's edges and a room's right-angled corners."""
    out = corner[following] - corner
    into = np.empty_like(out)
    into[following] = out
    cross = into[:, 0] * out[:, 1] - into[:, 1] * out[:, 0]
    turn = np.arctan2(cross, np.sum(into * out, axis=1))  # positive: a corner of the solid, which is on the left
    return np.asarray((turn > EDGE_TURN_RAD) | (np.abs(turn + pi / 2) < CORNER_SLACK_RAD))
