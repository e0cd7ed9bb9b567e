"""Kalman merge: two estimates of the same thing become one that is surer than either.

Source: Bou-Ghannam 1992, section 2.5.1 (p_ij = p_i + K (p_j - p_i), Cov = C_i - K C_i, K = C_i (C_i + C_j)^-1), section 2.5.2
(linear measurement z = H x + v) and section 5.2.4.1 (one parameter: p_new = p_m + (p_o - p_m) s_m^2 / (s_o^2 + s_m^2),
s_new^2 = s_m^2 s_o^2 / (s_o^2 + s_m^2)); C_new = F C F' of section 5.2.4.2. Errors of the two must be independent and Gaussian.

Angles: bring the observed one within half a turn of the model's before merging.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.limits import finite, within
from blackboard.uncertainty.matrices import Array, covariance, matrix, vector, whitened


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """One parameter: its mean and the variance (sigma squared) of its error."""

    mean: float
    variance: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean", finite("mean", self.mean))
        object.__setattr__(self, "variance", within("variance", self.variance, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VectorEstimate:
    """Several parameters: their mean (n,) and the covariance (n, n) of their errors."""

    mean: Array
    covariance: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean", vector("mean", self.mean))
        object.__setattr__(self, "covariance", covariance("covariance", self.covariance, len(self.mean)))


def merge(model: Estimate, observed: Estimate) -> Estimate:
    """Return the estimate of one parameter from both; raises UncertaintyError for two exact means that differ."""
    total = model.variance + observed.variance
    if total == 0.0:
        if model.mean != observed.mean:
            raise UncertaintyError(
                f"means {model.mean!r} and {observed.mean!r} are both exact and differ: nothing to merge"
            )
        return model
    gain = model.variance / total
    # weighing the surer side by its own gain keeps the sum between the two means, and exact where one is exact
    if gain <= 0.5:
        mean = model.mean + gain * (observed.mean - model.mean)
    else:
        mean = observed.mean + (observed.variance / total) * (model.mean - observed.mean)
    return Estimate(mean=mean, variance=min(gain * observed.variance, model.variance, observed.variance))


def merge_vectors(model: VectorEstimate, observed: VectorEstimate) -> VectorEstimate:
    """Return the estimate of all parameters from both; raises UncertaintyError where C_i + C_j is singular."""
    if len(observed.mean) != len(model.mean):
        raise UncertaintyError(
            f"cannot merge {len(observed.mean)} observed parameters with {len(model.mean)} of the model"
        )
    return measure(model, observed, np.eye(len(model.mean)))


def measure(prior: VectorEstimate, measured: VectorEstimate, measurement_matrix: ArrayLike) -> VectorEstimate:
    """Return the state x after measuring z = H x + v: `measured` holds z (m,) and the covariance of v, H is (m, n).

    Raises UncertaintyError where H does not fit or the covariance of the predicted difference z - H x is singular.
    """
    h = matrix("measurement matrix", measurement_matrix, len(prior.mean))
    if len(h) != len(measured.mean):
        raise UncertaintyError(f"measurement matrix has {len(h)} rows for {len(measured.mean)} measured numbers")
    c, r = prior.covariance, measured.covariance
    s = h @ c @ h.T + r
    difference = (measured.mean - h @ prior.mean)[:, None]
    # L^-1 of each, with L L' = S: the gain K = C H' S^-1 is the product of two of them
    columns = whitened("covariance of the difference", s, np.hstack([h @ c, difference, np.eye(len(h))]))
    cross, step, unit = np.split(columns, [len(c), len(c) + 1], axis=1)
    mean = prior.mean + cross.T @ step[:, 0]
    gain = cross.T @ unit
    kept = np.eye(len(c)) - gain @ h
    # C - K H C in the form that rounding cannot make negative
    after = kept @ c @ kept.T + gain @ r @ gain.T
    return VectorEstimate(mean=mean, covariance=(after + after.T) / 2)


def transform_covariance(before: ArrayLike, jacobian: ArrayLike) -> Array:
    """Return C_new = F C F', (m, m), of what F (m, n) makes of parameters with the covariance C (n, n)."""
    c = covariance("covariance", before)
    f = matrix("jacobian", jacobian, len(c))
    after = f @ c @ f.T
    return np.asarray((after + after.T) / 2, dtype=np.float64)
