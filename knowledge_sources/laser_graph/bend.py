"""A pose at every odometry reading: odometry between two keyframes, bent so that it begins at one and ends at the other."""

import numpy as np
import numpy.typing as npt

from knowledge_sources.laser_graph.odometry_model import OdometryModel
from knowledge_sources.laser_graph.poses import Floats, between, compose, wrap


def dead_reckon(odometry: Floats, model: OdometryModel) -> Floats:
    """Return the poses (n, 3) that odometry (n, 3) without its systematic errors adds up to, from zero."""
    pieces = model.correct(between(odometry[:-1], odometry[1:]))
    headings = np.concatenate([[0.0], np.cumsum(pieces[:, 2])])
    c, s = np.cos(headings[:-1]), np.sin(headings[:-1])
    x = np.cumsum(c * pieces[:, 0] - s * pieces[:, 1])
    y = np.cumsum(s * pieces[:, 0] + c * pieces[:, 1])
    return np.column_stack([np.concatenate([[0.0], x]), np.concatenate([[0.0], y]), wrap(headings)])


def bend(odometry: Floats, at: npt.NDArray[np.intp], keyframes: Floats, model: OdometryModel) -> Floats:
    """Return poses (n, 3) along odometry (n, 3) that pass through `keyframes` (m, 3), keyframe k at reading `at[k]` (rising).

    Between two keyframes the way from the one and the way back from the other are blended by how far the robot had moved: a turn
    counts as much as the way over which the heading gets as unsure.
    """
    smooth = dead_reckon(odometry, model)
    steps = between(smooth[:-1], smooth[1:])
    metres_per_rad = model.sigma_turn_fraction / model.sigma_drift_rad_per_m
    lengths = np.hypot(steps[:, 0], steps[:, 1]) + metres_per_rad * np.abs(steps[:, 2])
    motion = np.concatenate([[0.0], np.cumsum(lengths)])
    motion += 1e-9 * np.arange(len(motion))
    after = np.searchsorted(at, np.arange(len(odometry)), side="right")
    first, second = np.maximum(after - 1, 0), np.minimum(after, len(at) - 1)
    start, end = at[first], at[second]
    forward = compose(keyframes[first], between(smooth[start], smooth))
    backward = compose(keyframes[second], between(smooth[end], smooth))
    whole = motion[end] - motion[start]
    fraction = np.clip(np.where(whole > 0, (motion - motion[start]) / np.where(whole > 0, whole, 1.0), 0.0), 0.0, 1.0)
    bent = forward + fraction[:, None] * (backward - forward)
    bent[:, 2] = wrap(forward[:, 2] + fraction * wrap(backward[:, 2] - forward[:, 2]))
    return bent
