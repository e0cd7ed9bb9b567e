"""Which condition keeps a rule from firing, worked by hand."""

import pytest

from rules.explaining.why_not import Verdict, why_not
from rules.language.actions import ActionCompiler
from rules.language.reader import read_text
from rules.language.values import FactValue

HEAD = """(defglobal ?*near-m* = 5.0)
(deftemplate target (slot id) (slot size-m) (multislot tags))
(deftemplate travel (slot id) (slot state) (slot length-m))
"""


def facts_of(text: str) -> dict[int, FactValue]:
    program = read_text(f"{HEAD}(deffacts now {text})", "facts.clp")
    compiler = ActionCompiler(program, {})
    forms = program.deffacts[0].facts if program.deffacts else ()
    return {i: compiler.fact(form)({}, {}) for i, form in enumerate(forms, 1)}


def asked(conditions: str, facts: str) -> Verdict:
    program = read_text(f"{HEAD}(defrule go\n  {conditions}\n  => (assert (gone)))", "explore.clp")
    return why_not(program, program.rules[0], facts_of(facts))


def stopped(conditions: str, facts: str) -> tuple[int, str, tuple[str, ...]]:
    verdict = asked(conditions, facts)
    assert verdict.obstacle is not None
    return verdict.obstacle.number, verdict.obstacle.verdict, verdict.obstacle.reasons


def test_it_could_fire() -> None:
    verdict = asked("(target (id ?t)) (travel (id ?t) (length-m ?l&:(< ?l ?*near-m*)))",
                    "(target (id a)) (target (id b)) (travel (id b) (length-m 3.5))")  # fmt: skip
    assert verdict.obstacle is None
    assert [way.facts for way in verdict.ways] == [(2, 3)]
    assert str(verdict.ways[0].bindings["t"]) == "b"


def test_no_fact_of_that_relation_at_all() -> None:
    verdict = asked("(mode choose) (target (id ?t))", "(mode choose)")
    obstacle = verdict.obstacle
    assert obstacle is not None
    assert (obstacle.number, obstacle.total, obstacle.text) == (2, 2, "(target (id ?t))")
    assert str(obstacle.position) == "explore.clp:5:17"
    assert obstacle.reasons == ("there is no fact (target ...) at all",)
    assert obstacle.best.facts == (1,)


def test_the_nearest_facts_and_what_is_different() -> None:
    number, verdict, reasons = stopped(
        "(target (id ?t)) (travel (id ?t) (state reachable) (length-m ?l&:(< ?l ?*near-m*)))",
        "(target (id a)) (travel (id a) (state reachable) (length-m 7.5)) (travel (id b) (state unreachable) (length-m 1))",
    )
    assert (number, verdict) == (2, "no fact matches it")
    assert reasons == (
        "(travel (id a) (state reachable) (length-m 7.5)): length-m is 7.5, wanted ?l&:(< ?l ?*near-m*) (where ?*near-m* is 5.0)",
        "(travel (id b) (state unreachable) (length-m 1)): id is b, wanted ?t (where ?t is a), "
        "state is unreachable, wanted reachable",
    )


def test_the_way_that_leads_farthest_is_told() -> None:
    number, _, reasons = stopped(
        "(mode ?m) (uses ?m ?b) (behaviour ?b idle)", "(mode go) (mode rest) (uses go path) (behaviour path active)"
    )
    assert number == 3  # (mode rest) ends at the second
    assert reasons == ("(behaviour path active): field 2 is active, wanted idle",)


def test_a_test_and_its_values() -> None:
    assert stopped("(at ?x) (test (> ?x ?*near-m*))", "(at 1) (at 2.5)") == (
        2,
        "it is FALSE",
        ("FALSE: (> ?x ?*near-m*) with ?x = 1", "FALSE: (> ?x ?*near-m*) with ?x = 2.5"),
    )
    assert stopped("(at ?x) (test (> ?x 1))", "(at nowhere)")[2] == ("FALSE: (> ?x 1) with ?x = nowhere",)


def test_not_and_what_violates_it() -> None:
    number, verdict, reasons = stopped(
        "(target (id ?t)) (not (given-up ?t))", "(target (id a)) (given-up a) (given-up b)"
    )
    assert (number, verdict, reasons) == (2, "what must not be is so", ("there is (given-up a)",))
    assert asked("(target (id ?t)) (not (given-up ?t))", "(target (id a)) (given-up b)").ways


def test_not_of_several_conditions() -> None:
    where = "(mode go) (not (and (target (id ?t)) (not (given-up ?t))))"  # every target was given up
    facts = "(mode go) (target (id a)) (target (id b)) (given-up a)"
    assert stopped(where, facts) == (2, "what must not be is so", ("there is (target (id b) (size-m nil) (tags))",))
    assert asked(where, facts + "(given-up b)").ways
    assert stopped("(mode ?m) (not (test (eq ?m go)))", "(mode go)")[2] == ("what it excludes holds",)


def test_exists_over_several_patterns() -> None:
    where = "(exists (target (id ?t)) (travel (id ?t) (length-m ?l)) (test (< ?l 5)))"
    assert stopped(where, "(target (id a)) (travel (id a) (length-m 9))") == (
        1,
        "nothing like that exists",
        ("FALSE: (< ?l 5) with ?l = 9",),
    )
    assert asked(where, "(target (id a)) (travel (id a) (length-m 4))").ways[0].facts == (None,)


def test_or_tells_of_the_branch_that_leads_farther() -> None:
    where = "(or (battery low) (and (mode go) (bumper ?)))"
    assert stopped(where, "(mode go)")[2] == ("there is no fact (bumper ...) at all",)
    assert len(asked(where, "(battery low) (mode go) (bumper left)").ways) == 2


@pytest.mark.parametrize(
    ("condition", "facts", "fires"),
    [
        ("(a ~b|c)", "(a b)", False),
        ("(a ?x&~b&~c)", "(a d)", True),
        ("(a ?x) (b ~?x)", "(a 1) (b 1)", False),
        ("(a ?x) (b ~?x)", "(a 1) (b 1.0)", True),  # eq keeps integers and floats apart
        ("(a ?x) (b =(+ ?x 1))", "(a 1) (b 2)", True),
        ("(a ?first $?rest)", "(a 1 2 3)", True),
        ("(a $?before last)", "(a 1 2 last)", True),
        ("(a ?first ?second $?)", "(a 1)", False),
        ("(target (tags $? big))", "(target (id a) (tags red big))", True),
        ("(target (tags red))", "(target (id a) (tags red big))", False),
        ('(a "b")', "(a b)", False),
    ],
)  # fmt: skip
def test_fields(condition: str, facts: str, fires: bool) -> None:
    assert bool(asked(condition, facts).ways) is fires
