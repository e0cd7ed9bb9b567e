"""A line through echoes that a wall may have sent: the refit, and where two lines fit better than one.

Not in the thesis, whose lines end with step 8. Least squares on the points where the wall met the echoes, with Cauchy
weights.
"""

from dataclasses import dataclass
from math import atan, cos, pi, sin, sqrt

import numpy as np

from knowledge_sources.echoes import Array, Echoes, Index, on_wall

SPREAD_FLOOR_M = 0.004  # finer than any sonar and most lasers: keeps weights finite on perfect data


@dataclass(frozen=True, slots=True)
class Fit:
    """A line with its normal `alpha_rad` away from the sensors, its signed distance from the map's origin, and how sure it is."""

    alpha_rad: float
    rho_m: float
    spread_m: float  # standard deviation of the points about it
    tilt_rad: float  # standard deviation of alpha


def refit(echoes: Echoes, alpha_rad: float, rho_m: float, rounds: int) -> tuple[Fit, Array, Array]:
    """Return the line of least squares through the echoes' points on it, beginning with a line nearby. At least one
    echo.

    Each round is a Gauss-Newton step: the points move to where the turned wall would have met the echoes. Cauchy
    weights with a spread taken from the median hold outliers off.
    """
    tilt = pi
    for _ in range(rounds):
        along, out = on_wall(echoes, alpha_rad)
        deviation = np.abs(out - rho_m)
        spread = max(1.4826 * float(np.sort(deviation)[len(deviation) // 2]), SPREAD_FLOOR_M)
        weight = 1.0 / (1.0 + (deviation / (2.0 * spread)) ** 2)
        total = float(weight.sum())
        centre, mean = float(weight @ along) / total, float(weight @ out) / total
        lever = along - centre
        moment = float(weight @ (lever * lever))
        if moment < 1e-6:  # the points are one point: nothing says how the line lies
            return Fit(alpha_rad, mean, spread, pi), along, out
        turn = -atan(float(weight @ (lever * (out - mean))) / moment)
        # The line turns about the points' mean, which lies elsewhere along the turned normal.
        alpha_rad, rho_m = alpha_rad + turn, mean * cos(turn) + centre * sin(turn)
        tilt = spread / sqrt(moment)
    along, out = on_wall(echoes, alpha_rad)
    deviation = out - rho_m
    spread = max(sqrt(float(deviation @ deviation) / len(deviation)), SPREAD_FLOOR_M)
    return Fit(alpha_rad, rho_m, spread, tilt), along, out


def refit_all(
    line: Index, beyond_m: Array, along_m: Array, alpha_rad: Array, rho_m: Array, width_m: float
) -> tuple[Array, Array]:
    """Return k lines after one Gauss-Newton step each, from pairs (n,) of a line and where an echo met its wall.

    Cauchy weights of half this width; none for what lies further off than the width.
    """
    k = len(alpha_rad)
    weight = np.where(np.abs(beyond_m) <= width_m, 1.0 / (1.0 + (beyond_m / (width_m / 2.0)) ** 2), 0.0)
    total = np.maximum(np.bincount(line, weight, k), 1e-9)
    centre, mean = np.bincount(line, weight * along_m, k) / total, np.bincount(line, weight * beyond_m, k) / total
    lever = along_m - centre[line]
    moment = np.maximum(np.bincount(line, weight * lever * lever, k), 1e-6)
    turn = -np.arctan(np.bincount(line, weight * lever * (beyond_m - mean[line]), k) / moment)
    # As in `refit`: the line turns about its points' mean.
    return alpha_rad + turn, (rho_m + mean) * np.cos(turn) + centre * np.sin(turn)


def bend(along_m: Array, out_m: Array, smallest: int) -> tuple[int, float]:
    """Return where points, in their order along a line, fall best into two lines, and how much better two lines fit
    them.

    The former is how many points belong to the first line; the latter is the F statistic of the second line's three
    parameters (its two and the place of the break), 0 where a side would have fewer than `smallest` points.
    """
    n = len(along_m)
    if n < max(2 * smallest, 6):
        return 0, 0.0
    x, y = along_m - along_m.mean(), out_m - out_m.mean()
    sums = np.cumsum(np.stack([np.ones(n), x, y, x * x, x * y, y * y]), axis=1)  # (6, n)
    last = np.arange(smallest - 1, n - smallest)  # of the first line
    two = _squares(sums[:, last]) + _squares(sums[:, -1:] - sums[:, last])
    best = int(np.argmin(two))
    floor = n * SPREAD_FLOOR_M**2
    one, least = float(_squares(sums[:, -1:])[0]) + floor, float(two[best]) + floor
    return int(last[best]) + 1, (one - least) / 3.0 / (least / (n - 5))


def _squares(sums: Array) -> Array:
    """Return the squared deviations from lines of least squares, from sums of 1, x, y, xx, xy, yy over their points: (6, k)."""
    n, x, y, xx, xy, yy = sums
    sxx, sxy, syy = xx - x * x / n, xy - x * y / n, yy - y * y / n
    squares: Array = np.maximum(syy - sxy * sxy / np.maximum(sxx, 1e-9), 0.0)
    return squares
