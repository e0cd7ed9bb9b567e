"""Text to tokens, as CLIPS 6.4 cuts it: symbols, strings, numbers, variables and the signs ( ) & | ~, each with its place."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum, auto

from rules.language.errors import RuleError
from rules.language.syntax import Position
from rules.language.values import Symbol

LARGEST_INTEGER = 2**63 - 1  # CLIPS keeps integers in 64 bits


class TokenKind(Enum):
    """What a token is."""

    CONSTANT = auto()
    VARIABLE = auto()  # ?x
    MULTI_VARIABLE = auto()  # $?x
    WILDCARD = auto()  # ?
    MULTI_WILDCARD = auto()  # $?
    GLOBAL = auto()  # ?*x*
    SIGN = auto()  # & | ~
    OPEN = auto()
    CLOSE = auto()


@dataclass(frozen=True, slots=True)
class Token:
    """A token: `text` is a variable's name without `?`, a sign, or the text as written; `value` is that of a constant."""

    kind: TokenKind
    text: str
    position: Position
    value: Symbol | str | int | float | None = None


# A symbol ends at a blank, a quotation mark, a bracket, one of & | ~ ;, and at < unless it begins with it.
WORD = re.compile(r'[^\s"()&|~;\x00-\x1f][^\s"()&|~;<\x00-\x1f]*')
BLANK = re.compile(r"(?:\s|;[^\n]*)+")
STRING = re.compile(r'"((?:[^"\\]|\\.)*)"', re.DOTALL)
INTEGER = re.compile(r"[+-]?\d+")
FLOAT = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
ESCAPED = re.compile(r"\\(.)", re.DOTALL)
GLOBAL_NAME = re.compile(r"\*([^*\s]+)\*")
SIGNS = {"(": TokenKind.OPEN, ")": TokenKind.CLOSE, "&": TokenKind.SIGN, "|": TokenKind.SIGN, "~": TokenKind.SIGN}


MOST_DIGITS = 1000  # of an integer, zeros before it included: more of them cost more than they say


class _Cutter:
    """Walks through a text and counts its lines."""

    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file
        self.at, self.line, self.line_start = 0, 1, 0

    def position(self) -> Position:
        return Position(self.file, self.line, self.at - self.line_start + 1)

    def step(self, end: int) -> None:
        breaks = self.text.count("\n", self.at, end)
        if breaks:
            self.line += breaks
            self.line_start = self.text.rfind("\n", self.at, end) + 1
        self.at = end


def tokens(text: str, file: str, faults: list[RuleError]) -> Iterator[Token]:
    """Yield the tokens of a text; what is none goes into `faults` and is passed over."""
    cutter = _Cutter(text, file)
    while True:
        blank = BLANK.match(text, cutter.at)
        if blank:
            cutter.step(blank.end())
        if cutter.at >= len(text):
            return
        position = cutter.position()
        try:
            token, end = _token(text, cutter.at, position)
        except RuleError as fault:
            faults.append(fault)
            end = len(text) if text[cutter.at] == '"' else _word_end(text, cutter.at)
        else:
            yield token
        cutter.step(end)


def _word_end(text: str, at: int) -> int:
    word = WORD.match(text, at)
    return word.end() if word else at + 1


def _token(text: str, at: int, position: Position) -> tuple[Token, int]:
    first = text[at]
    if first in SIGNS:
        return Token(SIGNS[first], first, position), at + 1
    if first == '"':
        string = STRING.match(text, at)
        if string is None:
            raise RuleError("this string is not closed: its last quotation mark is missing", position)
        value = ESCAPED.sub(r"\1", string[1])
        return Token(TokenKind.CONSTANT, string[0], position, value), string.end()
    word = WORD.match(text, at)
    if word is None:
        raise RuleError(f"the character {first!r} has no place in a rule file", position)
    return _of_word(word[0], position), word.end()


def _of_word(word: str, position: Position) -> Token:
    if word.startswith("$?"):
        return _variable(word[2:], position, TokenKind.MULTI_VARIABLE, TokenKind.MULTI_WILDCARD)
    if word.startswith("?*"):
        name = GLOBAL_NAME.fullmatch(word[1:])
        if name is None:
            raise RuleError(f"'{word}' is no name of a global; write ?*name*", position)
        return Token(TokenKind.GLOBAL, name[1], position)
    if word.startswith("?"):
        return _variable(word[1:], position, TokenKind.VARIABLE, TokenKind.WILDCARD)
    if word.startswith("[") and word.endswith("]") and len(word) > 2:
        raise RuleError(
            f"'{word}' is the name of an object, which rule files cannot have; write a symbol or a string", position
        )
    return Token(TokenKind.CONSTANT, word, position, constant(word, position))


def _variable(name: str, position: Position, named: TokenKind, bare: TokenKind) -> Token:
    if not name:
        return Token(bare, "", position)
    if not name[0].isalpha():
        raise RuleError(f"the name of a variable begins with a letter, not with '{name[0]}'", position)
    return Token(named, name, position)


def constant(word: str, position: Position) -> Symbol | int | float:
    """Return the integer, float or symbol that a word is."""
    if INTEGER.fullmatch(word):
        number = int(word) if len(word) <= MOST_DIGITS else LARGEST_INTEGER + 1
        if not -LARGEST_INTEGER - 1 <= number <= LARGEST_INTEGER:
            raise RuleError(f"the integer {word[:40]} is out of range (64 bits); write it as a float", position)
        return number
    if FLOAT.fullmatch(word):
        value = float(word)
        if value in (float("inf"), float("-inf")):
            raise RuleError(f"the number {word[:40]} is out of range", position)
        return value
    return Symbol(word)
