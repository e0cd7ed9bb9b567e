"""Rules whose order is left to chance, and rules that never end; and those that only look so."""

import pytest

from blackboard.vocabulary import Vocabulary
from rules.checks.endless import endless_findings
from rules.checks.order import order_findings
from rules.language.reader import read_text
from rules.language.templates import planning_templates

TEMPLATES = planning_templates(Vocabulary())
START = "(deffacts start (mode go)) (deftemplate plan (slot a) (slot b))"


def order(text: str) -> list[str]:
    return [str(finding) for finding in order_findings(read_text(START + text, "a.clp", TEMPLATES))]


def endless(text: str) -> list[str]:
    return [str(finding) for finding in endless_findings(read_text(START + text, "a.clp", TEMPLATES))]


def test_two_rules_that_want_the_same_fact_with_the_same_salience_are_told() -> None:
    (told,) = order(
        "(defrule a ?m <- (mode go) (x) => (retract ?m) (assert (mode one)))\n"
        "(defrule b ?m <- (mode go) (y) => (retract ?m) (assert (mode two)))"
    )
    assert told == (
        "a.clp:2:1: warning: 'b' and 'a' can match at once with the same salience and take the same (mode ...): "
        "the order is left to chance; (declare (salience ...)) settles it"
    )


def test_all_rivals_of_a_rule_are_told_together() -> None:
    rule = "(defrule {} ?m <- (mode go) ({}) => (retract ?m) (assert (mode {})))\n"
    first, second = order("".join(rule.format(name, name, name) for name in ("a", "b", "c")))
    assert "'b' and 'a' can match" in first
    assert "'c' and 'a' and 'b' can match" in second


def test_two_rules_that_set_the_same_thing_differently_are_told() -> None:
    (told,) = order("(defrule a (x) => (set-gain avoid 1)) (defrule b (y) => (set-gain avoid 2))")
    assert (
        "'b' and 'a' can match at once with the same salience and say different things by (set-gain avoid ...)" in told
    )
    select = (
        "(defrule a (x) => (behaviour-select follow_wall on)) (defrule b (y) => (behaviour-select follow-wall off))"
    )
    assert len(order(select)) == 1


CLEAR = {
    "another salience": "(defrule a (declare (salience 1)) ?m <- (mode go) (x) => (retract ?m) (assert (mode one)))"
    "(defrule b ?m <- (mode go) (y) => (retract ?m) (assert (mode two)))",
    "they do the same": "(defrule a ?m <- (mode go) (x) => (retract ?m) (assert (mode one)))"
    "(defrule b ?now <- (mode go) (y) => (retract ?now) (assert (mode one)))",
    "other constants": "(defrule a ?m <- (mode go) => (retract ?m) (assert (mode one)))"
    "(defrule b ?m <- (mode stay) => (retract ?m) (assert (mode two)))",
    "one asks for what the other rules out": "(defrule a ?f <- (plan (a ?x)) (not (tried ?x)) => (retract ?f))"
    "(defrule b ?f <- (plan (a ?y)) (tried ?y) => (retract ?f) (assert (done ?y)))",
    "exists and not": "(defrule a ?m <- (mode go) (exists (x ?)) => (retract ?m) (assert (mode one)))"
    "(defrule b ?m <- (mode go) (not (x ?)) => (retract ?m) (assert (mode two)))",
    "ranges": "(defrule a ?f <- (plan (a ?x&:(> ?x 5))) => (retract ?f) (assert (high)))"
    "(defrule b ?f <- (plan (a ?y)) (test (<= ?y 5)) => (retract ?f) (assert (low)))",
    "opposite tests": "(defrule a ?f <- (plan (a ?x) (b ?y&:(< ?y ?x))) => (retract ?f) (assert (high)))"
    "(defrule b ?f <- (plan (a ?p) (b ?q&:(>= ?q ?p))) => (retract ?f) (assert (low)))",
    "one entry of the board": "(defrule a ?m <- (mode go) (behaviour (id c) (outcome reached)) => (retract ?m) (assert (mode x)))"
    "(defrule b ?m <- (mode go) (behaviour (id c) (outcome blocked)) => (retract ?m) (assert (mode y)))",
    "one slot of the board": "(defrule a ?m <- (mode go) (battery (charge-fraction ?c&:(< ?c 0.2))) => (retract ?m))"
    "(defrule b ?m <- (mode go) (battery (charge-fraction ?c&:(> ?c 0.3))) => (retract ?m) (assert (mode y)))",
    "one mode at a time": "(defrule a (mode go) => (set-gain avoid 1)) (defrule b (mode stay) => (set-gain avoid 2))"
    "(defrule c ?m <- (mode go) => (retract ?m) (assert (mode stay)))",
    "other slots": "(defrule a ?f <- (plan) (x) => (modify ?f (a 1))) (defrule b ?f <- (plan) (y) => (modify ?f (b 1)))",
}  # fmt: skip


