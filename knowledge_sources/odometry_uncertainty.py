"""How unsure a pose becomes on the way that odometry tells of.

Errors of wheels are systematic (a scale, a drift to one side), so that their deviations grow with the way, not with its root.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import hypot, sqrt

import numpy as np

from blackboard.messages.geometry import Pose, wrap_angle
from blackboard.parameters import require
from blackboard.uncertainty.matrices import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class OdometryNoise:
    """One sigma of what wheels are wrong by."""

    distance_fraction: float = 0.03  # of the way: worn tyres, carpets
    heading_rad_per_m: float = 0.005  # 3 degrees in 10 m: wheels of unequal size
    heading_fraction: float = 0.015  # of the turn that is left when turns to both sides are summed
    heading_noise_rad: float = 0.01  # for each root of a radian turned, whichever way: slip

    def __post_init__(self) -> None:
        for name in ("distance_fraction", "heading_rad_per_m", "heading_fraction", "heading_noise_rad"):
            require(0.0 <= getattr(self, name) <= 1.0, name, getattr(self, name), "[0, 1]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Way:
    """What was driven: its length, the sum of its turns, and that of their sizes."""

    length_m: float
    turn_rad: float
    turned_rad: float


def way_of(poses: Iterable[Pose]) -> Way:
    """Return the way along these poses."""
    length = turn = turned = 0.0
    for a, b in pairwise(poses):
        length += a.distance_m(b)
        step = wrap_angle(b.heading_rad - a.heading_rad)
        turn += step
        turned += abs(step)
    return Way(length_m=length, turn_rad=turn, turned_rad=turned)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Unsureness:
    """Covariance (3, 3) of a pose, and that (3, 3) of its error with what wheels are wrong by: distance, drift, turn.

    What wheels are wrong by stays the same all the time. It is not estimated, only remembered (Schmidt 1966, "Application of
    state-space methods to navigation problems"): along a corridor, where no line tells, its error adds up over the whole way,
    however often it is interrupted.
    """

    pose: Array
    shared: Array


def carried_on(known: Unsureness, before: Pose, after: Pose, way: Way, noise: OdometryNoise) -> Unsureness:
    """Return how unsure the pose is at `after` that was so unsure at `before` (both map_from_robot).

    The way's heading error is taken to have come about evenly: at its middle, on average.
    """
    dx, dy = after.x_m - before.x_m, after.y_m - before.y_m
    move = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
    swing = np.array([-dy / 2, dx / 2, 1.0])
    grows = np.column_stack([[dx, dy, 0.0], swing * way.length_m, swing * way.turn_rad])
    errors = np.diag([noise.distance_fraction**2, noise.heading_rad_per_m**2, noise.heading_fraction**2])
    slip = swing * noise.heading_noise_rad * sqrt(way.turned_rad)
    back_and_forth = max(way.length_m - hypot(dx, dy), 0.0)  # half of its error remains
    rest = noise.distance_fraction * back_and_forth / 2
    both = move @ known.shared @ grows.T
    pose = move @ known.pose @ move.T + both + both.T + grows @ errors @ grows.T
    pose += np.outer(slip, slip) + np.diag([rest**2, rest**2, 0.0])
    return Unsureness(pose=(pose + pose.T) / 2, shared=move @ known.shared + grows @ errors)
