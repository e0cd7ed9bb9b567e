"""Texts are cut into tokens as CLIPS cuts them, and each knows where it stands."""

from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rules.language.errors import RuleError
from rules.language.reading.tokens import Token, TokenKind, tokens
from rules.language.syntax import Position
from rules.language.values import Symbol, Value, same


def cut(text: str) -> list[Token]:
    faults: list[RuleError] = []
    found = list(tokens(text, "f", faults))
    assert faults == []
    return found


@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        ("?x&~red|:(> ?x 3)", "VARIABLE SIGN SIGN CONSTANT SIGN CONSTANT OPEN CONSTANT VARIABLE CONSTANT CLOSE"),
        ("?f<-(a)", "VARIABLE CONSTANT OPEN CONSTANT CLOSE"),
        ("$?rest $? ? ?*g*", "MULTI_VARIABLE MULTI_WILDCARD WILDCARD GLOBAL"),
        ("a;b ?c\n\td", "CONSTANT CONSTANT"),
        ('"a;b"c', "CONSTANT CONSTANT"),
    ],
)
def test_kinds(text: str, kinds: str) -> None:
    assert " ".join(token.kind.name for token in cut(text)) == kinds


def test_places_count_lines_and_columns_from_1() -> None:
    found = cut('a\n  "two\nlines" b ; c\n;\n\tc')
    assert [token.position for token in found] == [Position("f", *at) for at in ((1, 1), (2, 3), (3, 8), (5, 2))]


def test_a_backslash_takes_the_next_letter_as_it_is() -> None:
    assert [token.value for token in cut(r'"a\"b\\n\n"')] == ['a"b\\nn']


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('(a "b', "f:1:4: this string is not closed: its last quotation mark is missing"),
        ("?*g", "f:1:1: '?*g' is no name of a global; write ?*name*"),
        ("?-x", "f:1:1: the name of a variable begins with a letter, not with '-'"),
        ("a \x01", "f:1:3: the character '\\x01' has no place in a rule file"),
        ("1e999", "f:1:1: the number 1e999 is out of range"),
    ],
)
def test_what_is_no_token_is_told_with_its_place(text: str, told: str) -> None:
    faults: list[RuleError] = []
    list(tokens(text, "f", faults))
    assert list(map(str, faults)) == [told]


@pytest.fixture(scope="module")
def environment() -> Any:
    return pytest.importorskip("clips").Environment()


def of_clips(value: Any) -> Value:
    return Symbol(str(value)) if type(value).__name__ == "Symbol" else value


@given(st.text("0123456789+-.eEab<=>$*/!#%_{}:,' ", max_size=12))
def test_words_are_those_of_clips(environment: Any, text: str) -> None:
    faults: list[RuleError] = []
    ours = [token.value for token in tokens(text, "f", faults)]
    assume(not faults)  # numbers beyond the range, which CLIPS bends into it
    theirs = list(map(of_clips, environment.eval(f"(create$ {text})")))
    assert len(ours) == len(theirs)
    assert all(value is not None and same(value, other) for value, other in zip(ours, theirs, strict=True)), theirs
    assert all(kind is TokenKind.CONSTANT for kind in (token.kind for token in tokens(text, "f", faults)))
