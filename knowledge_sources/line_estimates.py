"""Lines with their uncertainties: the form in which they are matched and merged.

Source: Bou-Ghannam 1992, section 5.2.4.1. Its sigma_theta = atan(sigma_rho / L), sigma_rho being the largest distance of a point,
is no deviation: it bounds the tilt of any line through the points, so that a short line matches whatever is near, and a long one
of a drifting robot is less sure than it says. Here the largest distance stands for `LARGEST_IN_SIGMAS` deviations of a point,
least squares give those of the line, and below them lies a floor for what a batch's points have in common: drift while it was
gathered, and the sensor's bias.
"""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, radians, sin, sqrt

import numpy as np

from blackboard.messages.geometry import Point, wrap_angle
from blackboard.messages.model import ModelLine
from blackboard.messages.world import Line
from blackboard.uncertainty.matrices import Array

LARGEST_IN_SIGMAS = 2.5  # the largest of some 50 normal deviations
POINTS_A_PLACE = 3.0  # points of a line whose errors are alike: the same wall heard again from next to nowhere else


@dataclass(frozen=True, slots=True, kw_only=True)
class NoiseFloor:
    """What even a line of very many points is wrong by."""

    theta_rad: float = radians(0.7)
    rho_m: float = 0.02


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LineEstimate:
    """A line by its middle, direction and half length; `covariance` (2, 2) is of theta and of the offset at the middle.

    The normal points to the right of the direction; `faces_left`: it was sensed from the left.
    """

    theta_rad: float
    x_m: float
    y_m: float
    half_length_m: float
    covariance: Array
    faces_left: bool

    @property
    def direction(self) -> tuple[float, float]:
        return cos(self.theta_rad), sin(self.theta_rad)

    @property
    def normal(self) -> tuple[float, float]:
        return sin(self.theta_rad), -cos(self.theta_rad)

    @property
    def rho_m(self) -> float:
        return self.x_m * sin(self.theta_rad) - self.y_m * cos(self.theta_rad)

    @property
    def d_m(self) -> float:
        return self.x_m * cos(self.theta_rad) + self.y_m * sin(self.theta_rad)

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        c, s = self.direction
        reach = self.half_length_m
        return (self.x_m - reach * c, self.y_m - reach * s), (self.x_m + reach * c, self.y_m + reach * s)

    def flipped(self) -> "LineEstimate":
        """Return the same line with the other direction: theta a half turn on, rho and d negated."""
        return LineEstimate(
            theta_rad=wrap_angle(self.theta_rad + pi),
            x_m=self.x_m,
            y_m=self.y_m,
            half_length_m=self.half_length_m,
            covariance=self.covariance * np.array([[1.0, -1.0], [-1.0, 1.0]]),
            faces_left=not self.faces_left,
        )

    def along(self, other: "LineEstimate") -> "LineEstimate":
        """Return this line or its flipped form, whichever runs the way of `other` (undirected lines, compared modulo pi)."""
        return self if cos(self.theta_rad - other.theta_rad) >= 0.0 else self.flipped()

    def covariance_at(self, t_m: float) -> Array:
        """Return the covariance of theta and of the offset at the place `t_m` from the middle along the line."""
        shift = np.array([[1.0, 0.0], [-t_m, 1.0]])  # a line that turns left leaves to the left: against its normal
        moved: Array = shift @ self.covariance @ shift.T
        return moved

    def turned(self, x_m: float, y_m: float, shift_x_m: float, shift_y_m: float, turn_rad: float) -> "LineEstimate":
        """Return the line turned about (x, y) and then shifted."""
        c, s = cos(turn_rad), sin(turn_rad)
        dx, dy = self.x_m - x_m, self.y_m - y_m
        return LineEstimate(
            theta_rad=wrap_angle(self.theta_rad + turn_rad),
            x_m=x_m + c * dx - s * dy + shift_x_m,
            y_m=y_m + s * dx + c * dy + shift_y_m,
            half_length_m=self.half_length_m,
            covariance=self.covariance,
            faces_left=self.faces_left,
        )


def from_ends(
    start: tuple[float, float], end: tuple[float, float], covariance: Array, faces_left: bool
) -> LineEstimate:
    """Return the line between two points."""
    return LineEstimate(
        theta_rad=atan2(end[1] - start[1], end[0] - start[0]),
        x_m=(start[0] + end[0]) / 2,
        y_m=(start[1] + end[1]) / 2,
        half_length_m=hypot(end[0] - start[0], end[1] - start[1]) / 2,
        covariance=covariance,
        faces_left=faces_left,
    )


def line_covariance(half_length_m: float, largest_m: float, support: int, floor: NoiseFloor) -> Array:
    """Return the covariance (2, 2) of theta and of the offset at the middle, of a line fitted to points spread along it."""
    spread = largest_m / LARGEST_IN_SIGMAS
    places = max(support / POINTS_A_PLACE, 1.0)
    theta = sqrt(3.0) * spread / (max(half_length_m, 1e-3) * sqrt(places))
    variances = (theta**2 + floor.theta_rad**2, spread**2 / places + floor.rho_m**2)
    return np.diag(variances)


def from_line(line: Line, sensed_from: Array, floor: NoiseFloor) -> LineEstimate:
    """Return an observed line as an estimate; `sensed_from` (n, 2) is where its points were sensed from."""
    start, end = (line.start.x_m, line.start.y_m), (line.end.x_m, line.end.y_m)
    half = hypot(end[0] - start[0], end[1] - start[1]) / 2
    covariance = line_covariance(half, line.sigma_rho_m, line.support, floor)
    found = from_ends(start, end, covariance, True)
    right = found.normal
    sides = (sensed_from[:, 0] - found.x_m) * right[0] + (sensed_from[:, 1] - found.y_m) * right[1]
    return from_ends(start, end, covariance, bool(np.sum(sides) <= 0.0))


def as_model_line(
    line: LineEstimate, inherited_theta_rad: float, inherited_rho_m: float, observations: int
) -> ModelLine:
    """Return the message; the inherited variances come on top of the line's own."""
    own = line.covariance
    start, end = line.ends
    return ModelLine(
        theta_rad=line.theta_rad,
        rho_m=line.rho_m,
        d_m=line.d_m,
        half_length_m=line.half_length_m,
        sigma_theta_rad=sqrt(float(own[0, 0]) + inherited_theta_rad**2),
        sigma_rho_m=sqrt(float(own[1, 1]) + inherited_rho_m**2),
        covariance_theta_rho_m_rad=float(own[0, 1]),
        inherited_sigma_theta_rad=inherited_theta_rad,
        inherited_sigma_rho_m=inherited_rho_m,
        faces_left=line.faces_left,
        start=Point(x_m=start[0], y_m=start[1]),
        end=Point(x_m=end[0], y_m=end[1]),
        observations=observations,
    )


def from_model_line(line: ModelLine) -> LineEstimate:
    """Return a model line as an estimate with the variances of its own."""
    cross = line.covariance_theta_rho_m_rad
    own = np.array(
        [
            [line.sigma_theta_rad**2 - line.inherited_sigma_theta_rad**2, cross],
            [cross, line.sigma_rho_m**2 - line.inherited_sigma_rho_m**2],
        ]
    )
    c, s = cos(line.theta_rad), sin(line.theta_rad)
    return LineEstimate(
        theta_rad=line.theta_rad,
        x_m=line.rho_m * s + line.d_m * c,
        y_m=-line.rho_m * c + line.d_m * s,
        half_length_m=line.half_length_m,
        covariance=own,
        faces_left=line.faces_left,
    )
