"""What a function of the language is, and the checks of its arguments."""

from collections.abc import Callable
from dataclasses import dataclass

from rules.language.values import FactAddress, Symbol, Value

Number = int | float


class FunctionFault(Exception):
    """A function was given what it cannot work with; the evaluation adds where that stands."""


@dataclass(frozen=True, slots=True)
class LibraryFunction:
    """A function without side effects, and how many arguments it takes (`most` is None where there is no limit)."""

    call: Callable[..., Value]
    least: int
    most: int | None


def fixed(call: Callable[..., Value], number: int) -> LibraryFunction:
    """Return a function of exactly so many arguments."""
    return LibraryFunction(call, number, number)


def at_least(call: Callable[..., Value], number: int) -> LibraryFunction:
    """Return a function of so many arguments or more."""
    return LibraryFunction(call, number, None)


def kind(value: Value) -> str:
    """Name the kind of a value, for messages."""
    names = {Symbol: "a symbol", str: "a string", int: "an integer", float: "a float", FactAddress: "a fact"}
    return names.get(type(value), "a multifield")


def number(value: Value) -> Number:
    """Return the value where it is a number."""
    if isinstance(value, int | float):
        return value
    raise FunctionFault(f"takes numbers, not {shown(value)}")


def integer(value: Value) -> int:
    """Return the value where it is an integer."""
    if isinstance(value, int):
        return value
    raise FunctionFault(f"takes an integer here, not {shown(value)}")


def lexeme(value: Value) -> str:
    """Return the letters of a symbol or a string."""
    if isinstance(value, Symbol):
        return value.name
    if isinstance(value, str):
        return value
    raise FunctionFault(f"takes a symbol or a string here, not {shown(value)}")


def multifield(value: Value) -> tuple[Value, ...]:
    """Return the value where it is a multifield."""
    if isinstance(value, tuple):
        return value
    raise FunctionFault(f"takes a multifield here, not {shown(value)}")


def shown(value: Value) -> str:
    """Return a value with its kind, for messages."""
    return f"{kind(value)} ({printed(value)})"


def printed(value: Value) -> str:
    """Return a value as `printout` and `str-cat` show it: strings bare, floats with 15 digits."""
    if isinstance(value, float):
        text = f"{value:.15g}"
        return text if any(sign in text for sign in ".en") else f"{text}.0"
    if isinstance(value, FactAddress):
        return f"<Fact-{value.index}>"
    if isinstance(value, tuple):
        return f"({' '.join(map(within, value))})"
    return str(value)


def within(value: Value) -> str:
    """Return a value as it is shown inside a multifield: a string keeps its quotation marks."""
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    return printed(value)
