"""Comparisons and predicates: `=` and its like compare numbers, `eq` and `neq` whatever there is."""

import operator
from collections.abc import Callable
from itertools import pairwise

from rules.language.library.function import LibraryFunction, Number, at_least, fixed, integer, number
from rules.language.values import FALSE, Symbol, Value, as_symbol, same

Compare = Callable[[Number, Number], bool]


def _alike(compare: Compare, a: Number, b: Number) -> bool:
    """Compare two numbers; where one is a float, both are, as in CLIPS."""
    return compare(a, b) if isinstance(a, int) and isinstance(b, int) else compare(float(a), float(b))


def _chain(compare: Compare) -> Callable[..., Value]:
    def call(*arguments: Value) -> Symbol:
        numbers = [number(argument) for argument in arguments]
        return as_symbol(all(_alike(compare, a, b) for a, b in pairwise(numbers)))

    return call


def _with_first(compare: Compare) -> Callable[..., Value]:
    def call(*arguments: Value) -> Symbol:
        first, *others = [number(argument) for argument in arguments]
        return as_symbol(all(_alike(compare, first, other) for other in others))

    return call


def _of_kind(*kinds: type) -> LibraryFunction:
    return fixed(lambda value: as_symbol(isinstance(value, kinds)), 1)


COMPARISON: dict[str, LibraryFunction] = {
    "=": at_least(_with_first(operator.eq), 2),
    "<>": at_least(_with_first(operator.ne), 2),
    "<": at_least(_chain(operator.lt), 2),
    ">": at_least(_chain(operator.gt), 2),
    "<=": at_least(_chain(operator.le), 2),
    ">=": at_least(_chain(operator.ge), 2),
    "eq": at_least(lambda first, *others: as_symbol(all(same(first, other) for other in others)), 2),
    "neq": at_least(lambda first, *others: as_symbol(not any(same(first, other) for other in others)), 2),
    "not": fixed(lambda value: as_symbol(value == FALSE), 1),
    "numberp": _of_kind(int, float),
    "integerp": _of_kind(int),
    "floatp": _of_kind(float),
    "symbolp": _of_kind(Symbol),
    "stringp": _of_kind(str),
    "lexemep": _of_kind(Symbol, str),
    "multifieldp": _of_kind(tuple),
    "evenp": fixed(lambda value: as_symbol(integer(value) % 2 == 0), 1),
    "oddp": fixed(lambda value: as_symbol(integer(value) % 2 == 1), 1),
}
"""`and` and `or` are not here: they stop at the first argument that decides, so the evaluation itself knows them."""
