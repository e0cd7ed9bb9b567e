"""Our values as CLIPS has them, and back. Symbols and strings stay apart; what CLIPS cannot read is a RuleError."""

from math import isfinite
from typing import Any

import clips
import clips.facts

from rules.language.errors import RuleError
from rules.language.values import FactAddress, FactValue, Symbol, Value

_ENDS = frozenset(' \t\r\n()&|~<>;"')  # a symbol ends before these; `<` may only begin one
_INTEGERS = range(-(2**63), 2**63)


def from_clips(value: Any) -> Value:
    """Return a value of clipspy's as ours; None, which a function without a result returns, is nil."""
    if isinstance(value, clips.Symbol):
        return Symbol(str(value))
    if value is None:
        return Symbol("nil")
    if isinstance(value, tuple | list):
        return tuple(map(from_clips, value))
    if isinstance(value, clips.facts.Fact):
        return FactAddress(value.index)
    if isinstance(value, str | int | float):
        return value
    raise RuleError(f"CLIPS returned what the rule language has no value for: {value!r}")


def to_clips(value: Value | None) -> Any:
    """Return a value of ours as clipspy takes it; fact addresses are not taken."""
    if value is None:
        return clips.Symbol("nil")
    if isinstance(value, Symbol):
        return clips.Symbol(value.name)
    if isinstance(value, tuple):
        return [to_clips(one) for one in value]
    if isinstance(value, FactAddress):
        raise RuleError(f"a fact address cannot be passed to CLIPS: {value}")
    return value


def check_readable(fact: FactValue) -> None:
    """Raise RuleError where CLIPS could not read a fact as it is written."""
    _check_symbol(fact.relation, fact)
    for value in fact.fields:
        _check(value, fact)


def _check(value: Value, fact: FactValue) -> None:
    if isinstance(value, tuple):
        for one in value:
            _check(one, fact)
    elif isinstance(value, Symbol):
        _check_symbol(value.name, fact)
    elif isinstance(value, float) and not isfinite(value):
        raise RuleError(f"{fact}: {value} is no number that CLIPS can read")
    elif isinstance(value, int) and value not in _INTEGERS:
        raise RuleError(f"{fact}: {value} does not fit into 64 bits")
    elif isinstance(value, str) and "\0" in value:
        raise RuleError(f"{fact}: a string cannot hold a zero byte")
    elif isinstance(value, FactAddress):
        raise RuleError(f"{fact}: a fact address can be asserted by rules only")


def _check_symbol(name: str, fact: FactValue) -> None:
    if not name or name[0] in "?$" or any(letter in _ENDS for letter in name[1:]) or name[0] in _ENDS - {"<"}:
        raise RuleError(f"{fact}: '{name}' is no symbol; make it a string")
    try:
        float(name)
    except ValueError:
        return
    raise RuleError(f"{fact}: '{name}' would be read as a number; make it a string")
