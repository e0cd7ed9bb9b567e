"""Our matching against zenoh's own, chunk by chunk and at random."""

import pytest
import zenoh
from hypothesis import given, settings
from hypothesis import strategies as st

from blackboard.errors import BoardError
from blackboard.key_expressions import check_expression, is_chunk, matches

EXPRESSION_CHUNKS = [
    "a",
    "b",
    "ab",
    "*",
    "**",
    "$*",
    "a$*",
    "$*b",
    "a$*b",
    "@a",
    "@",
    "*b",
    "a$b",
    "",
    "@*",
    "@a$*",
    "$*@",
    "#",
    "a?",
    "$*$*",
    "***",
]
KEY_CHUNKS = ["a", "b", "ab", "aab", "@a", "@", "ba", "@ab", "a@", "c"]


def zenoh_takes(expression: str) -> bool:
    try:
        zenoh.KeyExpr(expression)
    except zenoh.ZError:
        return False
    return True


def we_take(expression: str) -> bool:
    try:
        check_expression(expression)
    except BoardError:
        return False
    return True


@settings(max_examples=2000, deadline=None)
@given(
    st.lists(st.sampled_from(EXPRESSION_CHUNKS), min_size=1, max_size=5).map("/".join),
    st.lists(st.sampled_from(KEY_CHUNKS), min_size=1, max_size=5).map("/".join),
)
def test_as_zenoh_does(expression: str, key: str) -> None:
    assert we_take(expression) == zenoh_takes(expression)
    if we_take(expression):
        assert matches(expression, key) == zenoh.KeyExpr(expression).intersects(zenoh.KeyExpr(key))


@pytest.mark.parametrize(
    ("expression", "key", "holds"),
    [
        ("ski/*/observations/**", "ski/k2a/observations/signal/sonar_scan", True),
        ("ski/*/observations/**", "ski/k2a/observations", True),
        ("ski/*/observations/*", "ski/k2a/observations/signal/sonar_scan", False),
        ("**/line/*", "ski/k2a/observations/feature/line/3-0", True),
        ("**/line/3$*", "ski/k2a/observations/feature/line/3-0", True),
        ("**", "ski/@admin/x", False),
    ],
)
def test_by_hand(expression: str, key: str, holds: bool) -> None:
    assert matches(expression, key) is holds


def test_what_is_not_canonical_says_how_to_write_it() -> None:
    with pytest.raises(BoardError, match=r"'a/\*\*/\*': write '\*/\*\*' for '\*\*/\*'"):
        check_expression("a/**/*")
    with pytest.raises(BoardError, match="empty chunk"):
        check_expression("a//b")


@given(st.text(max_size=5))
def test_a_chunk_of_ours_is_a_key_for_zenoh(text: str) -> None:
    if is_chunk(text):
        assert str(zenoh.KeyExpr(text)) == text
