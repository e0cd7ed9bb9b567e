"""Do an observed and a model line stand for the same wall? And what both together say of it.

Source: Bou-Ghannam 1992, section 5.2.4.1: orientation, collinearity and overlap by normal distance, then the Kalman equations. Its
rho is taken about the origin, where a far line's tilt makes it meaningless; here the origin of the comparison is the
observed line's middle, so that its rho and d are 0 and the tilts count by their levers. The same holds for merging.
A merged line covers both; the thesis's merged L would shrink.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from blackboard.messages.geometry import wrap_angle
from blackboard.parameters import require
from blackboard.uncertainty.kalman import VectorEstimate, merge_vectors
from blackboard.uncertainty.matrices import Array
from blackboard.uncertainty.normal_distance import parameter_distance, parameter_matches
from knowledge_sources.line_estimates import LineEstimate, NoiseFloor


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchLimits:
    """How far apart two forms of one line may be."""

    k: float = 2.0  # deviations: the thesis's 95 %
    gap_m: float = 1.0  # a doorway: collinear walls further apart than this stay two lines, whatever their lengths

    def __post_init__(self) -> None:
        require(0.0 < self.k <= 10.0, "k", self.k, "(0, 10]")
        require(0.0 <= self.gap_m <= 100.0, "gap_m", self.gap_m, "[0, 100] metres")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Difference:
    """A model line, run the way of the observed one, less the latter, at the latter's middle."""

    model: LineEstimate
    turn_rad: float
    offset_m: float
    along_m: float
    covariance: Array  # (2, 2) of turn and offset
    distance: float  # squared normal distance of turn and offset


def difference(observed: LineEstimate, model: LineEstimate, extra: Array) -> Difference:
    """Return how the model line differs; `extra` (2, 2) adds to the covariance of turn and offset (a pose's error)."""
    own = model.along(observed)
    normal, direction = own.normal, own.direction
    x, y = own.x_m - observed.x_m, own.y_m - observed.y_m
    along = x * direction[0] + y * direction[1]
    turn, offset = wrap_angle(own.theta_rad - observed.theta_rad), x * normal[0] + y * normal[1]
    covariance = observed.covariance + own.covariance_at(-along) + extra
    distance = parameter_distance(turn, sqrt(covariance[0, 0]), 0.0)
    distance += parameter_distance(offset, sqrt(covariance[1, 1]), 0.0)
    return Difference(
        model=own, turn_rad=turn, offset_m=offset, along_m=along, covariance=covariance, distance=distance
    )


def matches(observed: LineEstimate, found: Difference, limits: MatchLimits) -> bool:
    """Say whether both are the same wall, seen from the same side: orientation, collinearity, overlap."""
    model, covariance = found.model, found.covariance
    lengths = observed.half_length_m, model.half_length_m
    return (
        model.faces_left == observed.faces_left
        and parameter_matches(found.turn_rad, sqrt(covariance[0, 0]), 0.0, limits.k)
        and parameter_matches(found.offset_m, sqrt(covariance[1, 1]), 0.0, limits.k)
        and parameter_matches(found.along_m, *lengths, limits.k)
        and abs(found.along_m) <= sum(lengths) + limits.gap_m
    )


def merge_lines(model: LineEstimate, observed: LineEstimate, floor: NoiseFloor) -> LineEstimate:
    """Return the line that both are, as long as both together, in the model line's direction.

    Merged at the model's middle; the variances never grow there, nor fall below the `floor`'s unless they were lower.
    """
    own = observed.along(model)
    normal, direction = own.normal, own.direction
    x, y = own.x_m - model.x_m, own.y_m - model.y_m
    t = x * direction[0] + y * direction[1]
    turn = wrap_angle(own.theta_rad - model.theta_rad)
    seen = VectorEstimate(
        mean=np.array([turn, x * normal[0] + y * normal[1]]), covariance=_symmetric(own.covariance_at(-t))
    )
    both = merge_vectors(VectorEstimate(mean=np.zeros(2), covariance=model.covariance), seen)
    before = np.sqrt(np.diag(model.covariance))
    after = np.sqrt(np.diag(both.covariance))
    least = np.minimum(before, np.array([floor.theta_rad, floor.rho_m]))
    stretch = np.maximum(least / after, 1.0)
    covariance = both.covariance * np.outer(stretch, stretch)
    theta = wrap_angle(model.theta_rad + float(both.mean[0]))
    moved = LineEstimate(
        theta_rad=theta,
        x_m=model.x_m + float(both.mean[1]) * model.normal[0],
        y_m=model.y_m + float(both.mean[1]) * model.normal[1],
        half_length_m=model.half_length_m,
        covariance=covariance,
        faces_left=model.faces_left,
    )
    return _covering(moved, model, own)


def _covering(line: LineEstimate, *others: LineEstimate) -> LineEstimate:
    """Return the line with its middle and length such that it covers these."""
    c, s = line.direction
    places = [(x - line.x_m) * c + (y - line.y_m) * s for other in others for x, y in other.ends]
    low, high = min(places), max(places)
    middle = (low + high) / 2
    return LineEstimate(
        theta_rad=line.theta_rad,
        x_m=line.x_m + middle * c,
        y_m=line.y_m + middle * s,
        half_length_m=(high - low) / 2,
        covariance=_symmetric(line.covariance_at(middle)),
        faces_left=line.faces_left,
    )


def _symmetric(covariance: Array) -> Array:
    return (covariance + covariance.T) / 2
