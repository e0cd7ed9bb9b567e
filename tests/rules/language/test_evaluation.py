"""Expressions and deffunctions: what they are worth, what stops early, and how they fail."""

import pytest

from rules.language.errors import RuleError
from rules.language.evaluation import DEEPEST_CALL, Evaluator
from rules.language.reader import read_text
from rules.language.syntax import Assert, Program
from rules.language.values import FALSE, NIL, TRUE, Symbol, Value

FUNCTIONS = """
(deffunction factorial (?n) (if (<= ?n 1) then 1 else (* ?n (factorial (- ?n 1)))))
(deffunction deep (?n) (if (= ?n 0) then 0 else (+ 1 (deep (- ?n 1)))))
(deffunction for-ever (?n) (for-ever (+ ?n 1)))
(deffunction total ($?all) (if (= (length$ ?all) 0) then 0 else (+ (nth$ 1 ?all) (total (rest$ ?all)))))
(deffunction first-of (?one $?rest) (bind ?found ?one) (if (eq ?rest (create$)) then (bind ?found alone)) ?found)
(deffunction nothing ())
(deffunction scaled (?x) (* ?x ?*scale*))
(defglobal ?*scale* = 3)
"""


def program(expression: str) -> Program:
    return read_text(f"{FUNCTIONS} (defrule r (x ?x $?m) => (assert (y {expression})))", "a.clp")


def value(expression: str, **variables: Value) -> Value:
    read = program(expression)
    (insert,) = read.rules[0].actions
    assert isinstance(insert, Assert)
    evaluator = Evaluator(
        {function.name: function for function in read.functions}, {"now": lambda: 12.5, "post": lambda *a: None}
    )
    return evaluator.compiled(insert.facts[0].fields[0])(variables, {"scale": 3})


@pytest.mark.parametrize(
    ("expression", "worth"),
    [
        ("(factorial 10)", 3628800),
        ("(total 1 2.5 3)", 6.5),
        ("(total)", 0),
        ("(first-of a b)", Symbol("a")),
        ("(first-of a)", Symbol("alone")),
        ("(nothing)", FALSE),
        ("(scaled 2)", 6),
        ("?*scale*", 3),
        ("(+ ?x 1)", 3),
        ("(length$ $?m)", 2),
        ("(and (= ?x 2) (> ?x 1) yes)", TRUE),
        ("(and (= ?x 3) (/ 1 0))", FALSE),
        ("(or (= ?x 2) (/ 1 0))", TRUE),
        ("(or FALSE (= ?x 3))", FALSE),
        ("(now)", 12.5),
        ("(post (target (id a)))", NIL),
        (f"(deep {DEEPEST_CALL - 1})", DEEPEST_CALL - 1),
    ],
)
def test_an_expression_has_its_value(expression: str, worth: Value) -> None:
    found = value(expression, x=2, m=(1, 2))
    assert (type(found), found) == (type(worth), worth)


@pytest.mark.parametrize(
    ("expression", "told"),
    [
        ("(+ 1 (/ 1 (- 2 ?x)))", "(/ ...) divides by zero"),
        ("(scaled ?m)", "(* ...) takes numbers, not a multifield ((1 2))"),
        ("(str-length ?x)", "(str-length ...) takes a symbol or a string here, not an integer (2)"),
        ("(for-ever 1)", f"(for-ever ...) calls itself more than {DEEPEST_CALL} times over"),
        ("(behaviour-select a on)", "(behaviour-select ...) is not to be had here"),
    ],
)
def test_what_has_no_value_is_told_with_its_place(expression: str, told: str) -> None:
    with pytest.raises(RuleError) as caught:
        value(expression, x=2, m=(1, 2))
    assert str(caught.value).startswith("a.clp:")
    assert str(caught.value).endswith(told)


def test_a_fault_leaves_no_depth_behind() -> None:
    read = program("(for-ever 1)")
    evaluator = Evaluator({function.name: function for function in read.functions})
    insert = read.rules[0].actions[0]
    assert isinstance(insert, Assert)
    call = evaluator.compiled(insert.facts[0].fields[0])
    for _ in range(3):
        with pytest.raises(RuleError, match="more than"):
            call({}, {})
    deep = program(f"(deep {DEEPEST_CALL - 1})").rules[0].actions[0]
    assert isinstance(deep, Assert)
    assert evaluator.compiled(deep.facts[0].fields[0])({}, {}) == DEEPEST_CALL - 1
