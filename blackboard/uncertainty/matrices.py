"""Checks of vectors and covariances: each returns a float array, or raises an UncertaintyError of one line."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blackboard.errors import UncertaintyError

Array = NDArray[np.float64]

RELATIVE_TOLERANCE = 1e-9  # asymmetry and negative eigenvalues up to this part of the largest element are rounding


def vector(name: str, value: ArrayLike) -> Array:
    """Return `value` as a (n,) array with n >= 1; raise UncertaintyError for another shape or what is not finite."""
    return _array(name, value, 1)


def matrix(name: str, value: ArrayLike, columns: int) -> Array:
    """Return `value` as a (m, columns) array with m >= 1; raise UncertaintyError otherwise."""
    array = _array(name, value, 2)
    if array.shape[1] != columns:
        raise UncertaintyError(f"{name} has {array.shape[1]} columns where {columns} are needed")
    return array


def covariance(name: str, value: ArrayLike, dimension: int | None = None) -> Array:
    """Return `value` as a symmetric (n, n) array without negative eigenvalues; raise UncertaintyError otherwise."""
    array = _array(name, value, 2)
    rows, columns = array.shape
    if rows != columns or (dimension is not None and rows != dimension):
        needed = "be square" if dimension is None else f"be {dimension} x {dimension}"
        raise UncertaintyError(f"{name} is {rows} x {columns} and must {needed}")
    scale = float(np.abs(array).max())
    if float(np.abs(array - array.T).max()) > RELATIVE_TOLERANCE * scale:
        raise UncertaintyError(f"{name} is not symmetric")
    symmetric: Array = (array + array.T) / 2
    smallest = float(np.linalg.eigvalsh(symmetric)[0])
    if smallest < -RELATIVE_TOLERANCE * scale:
        raise UncertaintyError(f"{name} has the negative eigenvalue {smallest:.6g} and is no covariance")
    return symmetric


def whitened(name: str, definite: Array, value: Array) -> Array:
    """Return L^-1 value, where L L' = `definite`; raise UncertaintyError where that covariance is singular.

    The covariance is scaled to unit variances first, so that metres beside radians do not look singular.
    """
    sigma = np.sqrt(np.diag(definite))
    if not np.all(sigma > 0):
        raise UncertaintyError(f"{name} is singular: parameter {int(np.argmin(sigma))} has no uncertainty")
    correlation = definite / np.outer(sigma, sigma)
    if float(np.linalg.eigvalsh(correlation)[0]) <= RELATIVE_TOLERANCE * len(sigma):
        raise UncertaintyError(f"{name} is singular: some combination of its parameters has no uncertainty")
    scaled = (value.T / sigma).T
    return np.asarray(np.linalg.solve(np.linalg.cholesky(correlation), scaled), dtype=np.float64)


def _array(name: str, value: ArrayLike, dimensions: int) -> Array:
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise UncertaintyError(f"{name} must be an array of numbers with {dimensions} axes") from None
    if array.ndim != dimensions or array.size == 0:
        raise UncertaintyError(
            f"{name} has the shape {array.shape} and must have {dimensions} axes, none of them empty"
        )
    if not np.isfinite(array).all():
        raise UncertaintyError(f"{name} holds a number that is not finite")
    return array
