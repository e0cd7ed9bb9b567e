"""Every function gives what CLIPS gives, for all kinds of arguments, or fails where CLIPS fails."""

import math
from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rules.language.errors import RuleError
from rules.language.evaluation import evaluate
from rules.language.functions import FUNCTIONS, STOP_EARLY
from rules.language.syntax import Call, Constant, Expression, Position
from rules.language.values import Symbol, Value, same, written

clips = pytest.importorskip("clips")
HERE = Position("here", 1, 1)
FAILED = object()


class _Silence(clips.Router):  # type: ignore[misc]
    """Takes what CLIPS writes about faults."""

    def __init__(self) -> None:
        super().__init__("silence", 50)

    def query(self, name: str) -> bool:
        return name in ("stdout", "stderr", "stdwrn")

    def write(self, name: str, message: str) -> None:
        pass


@pytest.fixture(scope="module")
def environment() -> Any:
    made = clips.Environment()
    made.add_router(_Silence())
    return made


def of_clips(value: Any) -> Value:
    if isinstance(value, clips.Symbol):
        return Symbol(str(value))
    return tuple(map(of_clips, value)) if isinstance(value, tuple) else value


def in_clips(environment: Any, function: str, arguments: Sequence[Value]) -> Any:
    try:
        value = environment.eval(f"({' '.join([function, *map(expression, arguments)])})")
    except clips.CLIPSError:
        environment.clear_error_state()
        return FAILED
    return FAILED if value is None else of_clips(value)  # insert$ at a place 0 writes a fault and returns nothing


def here(function: str, arguments: Sequence[Value]) -> Any:
    try:
        return evaluate(Call(function, tuple(map(constant, arguments)), HERE), {}, {})
    except RuleError as error:
        return FAILED if str(error).startswith(f"here:1:1: ({function} ...) ") else error


def expression(value: Value) -> str:
    return f"(create$ {' '.join(map(written, value))})" if isinstance(value, tuple) else written(value)


def constant(value: Value) -> Expression:
    return Constant(value, HERE)


def agree(a: Any, b: Any) -> bool:
    """The same value; a float of a mathematical function may differ in its last places, by the library under it."""
    if isinstance(a, float) and isinstance(b, float):
        return a == b or (math.isnan(a) and math.isnan(b)) or math.isclose(a, b, rel_tol=1e-14, abs_tol=1e-300)
    return a is b if FAILED in (a, b) else same(a, b)


WHOLE = st.one_of(st.integers(-6, 6), st.integers(-(2**63), 2**63 - 1))
FLOATS = st.one_of(
    st.sampled_from(
        [0.0, 0.5, -0.5, 1.0, -1.0, 2.5, -2.5, 1e300, 1e-300, -1e-300, 1e-25, -1e-26, math.pi / 2, math.pi]
    ),
    st.floats(-100, 100),
)
WORDS = st.sampled_from([Symbol(word) for word in ("a", "b", "nil", "TRUE", "FALSE", "aB")])
STRINGS = st.text("abßAB c", max_size=5)
SINGLE = st.one_of(WHOLE, FLOATS, WORDS, STRINGS)
ROWS = st.lists(st.one_of(st.integers(0, 2), WORDS, st.sampled_from([1.0, "a"])), max_size=4).map(tuple)
NUMBERS = st.one_of(WHOLE, FLOATS)
ANY = st.one_of(SINGLE, ROWS)
LEXEMES = st.one_of(WORDS, STRINGS)
SHAPES = {  # what most examples of a function are made of, so that few of them fail at once
    "sub-string": [st.integers(-2, 7), st.integers(-2, 7), LEXEMES],
    "str-compare": [LEXEMES, LEXEMES, st.integers(-1, 4)],
    "nth$": [st.integers(-1, 5), ROWS],
    "member$": [st.one_of(SINGLE, ROWS), ROWS],
    "subseq$": [ROWS, st.integers(-1, 5), st.integers(-1, 5)],
    "delete$": [ROWS, st.integers(-1, 5), st.integers(-1, 5)],
    "replace$": [ROWS, st.integers(-1, 5), st.integers(-1, 5), ANY],
    "insert$": [ROWS, st.integers(-1, 5), ANY],
    "delete-member$": [ROWS, st.one_of(WORDS, st.integers(0, 2), ROWS), st.one_of(WORDS, ROWS)],
}
OF_ROWS = ("subsetp", "union$", "intersection$", "difference$", "length$", "first$", "rest$")
OF_LEXEMES = ("str-length", "str-index", "upcase", "lowcase", "str-replace")
OF_ANY = ("eq", "neq", "not", "and", "or", "create$", "str-cat", "sym-cat")


@st.composite
def calls(draw: st.DrawFn, function: str) -> tuple[Value, ...]:
    if draw(st.integers(0, 9)) == 0 or function in OF_ANY or function.endswith("p"):
        kind: st.SearchStrategy[Any] = ANY
    elif function in SHAPES:
        least = FUNCTIONS[function].least
        shape = SHAPES[function]
        return tuple(draw(one) for one in shape[: draw(st.integers(least, len(shape)))])
    elif function in OF_ROWS:
        kind = ROWS
    else:
        kind = LEXEMES if function in OF_LEXEMES else NUMBERS
    least, most = (
        STOP_EARLY[function] if function in STOP_EARLY else (FUNCTIONS[function].least, FUNCTIONS[function].most)
    )
    return tuple(draw(st.lists(kind, min_size=least, max_size=least + 2 if most is None else most)))


@pytest.mark.parametrize("function", [*FUNCTIONS, *STOP_EARLY])
@settings(max_examples=settings.default.max_examples // 5)  # for each of ninety functions
@given(data=st.data())
def test_a_function_gives_what_it_gives_in_clips(environment: Any, function: str, data: st.DataObject) -> None:
    arguments = data.draw(calls(function))
    ours, theirs = here(function, arguments), in_clips(environment, function, arguments)
    assert agree(ours, theirs), f"({function} {' '.join(map(expression, arguments))}): {ours!r}, in CLIPS {theirs!r}"


@pytest.mark.parametrize("function", ["eq", "neq", "=", "member$"])
def test_the_two_zeros_are_told_apart_as_in_clips(environment: Any, function: str) -> None:
    pairs = [(0.0, -0.0), (-0.0, -0.0), (0, 0.0), (0.0, 0.0)]
    for a, b in [(a, (b,)) for a, b in pairs] if function == "member$" else pairs:
        assert agree(here(function, (a, b)), in_clips(environment, function, (a, b)))