@pytest.mark.parametrize("why", CLEAR)
def test_rules_that_exclude_each_other_or_agree_need_no_order(why: str) -> None:
    assert order(CLEAR[why]) == []


NEVER_ENDING = {
    "counting": "(defrule a ?f <- (count ?n) => (retract ?f) (assert (count (+ ?n 1))))",
    "adding": "(defrule a (count ?n) => (assert (count (+ ?n 1))))",
    "modifying": "(defrule a ?f <- (plan (a ?n)) => (modify ?f (a (+ ?n 1))))",
    "the same again": "(defrule a ?f <- (plan (a 1)) (mode go) => (retract ?f) (assert (plan (a 1) (b 2))))",
}
UNDOING = {
    "to and fro": "(defrule a ?f <- (light off) => (retract ?f) (assert (light on)))"
    "(defrule b ?f <- (light on) => (retract ?f) (assert (light off)))",
    "with what both need": "(defrule a (mode go) ?f <- (light off ?l) => (retract ?f) (assert (light on ?l)))"
    "(defrule b ?f <- (light on ?l) (mode ?) => (retract ?f) (assert (light off ?l)))",
    "there and gone": "(defrule a (x ?y) (not (light on)) => (assert (light on)))"
    "(defrule b ?f <- (light on) (x ?) => (retract ?f))",
}
ENDING = {
    "a bound": "(defrule a ?f <- (count ?n&:(< ?n 5)) => (retract ?f) (assert (count (+ ?n 1))))",
    "another fact is used up": "(defrule a ?f <- (count ?n) ?g <- (tick) => (retract ?f ?g) (assert (count (+ ?n 1))))",
    "a slot that is tested": "(defrule a ?f <- (plan (a ?n) (b ?n)) => (modify ?f (a (+ ?n 1))))",
    "the value stays": "(defrule a ?f <- (plan (a ?n)) => (modify ?f (a 1)))",
    "halt": "(defrule a ?f <- (count ?n) => (retract ?f) (assert (count (+ ?n 1))) (halt))",
    "only if": "(defrule a ?f <- (count ?n) => (retract ?f) (if (< ?n 3) then (assert (count (+ ?n 1)))))",
    "not": "(defrule a (count ?n) (not (count 3)) => (assert (count (+ ?n 1))))",
    "other conditions": "(defrule a ?f <- (light off) (button) => (retract ?f) (assert (light on)))"
    "(defrule b ?f <- (light on) (no-button) => (retract ?f) (assert (light off)))",
    "hysteresis": "(defrule a ?f <- (light off) (v ?v&:(< ?v 2)) => (retract ?f) (assert (light on)))"
    "(defrule b ?f <- (light on) (v ?v&:(> ?v 5)) => (retract ?f) (assert (light off)))",
    "only once": "(defrule a (x) => (assert (y))) (defrule b (y) => (assert (x)))",
}


@pytest.mark.parametrize("why", NEVER_ENDING)
def test_a_rule_that_never_ends_is_told(why: str) -> None:
    (told,) = endless(NEVER_ENDING[why])
    assert told.startswith("a.clp:1:64: warning: 'a' makes its own conditions true again each time it fires")


@pytest.mark.parametrize("why", UNDOING)
def test_two_rules_that_undo_each_other_are_told(why: str) -> None:
    (told,) = endless(UNDOING[why])
    assert "'b' and 'a' undo each other without end" in told


@pytest.mark.parametrize("why", ENDING)
def test_rules_that_come_to_an_end_are_not_told(why: str) -> None:
    assert endless(ENDING[why]) == []
