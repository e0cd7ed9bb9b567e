"""What a range value means: an echo, nothing came back, or nothing at all (REP-117).

Inside this package ranges are float64 arrays in metres in which infinity says that nothing came back and NaN that the value
is unfit: not a number, not positive, or nearer than the sensor can measure.
"""

from collections.abc import Sequence
from math import inf, nan

import numpy as np
import numpy.typing as npt

from blackboard.messages.sensing import Echo

DECIMALS = 4  # 0.1 mm: finer than any of these sensors, and short in the record

Ranges = npt.NDArray[np.float64]


def sort_out(values: npt.ArrayLike, min_range_m: float, max_range_m: float) -> Ranges:
    """Return ranges as this package writes them: at or beyond `max_range_m` is infinity, below `min_range_m` is NaN."""
    ranges: Ranges = np.asarray(values, dtype=np.float64).round(DECIMALS)
    ranges[ranges >= round(max_range_m, DECIMALS)] = inf
    ranges[(ranges <= 0.0) | (ranges < round(min_range_m, DECIMALS))] = nan
    return ranges


def sort_out_one(value: float, min_range_m: float, max_range_m: float) -> float:
    """Do for a single range what `sort_out` does for many."""
    range_m = round(value, DECIMALS)
    if range_m >= round(max_range_m, DECIMALS):
        return inf
    return range_m if range_m > 0.0 and range_m >= round(min_range_m, DECIMALS) else nan


def unfit(ranges: Ranges) -> int:
    """Return how many values are neither an echo nor the lack of one."""
    return int(np.count_nonzero(np.isnan(ranges)))


def as_echoes(ranges: Ranges) -> tuple[Echo, ...]:
    """Return echoes as the vocabulary has them: None where nothing came back, and where the value is unfit."""
    return tuple([r if r < inf else None for r in ranges.tolist()])


def fit_echoes(sensors: Sequence[int], ranges: Ranges) -> tuple[tuple[int, ...], tuple[Echo, ...]]:
    """Return sensors and echoes of those sonars whose value is fit: the others said nothing and are left out."""
    fit = [(s, r) for s, r in zip(sensors, ranges.tolist(), strict=True) if r == r]  # NaN differs from itself
    return tuple(s for s, _ in fit), tuple(r if r < inf else None for _, r in fit)
