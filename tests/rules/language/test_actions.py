"""Right-hand sides, run against a working memory that is a dict."""

import pytest

from rules.language.actions import ActionCompiler
from rules.language.errors import RuleError
from rules.language.reader import read_text
from rules.language.values import NIL, FactAddress, FactValue, Symbol, Value


class Memory:
    """The least that actions need."""

    def __init__(self) -> None:
        self.facts = {1: FactValue("t", (1, (2, 3), "d"), ("a", "m", "d")), 2: FactValue("x", (Symbol("y"),))}
        self.globals_: dict[str, Value] = {"g": 5}
        self.printed = ""
        self.halted = False

    def assert_fact(self, fact: FactValue) -> int:
        self.facts[max(self.facts, default=0) + 1] = fact
        return max(self.facts)

    def retract(self, index: int) -> None:
        del self.facts[index]

    def modify(self, index: int, fact: FactValue) -> None:
        self.facts[index] = fact

    def fact(self, index: int) -> FactValue | None:
        return self.facts.get(index)

    def print(self, text: str) -> None:
        self.printed += text

    def halt(self) -> None:
        self.halted = True


def run(actions: str, **variables: Value) -> Memory:
    text = f"""(deftemplate t (slot a) (multislot m) (slot d (default "d"))) (defglobal ?*g* = 5)
    (defrule r ?t <- (t) ?x <- (x ?y $?rest) => {actions})"""
    program = read_text(text, "a.clp")
    memory = Memory()
    bound: dict[str, Value] = {"t": FactAddress(1), "x": FactAddress(2), "y": Symbol("y"), "rest": (7, 8), **variables}
    ActionCompiler(program, {}).actions(program.rules[0].actions)(bound, memory)
    return memory


@pytest.mark.parametrize(
    ("action", "fact"),
    [
        ("(assert (z ?y $?rest (+ 1 2)))", "(z y 7 8 3)"),
        ("(assert (z))", "(z)"),
        ("(assert (z =(+ 1 2) a))", "(z 3 a)"),
        ("(assert (t (a ?y)))", '(t (a y) (m) (d "d"))'),
        ("(assert (t (m 1 ?rest 2)))", '(t (a nil) (m 1 7 8 2) (d "d"))'),
        ("(assert (t (m)))", '(t (a nil) (m) (d "d"))'),
        ("(bind ?y 1 ?rest) (assert (z ?y))", "(z 1 7 8)"),
        ("(bind ?*g* (+ ?*g* 1)) (assert (z ?*g*))", "(z 6)"),
        ("(if (eq ?y y) then (assert (z yes)) else (assert (z no)))", "(z yes)"),
        ("(if (eq ?y n) then (assert (z yes)) else (assert (z no)))", "(z no)"),
    ],
)
def test_what_is_asserted(action: str, fact: str) -> None:
    assert str(run(action).facts[3]) == fact


def test_retract_and_modify() -> None:
    assert list(run("(retract ?t ?x)").facts) == []
    assert list(run("(retract ?t) (retract ?t) (modify ?t (a 2))").facts) == [2]
    memory = run("(modify ?t (a (+ 1 1)) (m 9))")
    assert str(memory.facts[1]) == '(t (a 2) (m 9) (d "d"))'


def test_a_modify_that_changes_nothing_does_nothing() -> None:
    class Watched(Memory):
        def modify(self, index: int, fact: FactValue) -> None:
            raise AssertionError("modified")

    program = read_text("(deftemplate t (slot a) (multislot m) (slot d)) (defrule r ?t <- (t) => (modify ?t (a 1)))")
    ActionCompiler(program, {}).actions(program.rules[0].actions)({"t": FactAddress(1)}, Watched())


def test_print_and_halt() -> None:
    memory = run('(printout t "a b" tab ?y " " 1.0 " " $?rest (str-cat x 0.1) crlf) (halt)')
    assert memory.printed == "a b\ty 1.0 (7 8)x0.1\n"
    assert memory.halted


@pytest.mark.parametrize(
    ("action", "told"),
    [
        ("(assert (t (a ?rest)))", "the slot 'a' holds one value, not the multifield (7 8)"),
        ("(modify ?t (a ?rest))", "the slot 'a' holds one value, not the multifield (7 8)"),
        ("(assert (z (/ 1 0)))", "(/ ...) divides by zero"),
    ],
)
def test_what_cannot_be_done_is_told_with_its_place(action: str, told: str) -> None:
    with pytest.raises(RuleError) as caught:
        run(action)
    assert str(caught.value).startswith("a.clp:2:")
    assert str(caught.value).endswith(told)


def test_an_external_that_returns_nothing_returns_nil() -> None:
    program = read_text("(defrule r (x) => (bind ?r (focus a 1)) (assert (z ?r)))")
    memory = Memory()
    ActionCompiler(program, {"focus": lambda *arguments: None}).actions(program.rules[0].actions)({}, memory)
    assert memory.facts[3].fields == (NIL,)
