"""Planar poses as arrays: the last axis holds x_m, y_m, heading_rad; `a_from_b` as everywhere."""

from math import pi

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def wrap(angles_rad: Floats) -> Floats:
    """Return the same directions in [-pi, pi)."""
    return (angles_rad + pi) % (2.0 * pi) - pi


def compose(a_from_b: Floats, b_from_c: Floats) -> Floats:
    """Return a_from_c; the leading axes broadcast."""
    a, b = np.broadcast_arrays(a_from_b, b_from_c)
    c, s = np.cos(a[..., 2]), np.sin(a[..., 2])
    x = a[..., 0] + c * b[..., 0] - s * b[..., 1]
    y = a[..., 1] + s * b[..., 0] + c * b[..., 1]
    return np.stack([x, y, wrap(a[..., 2] + b[..., 2])], axis=-1)


def between(map_from_a: Floats, map_from_b: Floats) -> Floats:
    """Return a_from_b."""
    a, b = np.broadcast_arrays(map_from_a, map_from_b)
    c, s = np.cos(a[..., 2]), np.sin(a[..., 2])
    dx, dy = b[..., 0] - a[..., 0], b[..., 1] - a[..., 1]
    return np.stack([c * dx + s * dy, -s * dx + c * dy, wrap(b[..., 2] - a[..., 2])], axis=-1)


def transform(a_from_b: Floats, points: Floats) -> Floats:
    """Return the points (n, 2) of frame b in frame a."""
    return rotate(a_from_b, points) + a_from_b[..., :2]


def rotate(a_from_b: Floats, vectors: Floats) -> Floats:
    """Return the directions (n, 2) of frame b in frame a; one pose, or one for each direction."""
    c, s = np.cos(a_from_b[..., 2]), np.sin(a_from_b[..., 2])
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
