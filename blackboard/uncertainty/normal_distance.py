"""Normal distance: may two estimates be of the same thing?

Source: Bou-Ghannam 1992, section 2.5.1 (correlation or consistency checking): accept H0 where d = e' C^-1 e is below the threshold
that chi-square exceeds with probability a, with C = Ci - Cij - Cji + Cj, and C = Ci + Cj for independent errors. Section
5.2.4.1 (match) reduces it to one parameter at a time: (o - m)^2 <= k^2 (so^2 + sm^2), k = 2 for 95 %.

Differences are arguments, not estimates: only the caller knows which parameters are angles and how they wrap.
"""

import math
from dataclasses import dataclass

from numpy.typing import ArrayLike

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.chi_square import chi_square_quantile
from blackboard.uncertainty.limits import finite, within
from blackboard.uncertainty.matrices import Array, covariance, matrix, vector, whitened


@dataclass(frozen=True, slots=True, kw_only=True)
class Consistency:
    """Outcome of the test: the squared normal distance, the bound it was held against, and whether it stays below."""

    distance: float
    bound: float
    accepted: bool


def normal_distance(difference: ArrayLike, difference_covariance: ArrayLike) -> float:
    """Return d = e' C^-1 e for the (n,) difference e and its (n, n) covariance C.

    Raises UncertaintyError where C is no covariance or is singular: along an exact direction no distance is defined.
    """
    e = vector("difference", difference)
    c = covariance("difference covariance", difference_covariance, len(e))
    independent = whitened("difference covariance", c, e)
    return float(independent @ independent)


def difference_covariance(first: ArrayLike, second: ArrayLike, cross: ArrayLike | None = None) -> Array:
    """Return C = Ci - Cij - Cji + Cj, (n, n), of the difference of two estimates; independent errors without `cross` (Cij)."""
    ci = covariance("first covariance", first)
    cj = covariance("second covariance", second, len(ci))
    if cross is None:
        return ci + cj
    cij = matrix("cross covariance", cross, len(ci))
    if len(cij) != len(ci):
        raise UncertaintyError(f"cross covariance has {len(cij)} rows where {len(ci)} are needed")
    return covariance("difference covariance", ci - cij - cij.T + cj)


def check_consistency(difference: ArrayLike, difference_covariance: ArrayLike, confidence: float = 0.95) -> Consistency:
    """Return whether a difference is small enough to be error alone; `confidence` is 1 - a, 0.95 as in the source."""
    distance = normal_distance(difference, difference_covariance)
    bound = chi_square_quantile(confidence, len(vector("difference", difference)))
    return Consistency(distance=distance, bound=bound, accepted=distance < bound)


def parameter_distance(difference: float, first_sigma: float, second_sigma: float) -> float:
    """Return the squared normal distance of one parameter, (o - m)^2 / (so^2 + sm^2); at least one sigma is positive."""
    difference = finite("difference", difference)
    spread = math.hypot(within("first sigma", first_sigma, 0.0), within("second sigma", second_sigma, 0.0))
    if spread == 0.0:
        raise UncertaintyError("both sigmas are 0: a distance needs an uncertainty on at least one side")
    return (difference / spread) ** 2


def parameter_matches(difference: float, first_sigma: float, second_sigma: float, k: float = 2.0) -> bool:
    """Return whether |o - m| <= k sqrt(so^2 + sm^2); k = 2 keeps 95 % of true matches. Exact parameters match when equal."""
    spread = math.hypot(within("first sigma", first_sigma, 0.0), within("second sigma", second_sigma, 0.0))
    return abs(finite("difference", difference)) <= within("k", k, 0.0) * spread
