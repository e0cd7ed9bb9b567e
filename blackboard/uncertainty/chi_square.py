"""The chi-square distribution, for the threshold of the consistency check: p{d > threshold | H0} = a.

Source: Bou-Ghannam 1992, section 2.5.1 (the squared normal distance of n Gaussian parameters is chi-square with n degrees of
freedom). The distribution function is the regularised incomplete gamma function, by its power series below the mean and its
continued fraction above it (Abramowitz and Stegun 1964, 6.5.29 and 6.5.31); the quantile is found by Newton steps that never leave
a bracket. Relative error below 1e-9 up to a thousand degrees of freedom.
"""

import math
from functools import lru_cache
from statistics import NormalDist

from blackboard.errors import UncertaintyError
from blackboard.uncertainty.limits import within

MAX_STEPS = 200  # bisection alone halves any bracket of doubles to nothing in fewer
CONVERGED = 1e-15  # the last term no longer changes a double
TINY = 1e-300  # stands for zero in a denominator of the continued fraction


def chi_square_probability(distance: float, dimension: int) -> float:
    """Return the probability that a chi-square variable of `dimension` degrees of freedom is at most `distance`."""
    return _tails(within("distance", distance, 0.0), _checked(dimension))[0]


@lru_cache(maxsize=256)
def chi_square_quantile(probability: float, dimension: int) -> float:
    """Return the distance that a chi-square variable of `dimension` degrees of freedom stays below with `probability`.

    Raises UncertaintyError for a probability outside [0, 1) or a dimension below 1.
    """
    probability = within("probability", probability, 0.0, 1.0)
    dimension = _checked(dimension)
    if probability == 1.0:
        raise UncertaintyError("probability = 1 has no finite bound; give less than 1")
    if probability == 0.0:
        return 0.0
    low, high = 0.0, math.inf
    distance = _first_guess(probability, dimension)
    for _ in range(MAX_STEPS):
        below, above = _tails(distance, dimension)
        # the smaller tail keeps its digits where the other has rounded to 1
        lower = probability < 0.5
        tail, wanted = (below, probability) if lower else (above, 1.0 - probability)
        low, high = (distance, high) if (tail < wanted) == lower else (low, distance)
        following = distance * _newton_factor(distance, dimension, tail, wanted, lower)
        if not low <= following <= high:
            following = 2 * distance if math.isinf(high) else (low + high) / 2
        if abs(following - distance) <= 4e-16 * distance:
            return following
        distance = following
    return distance


def _newton_factor(distance: float, dimension: int, tail: float, wanted: float, lower: bool) -> float:
    """Return what Newton's step multiplies the distance by, both axes logarithmic; NaN where it gives no direction."""
    slope = distance * _density(distance, dimension)
    if tail == 0.0 or slope == 0.0 or math.isinf(slope):
        return math.nan
    step = math.log(tail / wanted) * tail / slope
    return math.exp(min(max(-step if lower else step, -2.0), 2.0))


def _checked(dimension: int) -> int:
    if isinstance(dimension, bool) or not isinstance(dimension, int) or dimension < 1:
        raise UncertaintyError(f"dimension = {dimension!r} must be a whole number of at least 1")
    return dimension


def _first_guess(probability: float, dimension: int) -> float:
    if dimension <= 2 or probability < 0.01:  # the first term of the series, good for short distances
        half = dimension / 2
        short = 2 * math.exp((math.log(probability) + math.lgamma(half + 1)) / half)
        if short < half:
            return max(short, TINY)
    spread = 2 / (9 * dimension)
    z = NormalDist().inv_cdf(min(max(probability, 1e-300), 1 - 2**-53))
    return dimension * max(1 - spread + z * math.sqrt(spread), 0.01) ** 3  # Wilson and Hilferty 1931


def _density(distance: float, dimension: int) -> float:
    half = dimension / 2
    if distance / 2 == 0.0:  # a bound too short for a double
        return math.inf
    exponent = (half - 1) * math.log(distance / 2) - distance / 2 - math.lgamma(half)
    return math.exp(exponent) / 2 if exponent < 700 else math.inf


def _tails(distance: float, dimension: int) -> tuple[float, float]:
    """Return the probabilities of less and of more than `distance`."""
    half, x = dimension / 2, distance / 2
    if x == 0.0:
        return 0.0, 1.0
    front = math.exp(half * math.log(x) - x - math.lgamma(half))
    if x < half + 1:
        term = total = 1 / half
        step = half
        while term > total * CONVERGED:
            step += 1
            term *= x / step
            total += term
        below = min(front * total, 1.0)
        return below, 1.0 - below
    b = x + 1 - half  # Lentz's evaluation of the continued fraction
    c, d = 1 / TINY, 1 / b
    value, i, change = d, 0, 0.0
    while abs(change - 1) > CONVERGED:
        i += 1
        a = i * (half - i)
        b += 2
        d = 1 / _not_zero(a * d + b)
        c = _not_zero(b + a / c)
        change = c * d
        value *= change
    above = min(front * value, 1.0)
    return 1.0 - above, above


def _not_zero(value: float) -> float:
    return value if abs(value) > TINY else TINY
