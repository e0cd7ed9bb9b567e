"""Roots, logarithms, and the functions of angles (radians); what has no value is a fault, as in CLIPS."""

import math
from collections.abc import Callable

from rules.language.library.function import FunctionFault, LibraryFunction, fixed, number
from rules.language.values import Value

NEAR_ASYMPTOTE = 1e-15  # below this a sine or cosine counts as zero
NEAR_ZERO = 1e-25  # below this the argument of acot counts as zero

Formula = Callable[[float], float]


def _of_number(formula: Formula, defined: Callable[[float], bool] = lambda _: True) -> LibraryFunction:
    def call(value: Value) -> float:
        given = float(number(value))
        if not defined(given):
            raise FunctionFault(f"has no value at {given!r}")
        try:
            return formula(given)
        except ValueError:
            raise FunctionFault(f"has no value at {given!r}") from None
        except OverflowError:
            return math.copysign(math.inf, given) if formula is math.sinh else math.inf

    return fixed(call, 1)


def _has_cosine(x: float) -> bool:
    return abs(math.cos(x)) >= NEAR_ASYMPTOTE


def _has_sine(x: float) -> bool:
    return abs(math.sin(x)) >= NEAR_ASYMPTOTE


def _outside_one(x: float) -> bool:
    return abs(x) >= 1


def _over_square(x: float) -> float:
    return 1 / (x * x) if x * x else math.inf


def _logarithm(x: float) -> float:
    """The inverse hyperbolic functions go through logarithms in CLIPS, and leave the floats where those do."""
    if x < 0:
        return math.nan
    return math.log(x) if x else -math.inf


def _divided(formula: Formula) -> Formula:
    """Return 1 / formula(x), which is 0 where the formula leaves the floats."""

    def call(x: float) -> float:
        try:
            return 1 / formula(x)
        except OverflowError:
            return 0.0

    return call


TRIGONOMETRY: dict[str, LibraryFunction] = {
    "pi": LibraryFunction(lambda: math.pi, 0, 0),
    "deg-rad": _of_number(lambda x: x * math.pi / 180),
    "rad-deg": _of_number(lambda x: x * 180 / math.pi),
    "deg-grad": _of_number(lambda x: x / 0.9),
    "grad-deg": _of_number(lambda x: x * 0.9),
    "sqrt": _of_number(math.sqrt),
    "exp": _of_number(math.exp),
    "log": _of_number(math.log),
    "log10": _of_number(math.log10),
    "sin": _of_number(math.sin),
    "cos": _of_number(math.cos),
    "tan": _of_number(math.tan, _has_cosine),
    "sec": _of_number(_divided(math.cos), _has_cosine),
    "csc": _of_number(_divided(math.sin), _has_sine),
    "cot": _of_number(lambda x: math.cos(x) / math.sin(x), _has_sine),
    "asin": _of_number(math.asin),
    "acos": _of_number(math.acos),
    "atan": _of_number(math.atan),
    "asec": _of_number(lambda x: math.acos(1 / x), _outside_one),
    "acsc": _of_number(lambda x: math.asin(1 / x), _outside_one),
    "acot": _of_number(lambda x: math.pi / 2 if abs(x) < NEAR_ZERO else math.atan(1 / x)),
    "sinh": _of_number(math.sinh),
    "cosh": _of_number(math.cosh),
    "tanh": _of_number(math.tanh),
    "sech": _of_number(_divided(math.cosh)),
    "csch": _of_number(_divided(math.sinh), lambda x: abs(x) > NEAR_ZERO),
    "coth": _of_number(lambda x: 1 / math.tanh(x), lambda x: abs(x) > NEAR_ZERO),
    "asinh": _of_number(lambda x: _logarithm(x + math.sqrt(x * x + 1))),
    "acosh": _of_number(lambda x: _logarithm(x + math.sqrt(x * x - 1)), lambda x: x >= 1),
    "atanh": _of_number(lambda x: 0.5 * _logarithm((1 + x) / (1 - x)), lambda x: abs(x) < 1),
    "asech": _of_number(lambda x: _logarithm(1 / x + math.sqrt(_over_square(x) - 1)), lambda x: 0 < x <= 1),
    "acsch": _of_number(lambda x: _logarithm(1 / x + math.sqrt(_over_square(x) + 1)), lambda x: x != 0),
    "acoth": _of_number(lambda x: 0.5 * _logarithm((x + 1) / (x - 1)), lambda x: abs(x) > 1),
}
