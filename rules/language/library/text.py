"""Functions of strings and symbols; letters count from 1."""

from rules.language.library.function import FunctionFault, LibraryFunction, at_least, fixed, integer, lexeme, printed
from rules.language.values import FALSE, Symbol, Value


def _joined(values: tuple[Value, ...]) -> str:
    for value in values:
        if isinstance(value, tuple):
            raise FunctionFault("takes single values, not a multifield")
    return "".join(map(printed, values))


def _like(given: Value, text: str) -> Value:
    """Return the text as what it was made of: a symbol or a string."""
    return Symbol(text) if isinstance(given, Symbol) else text


def upper(value: Value) -> Value:
    """`upcase`: a to z only."""
    return _like(value, "".join(letter.upper() if letter.isascii() else letter for letter in lexeme(value)))


def lower(value: Value) -> Value:
    """`lowcase`: A to Z only."""
    return _like(value, "".join(letter.lower() if letter.isascii() else letter for letter in lexeme(value)))


def part(first: Value, last: Value, text: Value) -> str:
    """`sub-string`: from the first letter to the last, as far as there are any."""
    begin, end, letters = integer(first), integer(last), lexeme(text)
    return letters[max(begin, 1) - 1 : max(end, 0)]


def index(sought: Value, text: Value) -> Value:
    """`str-index`: where one text begins in another, or FALSE."""
    found = lexeme(text).find(lexeme(sought))
    return FALSE if found < 0 else found + 1


def compare(a: Value, b: Value, length: Value | None = None) -> int:
    """`str-compare`: -1, 0 or 1; of the first `length` bytes only, where it is given."""
    first, second = lexeme(a).encode(), lexeme(b).encode()
    if length is not None and integer(length) >= 0:
        first, second = first[: integer(length)], second[: integer(length)]
    return (first > second) - (first < second)


def replace(text: Value, sought: Value, by: Value) -> Value:
    """`str-replace`."""
    letters, old, new = lexeme(text), lexeme(sought), lexeme(by)
    return _like(text, letters.replace(old, new) if old else letters)


TEXT: dict[str, LibraryFunction] = {
    "str-cat": at_least(lambda *values: _joined(values), 1),
    "sym-cat": at_least(lambda *values: Symbol(_joined(values)), 1),
    "str-length": fixed(lambda value: len(lexeme(value)), 1),
    "sub-string": fixed(part, 3),
    "str-index": fixed(index, 2),
    "upcase": fixed(upper, 1),
    "lowcase": fixed(lower, 1),
    "str-compare": LibraryFunction(compare, 2, 3),
    "str-replace": fixed(replace, 3),
}
