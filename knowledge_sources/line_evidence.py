"""What echoes prove of a wall.

An echo heard in a cone proves that something stands somewhere on an arc, so it places a wall only to within a stretch of its line.
A corner, an edge or a chair's leg explains all echoes whose stretches meet. Two of them always lie on a line: it takes three places
that no single thing explains to prove a wall.
"""

from math import cos, pi, sin

import numpy as np

from knowledge_sources.echoes import Array, Echoes, wrap
from knowledge_sources.line_fit import Fit


def stretches(echoes: Echoes, fit: Fit, tolerance_m: float) -> tuple[Array, Array]:
    """Return from where to where along the line each echo's source may lie, if ranges err by no more than `tolerance_m`.

    An exact beam gives a point. The ends of an echo that the line does not explain are in reverse order.
    """
    cosine, sine = cos(fit.alpha_rad), sin(fit.alpha_rad)
    foot = echoes.y_m * cosine - echoes.x_m * sine
    distance = fit.rho_m - (echoes.x_m * cosine + echoes.y_m * sine)
    axis = wrap(echoes.bearing_rad - fit.alpha_rad)
    upright = pi / 2 - 0.01  # short of where the tangent has no end
    low = distance * np.tan(np.clip(axis - echoes.half_cone_rad, -upright, upright))
    high = distance * np.tan(np.clip(axis + echoes.half_cone_rad, -upright, upright))
    farthest = np.sqrt(np.maximum((echoes.range_m + tolerance_m) ** 2 - distance**2, 0.0))
    nearest = np.sqrt(np.maximum((echoes.range_m - tolerance_m) ** 2 - distance**2, 0.0))
    beam = echoes.half_cone_rad == 0.0
    place = beam & (echoes.range_m == 0.0)  # seen from nobody knows where: it lies at its foot
    low, high = np.where(place, 0.0, low), np.where(place, 0.0, high)
    first = np.where(beam, low, np.maximum(low, np.where(low >= 0.0, nearest, -farthest)))
    last = np.where(beam, high, np.minimum(high, np.where(high <= 0.0, -nearest, farthest)))
    return foot + first, foot + last


def independent_places(first_m: Array, last_m: Array) -> list[tuple[float, float]]:
    """Return the most stretches that do not meet, in order: so many things at least are needed to explain them all.

    Always that stretch is next which ends first (the greedy choice is optimal).
    """
    order = np.lexsort((first_m, last_m))
    places: list[tuple[float, float]] = []
    for first, last in zip(first_m[order].tolist(), last_m[order].tolist(), strict=True):
        if not places or first > places[-1][1]:
            places.append((first, last))
    return places
