"""What echoes prove of a wall, and what speaks against it."""

import numpy as np

from knowledge_sources.echoes import Array, Echoes, Mask, expected_ranges, on_wall
from knowledge_sources.line_fit import Fit

UNHEARD = 9.0  # squared deviations that an echo counts which a wall cannot explain: three sigmas


def proved_part(echoes: Echoes, fit: Fit, slack: float) -> tuple[float, float]:
    """Return from where to where along its line a wall must reach to have sent these echoes. At least one echo.

    A cone that hears the foot of the perpendicular hears nearly the same from a wall that ends some way short of it,
    so the outermost points prove no wall. Each end is drawn in as far as the echoes' squared deviations, in spreads,
    rise by no more than `slack` above the least. Echoes of a corner draw in to a point.
    """
    along, _ = on_wall(echoes, fit.alpha_rad)
    places = np.sort(along)[:, None]  # (candidates, 1)
    starts = np.flatnonzero(_explains(echoes, fit, places, places[-1:], slack))
    start = places[starts[-1]]
    places = places[starts[-1] :]
    ends = np.flatnonzero(_explains(echoes, fit, start[None, :], places, slack))
    return float(start[0]), float(places[ends[0], 0])


def _explains(echoes: Echoes, fit: Fit, start_m: Array, end_m: Array, slack: float) -> Mask:
    """Say which of the candidates (k, 1) explain the echoes nearly as well as the best does."""
    expected = expected_ranges(echoes, fit.alpha_rad, fit.rho_m, start_m, end_m)
    cost = np.minimum(((echoes.range_m - expected) / fit.spread_m) ** 2, UNHEARD).sum(axis=1)
    explains: Mask = cost <= cost.min() + slack
    return explains


def contradictions(
    echoes: Echoes, fit: Fit, start_m: float, end_m: float, margin_m: float, incidence_share: float
) -> Mask:
    """Say which echoes came from more than `margin_m` beyond a wall that would have answered them first."""
    start, end = np.array([start_m]), np.array([end_m])
    nearer = expected_ranges(echoes, fit.alpha_rad, fit.rho_m, start, end, incidence_share)
    beyond: Mask = echoes.range_m > nearer + margin_m
    return beyond
