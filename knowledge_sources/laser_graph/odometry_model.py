"""Odometry's systematic errors, estimated from a corrected drive, and how unsure what remains is.

A piece of odometry (dx, dy, turn) becomes (s dx, s dy, k turn + b d): s the distance scale, k the turn scale, b the heading that
drifts per metre driven, d the distance (with the sign of the drive). Random errors grow with distance and turn (Thrun,
Burgard, Fox 2005, "Probabilistic Robotics", section 5.4).
"""

from dataclasses import dataclass

import numpy as np

from knowledge_sources.laser_graph.poses import Floats, wrap

FEWEST = 20  # pieces that tell the systematic errors from chance
ROUNDS = 10  # of reweighting: it settles in five
KEEP = 1e-3  # information that holds a term to "no error" where nothing tells it: one part in thirty of one piece


@dataclass(frozen=True, slots=True, kw_only=True)
class OdometryModel:
    """Systematic errors, and one sigma of what is left after them."""

    distance_scale: float = 1.0
    turn_scale: float = 1.0
    drift_rad_per_m: float = 0.0
    # before anything is known: a worn indoor robot drifts by up to 0.1 rad a metre and slips a tenth of its way
    sigma_distance_fraction: float = 0.1
    sigma_drift_rad_per_m: float = 0.05
    sigma_turn_fraction: float = 0.1

    def correct(self, pieces: Floats) -> Floats:
        """Return pieces of odometry (n, 3) without their systematic errors; the arcs between them are taken as chords."""
        corrected = pieces.copy()
        corrected[:, :2] *= self.distance_scale
        corrected[:, 2] = wrap(self.turn_scale * pieces[:, 2] + self.drift_rad_per_m * signed_distance(pieces))
        return corrected

    def sigmas(self, distance_m: Floats, turn_rad: Floats) -> Floats:
        """Return one sigma (n, 3) of x, y, heading after pieces of this distance and absolute turn."""
        heading = 0.005 + self.sigma_drift_rad_per_m * distance_m + self.sigma_turn_fraction * turn_rad
        along = 0.01 + self.sigma_distance_fraction * distance_m + 0.02 * turn_rad
        across = along + 0.5 * heading * distance_m
        return np.stack([along, across, heading], axis=1)


def signed_distance(pieces: Floats) -> Floats:
    """Return the length of each piece (n, 3), negative where it went backwards."""
    length: Floats = np.hypot(pieces[:, 0], pieces[:, 1]) * np.where(pieces[:, 0] < 0.0, -1.0, 1.0)
    return length


def fit_odometry(raw: Floats, corrected: Floats) -> OdometryModel:
    """Return the model that takes raw pieces (n, 3) to the corrected ones, robustly (least squares with Cauchy weights).

    Fewer than 20 pieces give the model of an unknown robot.
    """
    if len(raw) < FEWEST:
        return OdometryModel()
    distance, turn = signed_distance(raw), raw[:, 2]
    scale, left_m = _robust(distance[:, None], signed_distance(corrected) - distance, 0.02)
    columns = np.column_stack([turn, distance])
    terms, left_rad = _robust(columns, wrap(corrected[:, 2] - turn), 0.01)
    length = np.abs(distance)
    moved, turned = length > 0.1, np.abs(turn) > 0.1
    return OdometryModel(
        distance_scale=float(1.0 + scale[0]),
        turn_scale=float(1.0 + terms[0]),
        drift_rad_per_m=float(terms[1]),
        sigma_distance_fraction=_spread(left_m[moved] / length[moved], 0.01, 0.1),
        sigma_drift_rad_per_m=_spread(left_rad[moved & ~turned] / length[moved & ~turned], 0.005, 0.05),
        sigma_turn_fraction=_spread(left_rad[turned] / turn[turned], 0.01, 0.1),
    )


def _robust(columns: Floats, values: Floats, floor: float) -> tuple[Floats, Floats]:
    """Return the terms that explain the values and what they leave."""
    terms: Floats = np.zeros(columns.shape[1])
    left: Floats = values
    for _ in range(ROUNDS):
        width = max(float(np.median(np.abs(left))) * 1.4826, floor)
        weight = 1.0 / (1.0 + (left / (2.0 * width)) ** 2)
        normal = columns.T @ (columns * weight[:, None]) + KEEP * np.eye(columns.shape[1])
        terms = np.asarray(np.linalg.solve(normal, columns.T @ (values * weight)), dtype=np.float64)
        left = values - columns @ terms
    return terms, left


def _spread(values: Floats, least: float, unknown: float) -> float:
    """Return a robust sigma, widened by half: the tails are heavier than a normal's."""
    if len(values) < FEWEST:
        return unknown
    return max(1.5 * 1.4826 * float(np.median(np.abs(values))), least)
