"""What is written reads as the same program, and CLIPS takes it."""

from dataclasses import fields, is_dataclass, replace
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rules.language.errors import RuleErrors
from rules.language.reader import read_text
from rules.language.syntax import Position, Program, Slot, Template
from rules.language.writing import program_text, rule_text, written_constructs

NOWHERE = Position("", 1, 1)
BOARD = (Template("target", (Slot("id"), Slot("x-m"), Slot("seen", multi=True))),)

EVERYTHING = r"""
(deftemplate door "a door \"to\" a room" (slot id (default d-1)) (slot width-m (default 0.8)) (multislot rooms (default a b)) (multislot seen))
(defglobal ?*wide* = (twice 0.5) ?*name* = "a \\ b" ?*row* = (create$ 1 x "y"))
(deffunction twice (?x) (* 2 ?x))
(deffunction even-by-odd (?n) (if (= ?n 0) then TRUE else (odd-by-even (- ?n 1))))
(deffunction odd-by-even "the other" (?n) (bind ?m (- ?n 1)) (if (= ?n 0) then FALSE else (even-by-odd ?m)))
(deffunction count ($?all) (length$ $?all))
(deffacts start "at first" (a 1 -2.5 "text" word nil 1e+20) (door (id d-2) (rooms) (seen 1 2)) (b))
(defrule first "says (much)" (declare (salience -5))
  ?f <- (door (id ?i&~d-1|d-3) (width-m ?w&:(> ?w ?*wide*)&~2.0) (rooms $? a))
  (a ?x $?rest) (a ?x&~3&=(+ ?w 1)|~:(> ?x 1) ?)
  (test (or (eq ?x ?i) (not (even-by-odd 4))))
  (not (c ?x ?)) (exists (b ?y) (test (neq ?y ?x)))
  (not (and (c ?x ?q) (not (d ?q)) (exists (or (e ?q) (test (> ?q ?x))))))
  (or (d ?z) (and (e ?z) (not (f))))
  =>
  (retract ?f) (modify ?f (id ?z) (rooms a b) (seen))
  (bind ?n (+ ?x 1) 2) (bind ?*wide* ?n)
  (if (> ?x 1) then (halt) else (printout t "x" ?x crlf) (assert (g ?x $?rest) (door (seen ?x 1) (id a))))
  (if (> ?x 1) then (assert (h)))
  (behaviour-select target-nav ON ?x) (post (target (id ?z) (x-m (* 2 ?x)) (seen 1 2))) (assert (i (now))))
(defrule second (target (id ?t)) => )
(defrule third => (printout t "always"))
"""  # noqa: E501


def without_places(value: Any) -> Any:
    """The same with every position the same."""
    if isinstance(value, Position):
        return NOWHERE
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{field.name: without_places(getattr(value, field.name)) for field in fields(value)})
    return tuple(map(without_places, value)) if isinstance(value, tuple) else value


def ordered(program: Program) -> Any:
    """Without places, and globals and functions by name: they are written in the order in which they need each other."""
    plain = without_places(program)
    by_name = {"globals": plain.globals, "functions": plain.functions}
    return replace(plain, **{kind: tuple(sorted(all_, key=lambda one: one.name)) for kind, all_ in by_name.items()})


def reread(program: Program) -> Program:
    text = program_text(replace(program, templates=tuple(t for t in program.templates if t not in BOARD)))
    # a function that is declared before it is defined stands there twice, the first time without a body
    constructs = [text for text, _ in written_constructs(program) if not text.startswith("(deftemplate target")]
    assert text == "\n\n".join(constructs) + "\n"
    defined = {text.split()[1]: text for text in constructs if text.startswith("(deffunction")}
    kept = [c for c in constructs if not c.startswith("(deffunction") or c == defined[c.split()[1]]]
    return read_text("\n".join(kept), templates=BOARD)


def test_everything_reads_back_as_it_was() -> None:
    program = read_text(EVERYTHING, templates=BOARD)
    assert ordered(reread(program)) == ordered(program)


def test_a_rule_text_is_the_same_for_the_same_rule_only() -> None:
    texts = ["(defrule a (x ?y) => (z ?y))", "(defrule a ; why\n (x ?y)\n=>\n  (z ?y))", "(defrule a (x ?y) => (z  1))"]
    function = "(deffunction z (?y) ?y)"
    one, same, other = (rule_text(read_text(text + function).rules[0]) for text in texts)
    assert one == same != other


def test_clips_takes_what_is_written_in_its_order() -> None:
    clips = pytest.importorskip("clips")
    environment = clips.Environment()
    for name in ("now", "post", "behaviour-select"):
        environment.define_function(lambda *arguments: 1, name)
    names = {name: f"python-function {name}" for name in ("now", "post", "behaviour-select")}
    for text, _ in written_constructs(read_text(EVERYTHING, templates=BOARD), names):
        environment.build(text)
    assert [rule.name for rule in environment.rules() if not rule.name.startswith("first")] == ["second", "third"]
    environment.reset()
    assert environment.eval("(odd-by-even 7)") == "TRUE"
    assert environment.eval("?*wide*") == 1.0


WORDS = st.sampled_from(["a", "b-c", "nil", "TRUE", "<=", "x1", "d.e", "$y", "+", "été"])
CONSTANTS = st.one_of(
    WORDS,
    st.integers(-(2**63), 2**63 - 1).map(str),
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.text('ab "\\(;\n?ä', max_size=6).map(lambda text: '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'),
)
CALLS = st.recursive(
    st.one_of(CONSTANTS, st.just("?x")),
    lambda inner: st.tuples(st.sampled_from(["neq", "str-cat", "and", "eq"]), inner, inner).map(
        lambda parts: f"({' '.join(parts)})"
    ),
    max_leaves=6,
).filter(lambda text: text.startswith("(") and not text.startswith('"'))
TERMS = st.one_of(CONSTANTS, st.just("?x"), CALLS.map(lambda call: f":{call}"), CALLS.map(lambda call: f"={call}"))
ATOMS = st.tuples(st.sampled_from(["", "~"]), TERMS).map("".join)
CONSTRAINTS = st.lists(st.lists(ATOMS, min_size=1, max_size=3).map("&".join), min_size=1, max_size=3).map("|".join)


@given(st.lists(CONSTRAINTS, max_size=4), st.lists(CALLS, max_size=3), st.sampled_from(["", "?v&", "$?r&"]))
def test_any_pattern_and_action_reads_back_as_it_was(patterns: list[str], calls: list[str], binds: str) -> None:
    fields_ = " ".join(patterns) if patterns else "z"
    text = f"(defrule r (x ?x) (p {binds}{fields_}) => {' '.join(calls)})"
    try:
        program = read_text(text)
    except RuleErrors as refused:
        assume(not all("can never match" in str(error) for error in refused.errors))
        raise
    assert ordered(reread(program)) == ordered(program)
