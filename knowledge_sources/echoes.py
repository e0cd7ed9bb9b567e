"""Range readings as echoes: where each met a wall that faces a given way.

An echo heard in a cone comes from where the wall is nearest within that cone: from the foot of the perpendicular if
the wall's normal lies in the cone, else from the edge of the cone nearest to it (Tardos, Neira, Newman and Leonard
2002, section III). A laser beam, or a sonar taken on its axis as in Bou-Ghannam 1992, is a cone of no width.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
import numpy.typing as npt

from blackboard.messages.world import PointSet

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Index = npt.NDArray[np.intp]

ROUGH_M, ROUGH_RAD = 0.001, 0.001  # more than single precision errs


@dataclass(frozen=True, slots=True, eq=False)
class Echoes:
    """Readings by columns, all of length n, map frame."""

    x_m: Array  # where the sensor stood
    y_m: Array
    range_m: Array
    bearing_rad: Array  # of the axis
    half_cone_rad: Array
    max_incidence_rad: Array  # how far off its normal a wall may have sent it

    def __len__(self) -> int:
        return len(self.range_m)

    @property
    def reach_rad(self) -> Array:
        """How far off the axis the normal of a wall may be that sent the echo."""
        return self.half_cone_rad + self.max_incidence_rad

    def take(self, index: Index | Mask) -> "Echoes":
        """Return the echoes of these indices, or those where a mask holds."""
        return Echoes(
            self.x_m[index],
            self.y_m[index],
            self.range_m[index],
            self.bearing_rad[index],
            self.half_cone_rad[index],
            self.max_incidence_rad[index],
        )

    def join(self, other: "Echoes") -> "Echoes":
        """Return these echoes and then the others."""
        return Echoes(
            np.concatenate([self.x_m, other.x_m]),
            np.concatenate([self.y_m, other.y_m]),
            np.concatenate([self.range_m, other.range_m]),
            np.concatenate([self.bearing_rad, other.bearing_rad]),
            np.concatenate([self.half_cone_rad, other.half_cone_rad]),
            np.concatenate([self.max_incidence_rad, other.max_incidence_rad]),
        )


def no_echoes() -> Echoes:
    """Return none."""
    none = np.zeros(0)
    return Echoes(none, none, none, none, none, none)


def echoes_of(points: PointSet, max_incidence_rad: float, max_beam_incidence_rad: float) -> Echoes:
    """Return a batch's echoes; the limits are for cones and for beams of no width."""
    return in_order(
        points.sensed_from.unpack().astype(np.float64),
        points.points.unpack().astype(np.float64),
        points.half_cone_rad.unpack().astype(np.float64),
        max_incidence_rad,
        max_beam_incidence_rad,
    )


def points_on_axis(points: PointSet) -> Echoes:
    """Return a batch's echoes with their cones forgotten: points that lines of any direction may pass through."""
    return in_order(
        points.sensed_from.unpack().astype(np.float64),
        points.points.unpack().astype(np.float64),
        np.zeros(points.points.shape[0]),
        pi / 2,
        pi / 2,
    )


def in_order(
    sensed_from: Array, points: Array, half_cone_rad: Array, max_incidence_rad: float, max_beam_incidence_rad: float
) -> Echoes:
    """Return echoes of arrays (n, 2), (n, 2) and (n,) in an order of their own, so that the readings' order does not matter."""
    reach = points - sensed_from
    order = np.lexsort((half_cone_rad, reach[:, 1], reach[:, 0], sensed_from[:, 1], sensed_from[:, 0]))
    reach, sensed_from, half_cone = reach[order], sensed_from[order], half_cone_rad[order]
    return Echoes(
        x_m=sensed_from[:, 0],
        y_m=sensed_from[:, 1],
        range_m=np.hypot(reach[:, 0], reach[:, 1]),
        bearing_rad=np.arctan2(reach[:, 1], reach[:, 0]),
        half_cone_rad=half_cone,
        max_incidence_rad=np.where(half_cone > 0.0, max_incidence_rad, max_beam_incidence_rad),
    )


def wrap(angle_rad: Array) -> Array:
    """Return the same directions in [-pi, pi]."""
    wrapped: Array = angle_rad - 2.0 * pi * np.rint(angle_rad / (2.0 * pi))
    return wrapped


def incidence(echoes: Echoes, alpha_rad: float | Array) -> Array:
    """Return from which direction each echo came if sent by a wall whose normal away from the sensor is `alpha_rad`.

    The angle from the normal to the sound's path, counter-clockwise: 0 where the normal lies in the cone.
    """
    axis = wrap(echoes.bearing_rad - alpha_rad)
    outside: Array = axis - np.clip(axis, -echoes.half_cone_rad, echoes.half_cone_rad)
    return outside


