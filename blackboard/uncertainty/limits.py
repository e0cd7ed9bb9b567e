"""Checks of numbers: each returns the value as a float, or raises an UncertaintyError of one line."""

import math
from collections.abc import Iterable

from blackboard.errors import UncertaintyError

SUM_TOLERANCE = 1e-9  # how far numbers that share one unit may miss it: far above rounding, far below a mistake


def within(name: str, value: float, low: float, high: float = math.inf) -> float:
    """Return `value` as a float where it is a finite number in [low, high]; raise UncertaintyError otherwise."""
    number = finite(name, value)
    if not low <= number <= high:
        limit = f"[{low:g}, {high:g}]" if math.isfinite(high) else f"[{low:g}, infinity)"
        raise UncertaintyError(f"{name} = {value!r} is outside {limit}")
    return number


def finite(name: str, value: float) -> float:
    """Return `value` as a float where it is a finite number; raise UncertaintyError otherwise."""
    if isinstance(value, bool | str | bytes):
        raise UncertaintyError(f"{name} = {value!r} must be a number, not {type(value).__name__}")
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise UncertaintyError(f"{name} must be a number, not {type(value).__name__}") from None
    if not math.isfinite(number):
        raise UncertaintyError(f"{name} = {number!r} must be finite")
    return number


def sums_to_one(name: str, values: Iterable[float]) -> None:
    """Raise UncertaintyError unless the values add up to 1."""
    total = math.fsum(values)
    if abs(total - 1.0) > SUM_TOLERANCE:
        raise UncertaintyError(f"{name} add up to {total:.12g}, not to 1; share out exactly one unit")
