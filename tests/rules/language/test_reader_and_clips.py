"""What the reader lets through CLIPS takes too; and no text whatever brings the reader down."""

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import assume, event, given
from hypothesis import strategies as st

from rules.language.errors import RuleError, RuleErrors
from rules.language.reader import read_text
from rules.language.writing import written_constructs

WORDS = """
( ) ( ) & | ~ : = => <- ? $? ?x $?x ?*g* "s" " 1 -2.5e3 nil [i] \\ ä (not (exists (test (or (assert (retract (declare (salience
(bind (if then else (default (post (target (id (slot a)
"""
PIECES = [*WORDS.split(), "(defrule a", "(deftemplate t", "(deffacts d", "(x ?y)", ";c\n", "\n", "\x00"]


def faults(text: str) -> Sequence[RuleError]:
    try:
        read_text(text, "a.clp")
    except RuleErrors as refused:
        return refused.errors
    return ()


@given(st.lists(st.sampled_from(PIECES), max_size=30).map(" ".join))
def test_any_text_is_read_or_refused_with_places(text: str) -> None:
    for error in faults(text):
        assert error.position is not None
        assert str(error).startswith(f"a.clp:{error.position.line}:{error.position.column}: ")
        assert "\n" not in str(error)


def test_brackets_nested_beyond_all_reason_are_refused() -> None:
    with pytest.raises(RuleErrors, match="more than 100 deep"):
        read_text("(defrule a (test " + "(not " * 100_000)


VARIABLES = st.sampled_from(["?x", "?y", "?z"])
CONSTANTS = st.sampled_from(["a", "b", '"a"', "1", "2.5", "nil"])
EXPRESSIONS = st.recursive(
    st.one_of(VARIABLES, CONSTANTS),
    lambda inner: st.one_of(
        st.tuples(st.sampled_from(["eq", "neq", "and", "or", "str-cat", "create$"]), inner, inner),
        st.tuples(st.sampled_from(["not", "numberp", "symbolp"]), inner),
    ).map(lambda parts: f"({' '.join(parts)})"),
    max_leaves=5,
).filter(lambda text: text.startswith("("))
TERMS = st.one_of(VARIABLES, CONSTANTS, EXPRESSIONS.map(":{}".format), EXPRESSIONS.map("={}".format))
ATOMS = st.one_of(TERMS, TERMS.map("~{}".format))
FIELDS = st.one_of(
    st.sampled_from(["?", "$?", "$?m"]),
    VARIABLES,
    st.lists(st.lists(ATOMS, min_size=1, max_size=2).map("&".join), min_size=1, max_size=2).map("|".join),
)
PATTERNS = st.one_of(
    st.lists(FIELDS, max_size=3).map(lambda fields: f"(p {' '.join(fields)})"),
    st.tuples(FIELDS, FIELDS).map(lambda fields: f"(t (s {fields[0]}) (m {fields[1]}))"),
)
CONDITIONS = st.recursive(
    st.one_of(PATTERNS, PATTERNS, EXPRESSIONS.map("(test {})".format), PATTERNS.map("?f <- {}".format)),
    lambda inner: st.one_of(
        inner.map("(not {})".format),
        st.lists(inner, min_size=1, max_size=2).map(lambda all_: f"(exists {' '.join(all_)})"),
        st.lists(inner, min_size=1, max_size=2).map(lambda all_: f"(or {' '.join(all_)})"),
        st.lists(inner, min_size=1, max_size=2).map(lambda all_: f"(and {' '.join(all_)})"),
    ),
    max_leaves=4,
)
ACTIONS = st.one_of(
    st.lists(st.one_of(VARIABLES, CONSTANTS, EXPRESSIONS, st.just("$?m")), max_size=2).map(
        lambda f: f"(assert (q {' '.join(f)}))"
    ),
    st.just("(retract ?f)"),
    st.just("(modify ?f (s 1))"),
    VARIABLES.map("(bind {} 1)".format),
    st.tuples(EXPRESSIONS, VARIABLES).map(lambda two: f"(if {two[0]} then (bind {two[1]} 2) else (halt))"),
)


@pytest.fixture(scope="module")
def environment() -> Any:
    clips = pytest.importorskip("clips")

    class Silence(clips.Router):  # type: ignore[misc, name-defined]
        def __init__(self) -> None:
            super().__init__("silence", 50)

        def query(self, name: str) -> bool:
            return name in ("stdout", "stderr", "stdwrn")

        def write(self, name: str, message: str) -> None:
            made.told.append(message)

    class Environment(clips.Environment):  # type: ignore[misc, name-defined]
        told: list[str] = []  # noqa: RUF012

    made = Environment()
    made.add_router(Silence())
    return made


@given(st.lists(CONDITIONS, max_size=3), st.lists(ACTIONS, max_size=3))
def test_what_is_read_clips_takes(environment: Any, conditions: list[str], actions: list[str]) -> None:
    text = f"(deftemplate t (slot s) (multislot m)) (defrule r {' '.join(conditions)} => {' '.join(actions)})"
    try:
        program = read_text(text)
    except RuleErrors:
        assume(False)
    environment.clear()
    event("read")
    for construct, _ in written_constructs(program):
        environment.told.clear()
        try:
            environment.build(construct)
        except Exception:
            # what one pattern says of a variable rules out what another says: CLIPS refuses some such rules, which never fire
            if not any(code in "".join(environment.told) for code in ("[CSTRNCHK1]", "[RULECSTR")):
                raise
            event("can never fire")