def on_wall(echoes: Echoes, alpha_rad: float) -> tuple[Array, Array]:
    """Return where each echo met a wall of normal `alpha_rad`: how far along the wall, and how far out along its
    normal.

    Both from the map's origin; along the wall is counter-clockwise of the normal.
    """
    cosine, sine = cos(alpha_rad), sin(alpha_rad)
    path = incidence(echoes, alpha_rad)
    along = echoes.y_m * cosine - echoes.x_m * sine + echoes.range_m * np.sin(path)
    out = echoes.x_m * cosine + echoes.y_m * sine + echoes.range_m * np.cos(path)
    return along, out


def near_lines(echoes: Echoes, alpha_rad: Array, rho_m: Array, largest_m: float) -> tuple[Index, Index]:
    """Return which echoes may have come from walls within `largest_m` of which of k lines: pairs (line, echo), by line.

    A wall lies at its line, parallel to it; none answers beyond the echo's largest incidence.
    """
    alpha, single = alpha_rad[:, None].astype(np.float32), np.float32
    # Roughly first, with single precision, since few of the k x n pairs are near; then exactly.
    axis = echoes.bearing_rad.astype(single) - alpha
    axis -= single(2.0 * pi) * np.rint(axis * single(0.5 / pi))
    np.abs(axis, out=axis)
    line, echo = np.nonzero(axis <= (echoes.reach_rad + ROUGH_RAD).astype(single))
    path = np.maximum(axis[line, echo] - echoes.half_cone_rad.astype(single)[echo], single(0.0))
    beyond = (echoes.x_m - echoes.x_m[0]).astype(single)[echo] * np.cos(alpha_rad).astype(single)[line]
    beyond += (echoes.y_m - echoes.y_m[0]).astype(single)[echo] * np.sin(alpha_rad).astype(single)[line]
    beyond += echoes.range_m.astype(single)[echo] * np.cos(path)
    beyond -= (rho_m - echoes.x_m[0] * np.cos(alpha_rad) - echoes.y_m[0] * np.sin(alpha_rad)).astype(single)[line]
    rough = np.abs(beyond) <= single(largest_m + ROUGH_M)
    line, echo = line[rough], echo[rough]
    heard = echoes.take(echo)
    exact = (np.abs(met(heard, alpha_rad[line], rho_m[line])[0]) <= largest_m) & (
        np.abs(wrap(heard.bearing_rad - alpha_rad[line])) <= heard.reach_rad
    )
    return line[exact], echo[exact]


def met(echoes: Echoes, alpha_rad: Array, rho_m: Array) -> tuple[Array, Array]:
    """Return for n echoes and n lines how far beyond its line each met a wall parallel to it, and where along it."""
    path = incidence(echoes, alpha_rad)
    cosine, sine = np.cos(alpha_rad), np.sin(alpha_rad)
    beyond = echoes.x_m * cosine + echoes.y_m * sine + echoes.range_m * np.cos(path) - rho_m
    along = echoes.y_m * cosine - echoes.x_m * sine + echoes.range_m * np.sin(path)
    return beyond, along


def expected_ranges(
    echoes: Echoes, alpha_rad: float, rho_m: float, start_m: Array, end_m: Array, incidence_share: float = 1.0
) -> Array:
    """Return the range at which each echo would have been heard from a wall alone: infinite where it would not.

    The wall is the part from `start_m` to `end_m` (arrays that broadcast against (n,)) of the carrier whose signed
    distance from the map's origin along `alpha_rad` is `rho_m`. It answers up to `incidence_share` of the echoes'
    largest incidence.
    """
    cosine, sine = cos(alpha_rad), sin(alpha_rad)
    foot = echoes.y_m * cosine - echoes.x_m * sine
    distance = rho_m - (echoes.x_m * cosine + echoes.y_m * sine)
    axis = wrap(echoes.bearing_rad - alpha_rad)
    limit = np.minimum(
        echoes.max_incidence_rad * incidence_share, pi / 2 - 0.01
    )  # short of where the tangent has no end
    low, high = np.maximum(axis - echoes.half_cone_rad, -limit), np.minimum(axis + echoes.half_cone_rad, limit)
    from_m = np.maximum(foot + distance * np.tan(low), start_m)
    to_m = np.minimum(foot + distance * np.tan(high), end_m)
    aside = np.clip(foot, from_m, np.maximum(to_m, from_m)) - foot
    heard = (low <= high) & (from_m <= to_m + 1e-9) & (distance > 0.0)
    return np.where(heard, np.hypot(distance, aside), np.inf)
