"""Where a round thing stands and how large it is, from the directions and widths in which it was seen from several places.

One sighting tells the direction, and the distance only to one who knows the size. From several places both follow: what has
another size than the one looked for does not shrink as it should. Least squares over the middle and the radius of the thing,
with the radius looked for as a weak prior, and large misfits of the width weighed down (Huber 1964): something may hide a part.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, hypot, sin
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import wrap_angle

Floats = npt.NDArray[np.float64]

STEPS = 8  # of Gauss-Newton; it converges in four or five
PRIOR_FRACTION = 0.3  # standard deviation of the radius before anything is seen, of that looked for
HUBER_SIGMAS = 1.5
NEAREST_FRACTION = 0.98  # of the distance: a camera is never inside what it sees


class Sighting(NamedTuple):
    """From where, in which direction (map frame) and how wide something was seen."""

    x_m: float
    y_m: float
    bearing_rad: float
    width_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SightingErrors:
    """Standard deviations of a sighting."""

    edge_rad: float
    heading_rad: float
    pose_m: float

    def bearing_rad(self, away_m: float) -> float:
        return hypot(self.heading_rad, self.edge_rad / 2**0.5, self.pose_m / away_m)

    def width_rad(self, away_m: float, width_rad: float) -> float:
        return hypot(2**0.5 * self.edge_rad, width_rad * self.pose_m / away_m)


class Estimate(NamedTuple):
    """A round thing's middle and radius, m, and their covariance (3, 3)."""

    x_m: float
    y_m: float
    radius_m: float
    covariance: Floats

    @property
    def sigma_m(self) -> float:
        """Standard deviation of its place in the direction in which it is known least."""
        return float(np.sqrt(max(np.linalg.eigvalsh(self.covariance[:2, :2])[-1], 0.0)))

    @property
    def sigma_radius_m(self) -> float:
        return float(np.sqrt(max(self.covariance[2, 2], 0.0)))

    def expected(self, sighting: Sighting, errors: SightingErrors) -> "Expected":
        """Return what should be seen from where a sighting was made."""
        state = np.array([self.x_m, self.y_m, self.radius_m])
        residuals, slopes, sigmas = _misfit(np.array([sighting], dtype=np.float64), state, errors)
        return Expected(
            away_m=hypot(self.x_m - sighting.x_m, self.y_m - sighting.y_m),
            width_rad=sighting.width_rad - float(residuals[1]),
            residuals_rad=residuals,
            covariance=(slopes @ self.covariance @ slopes.T + np.diag(sigmas**2)).astype(np.float64),
        )


class Expected(NamedTuple):
    """How a sighting differs from what should be seen: in direction and width, with the covariance of the two."""

    away_m: float
    width_rad: float
    residuals_rad: Floats  # (2,)
    covariance: Floats  # (2, 2)

    @property
    def distance(self) -> float:
        """Squared distance of the sighting from what was expected, in standard deviations (Mahalanobis)."""
        return float(self.residuals_rad @ np.linalg.solve(self.covariance, self.residuals_rad))

    @property
    def width_sigma_rad(self) -> float:
        return float(np.sqrt(self.covariance[1, 1]))

    @property
    def edge_sigma_rad(self) -> float:
        """Standard deviation of where either end of it should be seen."""
        return float(np.sqrt(self.covariance[0, 0] + self.covariance[1, 1] / 4.0))


def placed(sighting: Sighting, radius_m: float) -> tuple[float, float]:
    """Return where a thing of this radius stands that looks so wide."""
    away = radius_m / max(sin(min(sighting.width_rad, 3.0) / 2.0), 1e-6)
    return (sighting.x_m + away * cos(sighting.bearing_rad), sighting.y_m + away * sin(sighting.bearing_rad))


def estimate(sightings: Sequence[Sighting], radius_m: float, errors: SightingErrors) -> Estimate:
    """Return the round thing that explains at least one sighting best, looking for one of this radius."""
    table = np.array(sightings, dtype=np.float64)  # (n, 4)
    state = np.array([*placed(sightings[-1], radius_m), radius_m])
    information = np.eye(3)
    prior = 1.0 / (PRIOR_FRACTION * radius_m) ** 2
    for _ in range(STEPS):
        residuals, slopes, sigmas = _misfit(table, state, errors)
        weights = 1.0 / sigmas**2
        widths = np.abs(residuals[len(table) :] / sigmas[len(table) :])
        weights[len(table) :] *= np.where(widths > HUBER_SIGMAS, HUBER_SIGMAS / np.maximum(widths, 1e-12), 1.0)
        information = slopes.T @ (weights[:, None] * slopes)
        information[2, 2] += prior
        pull = slopes.T @ (weights * residuals)
        pull[2] += prior * (radius_m - state[2])
        step = np.linalg.solve(information, pull)
        step *= min(1.0, 1.0 / max(float(np.hypot(step[0], step[1])), 1e-12))  # at most a metre at a time
        state = state + step
        state[2] = min(max(state[2], 0.05 * radius_m), 5.0 * radius_m)
    covariance = np.linalg.inv(information).astype(np.float64)
    covariance[[0, 1], [0, 1]] += errors.pose_m**2  # all sightings share the error of where the robot is
    return Estimate(float(state[0]), float(state[1]), float(state[2]), covariance)


def _misfit(table: Floats, state: Floats, errors: SightingErrors) -> tuple[Floats, Floats, Floats]:
    """Return residuals (2n,) of bearings and widths, their slopes (2n, 3), and standard deviations (2n,)."""
    dx, dy = state[0] - table[:, 0], state[1] - table[:, 1]
    away = np.maximum(np.hypot(dx, dy), 1e-3)
    ratio = np.minimum(state[2] / away, NEAREST_FRACTION)
    root = np.sqrt(1.0 - ratio * ratio)
    turns = np.array([wrap_angle(float(a)) for a in table[:, 2] - np.arctan2(dy, dx)])
    residuals = np.concatenate((turns, table[:, 3] - 2.0 * np.arcsin(ratio)))
    nearer = -2.0 * ratio / (away * root)  # of the width, for each metre of distance
    bearing = np.stack([-dy / away**2, dx / away**2, np.zeros(len(table))], axis=1)
    width = np.stack([nearer * dx / away, nearer * dy / away, 2.0 / (away * root)], axis=1)
    sigmas = [errors.bearing_rad(float(a)) for a in away]
    sigmas += [errors.width_rad(float(a), float(w)) for a, w in zip(away, table[:, 3], strict=True)]
    return residuals, np.concatenate((bearing, width)), np.array(sigmas)
