"""Entries of the board that a story tells of by some of their slots."""

from collections.abc import Mapping
from typing import Any

import msgspec
from msgspec import inspect

from blackboard.entry import Entry
from rules.language.errors import RuleError
from rules.language.templates import KindTemplate, plainly
from rules.language.values import Value

ORIGIN = ("id", "key", "stamp-s")


def revised(made: KindTemplate, slots: Mapping[str, Value], standing: Entry[Any] | None) -> Any:
    """Return the message that these slots make of what stands, or of nothing in particular. Raises RuleError."""
    plain = msgspec.to_builtins(standing.value if standing is not None else neutral(made))
    try:
        return made.revised(plain, {name: value for name, value in slots.items() if name not in ORIGIN})
    except msgspec.ValidationError as error:
        raise RuleError(f"'{made.template.name}': {plainly(error)}") from None


def neutral(made: KindTemplate) -> Any:
    """Return a message that says as little as it may: defaults, the first word of a choice, nothing, or 0."""
    try:
        return msgspec.convert(_record(made.kind.type), made.kind.type)
    except (msgspec.ValidationError, ValueError, TypeError):
        raise RuleError(f"entries of '{made.template.name}' cannot stand in a story") from None


def _record(type_: type[msgspec.Struct]) -> dict[str, Any]:
    info = inspect.type_info(type_)
    assert isinstance(info, inspect.StructType)
    return {field.name: _value(field.type) for field in info.fields if field.required}


def _value(type_: inspect.Type) -> Any:
    if isinstance(type_, inspect.Metadata):
        return _value(type_.type)
    if isinstance(type_, inspect.UnionType):
        return None if any(isinstance(t, inspect.NoneType) for t in type_.types) else _value(type_.types[0])
    if isinstance(type_, inspect.LiteralType):
        return type_.values[0]
    if isinstance(type_, inspect.StructType):
        return _record(type_.cls)
    if isinstance(type_, inspect.VarTupleType | inspect.ListType):
        return [_value(type_.item_type)] * (type_.min_length or 0)
    if isinstance(type_, inspect.TupleType):
        return [_value(item) for item in type_.item_types]
    if isinstance(type_, inspect.StrType):
        return "x" * (type_.min_length or 0)
    if isinstance(type_, inspect.BoolType):
        return False
    if isinstance(type_, inspect.IntType | inspect.FloatType):
        return _number(type_)
    return None


def _number(type_: inspect.IntType | inspect.FloatType) -> int | float:
    """Return the number nearest to 0 that is allowed, or half way to the upper limit where the lower is not itself allowed."""
    if type_.gt is not None and type_.gt >= 0:
        upper = type_.lt if type_.lt is not None else type_.le
        return type_.gt + 1 if upper is None or upper > type_.gt + 1 else (type_.gt + upper) / 2
    if type_.ge is not None and type_.ge > 0:
        return type_.ge
    return type_.le if type_.le is not None and type_.le < 0 else 0
