"""Which observed line is which known one, and which known ones are the same: by normal distance under the joint covariance."""

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from blackboard.messages.geometry import wrap_angle
from blackboard.uncertainty.matrices import Array
from blackboard.uncertainty.normal_distance import normal_distance
from knowledge_sources.joint_estimate.params import JointLinesParams
from knowledge_sources.joint_estimate.state import LINES, PAST, JointState, LineExtent
from knowledge_sources.line_estimates import LineEstimate


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinePair:
    """Observed less known: direction and offset (2,), H (2, n), the observed line's own covariance (2, 2); where it lies along."""

    number: int
    difference: Array
    h: Array
    noise: Array
    distance: float  # squared normal distance
    from_m: float  # the observed line's ends along the known one
    to_m: float


def estimate_of(state: JointState, number: int) -> LineEstimate:
    """Return a known line as an estimate about its middle."""
    theta, offset, covariance = state.line(number)
    extent = state.lines[number]
    c, s = cos(theta), sin(theta)
    middle = (extent.from_m + extent.to_m) / 2.0
    shift = np.array([[1.0, 0.0], [-middle, 1.0]])
    return LineEstimate(
        theta_rad=wrap_angle(theta),
        x_m=extent.anchor_x_m + offset * s + middle * c,
        y_m=extent.anchor_y_m - offset * c + middle * s,
        half_length_m=(extent.to_m - extent.from_m) / 2.0,
        covariance=shift @ covariance @ shift.T,
        faces_left=extent.faces_left,
    )


def pair_lines(state: JointState, observed: LineEstimate, gap_m: float) -> list[LinePair]:
    """Return the observed line with each known one that faces its way and that it overlaps, or nearly; the nearest first."""
    pairs = []
    for number in range(len(state.lines)):
        pair = _pair(state, number, observed)
        if pair is not None and _gap(pair, state.lines[number]) <= gap_m:
            pairs.append(pair)
    return sorted(pairs, key=lambda pair: pair.distance)


def badly_seen(state: JointState, observed: LineEstimate, params: JointLinesParams) -> str | None:
    """Return the known line that most of the observed one runs along, nearer than two walls stand to each other.

    It is not another wall then, but the same seen amiss: echoes of a corner taken for it, or a batch in which odometry erred.
    """
    for pair in pair_lines(state, observed, 0.0):
        extent = state.lines[pair.number]
        shared = min(pair.to_m, extent.to_m) - max(pair.from_m, extent.from_m)
        turn, out = np.abs(pair.difference)
        if shared >= (pair.to_m - pair.from_m) / 2.0 and out <= params.apart_m and turn <= params.apart_rad:
            return extent.id
    return None


def same_lines(state: JointState, a: int, b: int, noise: Array) -> LinePair | None:
    """Return line b held against line a, as if b had been observed with covariance `noise` (2, 2); None where they face apart."""
    other = estimate_of(state, b)
    pair = _pair(state, a, other)
    if pair is None:
        return None
    h = pair.h.copy()
    h[:, :LINES] = 0.0
    at = LINES + 2 * b
    extent = state.lines[b]
    middle = (extent.from_m + extent.to_m) / 2.0
    sign = 1.0 if cos(other.theta_rad - state.line(a)[0]) >= 0.0 else -1.0
    h[0, at] += 1.0
    h[1, at] += -sign * middle
    h[1, at + 1] += sign
    s = h @ state.covariance @ h.T + noise
    return LinePair(
        number=a,
        difference=pair.difference,
        h=h,
        noise=noise,
        distance=normal_distance(pair.difference, s),
        from_m=pair.from_m,
        to_m=pair.to_m,
    )


def _pair(state: JointState, number: int, observed: LineEstimate) -> LinePair | None:
    extent = state.lines[number]
    theta, offset, _ = state.line(number)
    turn = wrap_angle(observed.theta_rad - theta)
    own = observed if cos(turn) >= 0.0 else observed.flipped()
    turn = wrap_angle(own.theta_rad - theta)
    if own.faces_left != extent.faces_left or abs(turn) > 0.5:
        return None
    c, s = cos(theta), sin(theta)
    away_x, away_y = own.x_m - extent.anchor_x_m, own.y_m - extent.anchor_y_m
    along, out = away_x * c + away_y * s, away_x * s - away_y * c - offset
    if abs(out) > 3.0:
        return None
    h = np.zeros((2, len(state.mean)))
    h[:, :PAST] = state.seen(own.x_m, own.y_m, theta)
    at = LINES + 2 * number
    h[0, at], h[1, at], h[1, at + 1] = -1.0, along, -1.0
    difference = np.array([turn, out])
    s_all = h @ state.covariance @ h.T + own.covariance
    half = own.half_length_m
    return LinePair(
        number=number,
        difference=difference,
        h=h,
        noise=own.covariance,
        distance=normal_distance(difference, s_all),
        from_m=along - half,
        to_m=along + half,
    )


def _gap(pair: LinePair, extent: LineExtent) -> float:
    """Return how far apart both lie along the line; negative where they overlap."""
    return max(pair.from_m - extent.to_m, extent.from_m - pair.to_m)
