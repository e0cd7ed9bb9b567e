"""Arithmetic: integers stay integers (64 bits, which wrap) until a float comes in; `/` and `**` give floats."""

import math
import operator
from collections.abc import Callable
from functools import reduce

from rules.language.library.function import FunctionFault, LibraryFunction, Number, at_least, fixed, number
from rules.language.values import Value

SMALLEST, LARGEST = -(2**63), 2**63 - 1


def wrapped(value: int) -> int:
    """Return what 64 bits keep of an integer."""
    return (value - SMALLEST) % 2**64 + SMALLEST


def _folded(step: Callable[[Number, Number], Number]) -> Callable[..., Value]:
    def one(a: Number, b: Number) -> Number:
        if isinstance(a, int) and isinstance(b, int):
            return wrapped(int(step(a, b)))
        return step(float(a), float(b))

    def call(*arguments: Value) -> Number:
        return reduce(one, map(number, arguments))

    return call


def divide(*arguments: Value) -> float:
    """`/`: always a float."""
    first, *rest = map(number, arguments)
    quotient = float(first)
    for divisor in rest:
        if divisor == 0:
            raise FunctionFault("divides by zero")
        quotient /= float(divisor)
    return quotient


def divide_integers(*arguments: Value) -> int:
    """`div`: every argument loses its fraction first; the quotient too, towards zero."""
    first, *rest = (_truncated(number(argument)) for argument in arguments)
    quotient = first
    for divisor in rest:
        if divisor == 0:
            raise FunctionFault("divides by zero")
        if quotient == SMALLEST and divisor == -1:
            raise FunctionFault("leaves the range of 64 bits")
        magnitude = abs(quotient) // abs(divisor)
        quotient = magnitude if (quotient < 0) == (divisor < 0) else -magnitude
    return quotient


def modulo(a: Value, b: Value) -> Number:
    """`mod`: the remainder has the sign of the dividend."""
    dividend, divisor = number(a), number(b)
    if divisor == 0:
        raise FunctionFault("divides by zero")
    if isinstance(dividend, int) and isinstance(divisor, int):
        if dividend == SMALLEST and divisor == -1:
            raise FunctionFault("leaves the range of 64 bits")
        remainder = abs(dividend) % abs(divisor)
        return remainder if dividend >= 0 else -remainder
    quotient = float(dividend) / float(divisor)
    whole = math.trunc(quotient) if math.isfinite(quotient) else quotient
    return float(dividend) - whole * float(divisor)


def absolute(value: Value) -> Number:
    """`abs`."""
    given = number(value)
    return wrapped(abs(given)) if isinstance(given, int) else abs(given)


def least(*arguments: Value) -> Number:
    """`min`: of equal ones the first."""
    return reduce(lambda a, b: b if float_aware_less(b, a) else a, map(number, arguments))


def largest(*arguments: Value) -> Number:
    """`max`: of equal ones the first."""
    return reduce(lambda a, b: b if float_aware_less(a, b) else a, map(number, arguments))


def float_aware_less(a: Number, b: Number) -> bool:
    """Compare as CLIPS does: where one is a float, both are."""
    return a < b if isinstance(a, int) and isinstance(b, int) else float(a) < float(b)


def power(a: Value, b: Value) -> float:
    """`**`."""
    base, exponent = float(number(a)), float(number(b))
    if (base == 0 and exponent <= 0) or (base < 0 and math.isfinite(exponent) and exponent != int(exponent)):
        raise FunctionFault("cannot raise that number to that power")
    try:
        return math.pow(base, exponent)
    except OverflowError:
        return -math.inf if base < 0 and exponent % 2 == 1 else math.inf


def rounded(value: Value) -> int:
    """`round`: to the nearest integer, a half away from zero."""
    given = number(value)
    if isinstance(given, int):
        return given
    if not math.isfinite(given):
        return SMALLEST
    away = math.floor(abs(given))
    away += abs(given) - away >= 0.5
    return _in_range(away if given >= 0 else -away)


def _truncated(given: Number) -> int:
    if isinstance(given, int):
        return given
    return _in_range(math.trunc(given)) if math.isfinite(given) else SMALLEST


def _in_range(value: int) -> int:
    return value if SMALLEST <= value <= LARGEST else SMALLEST  # what a conversion in C gives here


ARITHMETIC: dict[str, LibraryFunction] = {
    "+": at_least(_folded(operator.add), 2),
    "-": at_least(_folded(operator.sub), 2),
    "*": at_least(_folded(operator.mul), 2),
    "/": at_least(divide, 2),
    "div": at_least(divide_integers, 2),
    "mod": fixed(modulo, 2),
    "abs": fixed(absolute, 1),
    "min": at_least(least, 1),
    "max": at_least(largest, 1),
    "**": fixed(power, 2),
    "round": fixed(rounded, 1),
    "integer": fixed(lambda value: _truncated(number(value)), 1),
    "float": fixed(lambda value: float(number(value)), 1),
}
