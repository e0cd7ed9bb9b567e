"""Both engines: what had to be mended on experta, and what both must do alike, each with a program of its own."""

import logging
from collections.abc import Callable, Iterator

import pytest

from rules.engines.engine import Activation, Engine, External, Firing
from rules.engines.factory import ENGINES, make_engine
from rules.language.errors import RuleError
from rules.language.reader import read_text
from rules.language.values import FactValue, Symbol, Value

Start = Callable[..., Engine]


@pytest.fixture(params=ENGINES)
def started(request: pytest.FixtureRequest) -> Iterator[Start]:
    """Return what starts a program on an engine; each test runs on both."""
    if request.param == "clips":
        pytest.importorskip("clips")
    made: list[Engine] = []

    def start(text: str, **externals: External) -> Engine:
        made.append(make_engine(request.param, read_text(text), externals))
        made[-1].reset()
        return made[-1]

    yield start
    for engine in made:
        engine.close()


def fact(relation: str, *fields: Value) -> FactValue:
    return FactValue(relation, fields)


def run(engine: Engine) -> list[Firing]:
    fired = []
    while (firing := engine.fire()) is not None:
        fired.append(firing)
        assert len(fired) < 100
    return fired


def names(engine: Engine) -> list[str]:
    return [activation.rule for activation in engine.agenda()]


def standing(engine: Engine) -> list[str]:
    return [str(one) for one in engine.facts().values()]


def test_an_engine_that_there_is_not_is_told() -> None:
    with pytest.raises(RuleError, match="no rule engine 'expert'; did you mean 'experta'"):
        make_engine("expert", read_text(""))


def test_importing_experta_leaves_nothing_behind() -> None:
    import collections

    from rules.engines import experta_import

    assert experta_import.KnowledgeEngine
    assert not hasattr(collections, "Mapping")
    assert not [one for one in logging.getLogger().handlers if type(one) is logging.StreamHandler]


def test_one_fact_and_the_next_activation_are_those_of_the_whole(started: Start) -> None:
    engine = started("(defrule any (a ?x) =>) (defrule urgent (declare (salience 5)) (a 1) =>)")
    assert engine.waiting() is None
    indices = [engine.assert_fact(fact("a", number)) for number in (1, 2)]
    assert {index: engine.fact(index) for index in indices if index is not None} == dict(engine.facts())
    assert engine.fact(99) is None
    while (waiting := engine.waiting()) is not None:
        assert waiting == engine.agenda()[0]
        fired = engine.fire()
        assert fired is not None
        assert fired.activation == waiting


def test_order_is_salience_then_newest_then_definition(started: Start) -> None:
    engine = started(
        """
        (defrule first (a ?) =>)
        (defrule second (a ?) =>)
        (defrule urgent (declare (salience 5)) (a ?) =>)
        """
    )
    engine.assert_fact(fact("a", 1))
    engine.assert_fact(fact("a", 2))
    assert [(one.rule, one.facts) for one in engine.agenda()] == [
        ("urgent", (2,)),
        ("urgent", (1,)),
        ("first", (2,)),
        ("second", (2,)),
        ("first", (1,)),
        ("second", (1,)),
    ]


def test_no_activation_outlives_its_facts(started: Start) -> None:
    engine = started("(defrule pair (a ?x) (b ?x) =>) (defrule alone (a ?x) (not (b ?x)) =>)")
    a = engine.assert_fact(fact("a", 1))
    assert names(engine) == ["alone"]
    b = engine.assert_fact(fact("b", 1))
    assert names(engine) == ["pair"]
    assert b is not None
    engine.retract(b)
    assert names(engine) == ["alone"]
    assert a is not None
    engine.retract(a)
    assert names(engine) == []
    with pytest.raises(KeyError):
        engine.retract(a)


def test_asserted_and_retracted_in_one_right_hand_side(started: Start) -> None:
    engine = started("(defrule go ?f <- (go) => (assert (done)) (retract ?f) (assert (go)) (retract ?f))")
    engine.assert_fact(fact("go"))
    assert engine.fire() is not None
    assert standing(engine) == ["(done)", "(go)"]


@pytest.mark.parametrize("fields", [(), (1, 2), (1, 2, 3)])
def test_ordered_facts_match_patterns_of_their_length_only(started: Start, fields: tuple[Value, ...]) -> None:
    engine = started("(defrule one (a ?x) =>) (defrule more (a ?x ?y $?) =>)")
    engine.assert_fact(fact("a", *fields))
    assert names(engine) == (["more"] if len(fields) >= 2 else [])


def test_values_of_different_kinds_differ(started: Start) -> None:
    engine = started("(defrule one (a 1) =>) (defrule word (a red) =>) (defrule same (a ?x) (b ?x) =>)")
    for value in (1.0, "red", Symbol("one")):
        engine.assert_fact(fact("a", value))
    for value in (1, Symbol("red"), "one"):
        engine.assert_fact(fact("b", value))
    assert names(engine) == []
    engine.assert_fact(fact("b", "red"))
    assert names(engine) == ["same"]


def test_two_equal_patterns_match_every_pair(started: Start) -> None:
    engine = started("(defrule pair (a ?x) (a ?y) =>)")
    engine.assert_fact(fact("a", 1))
    engine.assert_fact(fact("a", 2))
    assert sorted(one.facts for one in engine.agenda()) == [(1, 1), (1, 2), (2, 1), (2, 2)]


def test_a_variable_that_must_differ(started: Start) -> None:
    engine = started("(defrule other (a ?x) (b ~?x) =>) (defrule within (c ?x ~?x) =>)")
    for one in (fact("a", 1), fact("b", 1), fact("b", 2), fact("c", 1, 1), fact("c", 1, 2)):
        engine.assert_fact(one)
    assert [(one.rule, one.facts) for one in engine.agenda()] == [("within", (5,)), ("other", (1, 3))]


def test_a_rule_that_begins_with_a_test_or_has_no_condition(started: Start) -> None:
    engine = started("(defrule always =>) (defrule sure (test (> 2 1)) =>) (defrule never (test (> 1 2)) =>)")
    assert names(engine) == ["always", "sure"]


def test_not_and_exists_look_at_outer_variables_and_tests(started: Start) -> None:
    engine = started(
        """
        (defrule largest (a ?x) (not (a ?y&:(> ?y ?x))) =>)
        (defrule covered (a ?x) (exists (b ?y) (c ?y ?z&:(> ?z ?x))) =>)
        """
    )
    for one in (fact("a", 1), fact("a", 2), fact("b", 7), fact("c", 7, 2)):
        engine.assert_fact(one)
    assert sorted((one.rule, one.facts) for one in engine.agenda()) == [
        ("covered", (1, None)),
        ("largest", (2, None)),
    ]
    engine.retract(3)
    assert [(one.rule, one.facts) for one in engine.agenda()] == [("largest", (2, None))]


def test_the_facts_of_an_activation_are_told_condition_by_condition(started: Start) -> None:
    engine = started(
        """
        (defrule late (test (> 2 1)) (not (c ?)) (or (a ?x) (exists (b ?) (b 2))) (test (> 3 2)) (not (and (c ?) (d ?))) (e) =>)
        """
    )
    for one in (fact("a", 1), fact("b", 2), fact("e")):
        engine.assert_fact(one)
    assert {one.facts for one in engine.agenda()} == {(None, 1, None, 3), (None, None, None, 3)}


def test_or_is_a_rule_for_each_way(started: Start) -> None:
    engine = started("(defrule either (or (a ?x) (b ?x)) (not (c ?x)) (not (d ?x)) =>)")
    for one in (fact("a", 1), fact("b", 1), fact("b", 2), fact("d", 2)):
        engine.assert_fact(one)
    assert sorted(one.facts for one in engine.agenda()) == [(1, None, None), (2, None, None)]


def test_a_multifield_takes_what_the_other_fields_leave(started: Start) -> None:
    engine = started("(defrule tail (a ?first $?rest ?last) => (assert (rest (length$ ?rest) ?last)))")
    engine.assert_fact(fact("a", 1))
    engine.assert_fact(fact("a", 1, 2, 3, 4))
    run(engine)
    assert standing(engine)[2:] == ["(rest 2 4)"]


def test_modify_keeps_the_index_and_fires_anew(started: Start) -> None:
    engine = started("(deftemplate p (slot x)) (defrule up ?f <- (p (x ?x&:(< ?x 3))) => (modify ?f (x (+ ?x 1))))")
    engine.assert_fact(FactValue("p", (1,), ("x",)))
    fired = run(engine)
    assert len(fired) == 2
    assert engine.facts() == {1: FactValue("p", (3,), ("x",))}
    assert [(one.index, str(one.fact), one.asserted) for one in fired[0].changes] == [
        (1, "(p (x 1))", False),
        (1, "(p (x 2))", True),
    ]


def test_a_fact_that_stands_is_not_asserted_again(started: Start) -> None:
    engine = started("(defrule seen (a ?) =>)")
    assert engine.assert_fact(fact("a", 1)) == 1
    assert engine.assert_fact(fact("a", 1)) is None
    assert engine.assert_fact(fact("a", 1.0)) == 2
    assert engine.assert_fact(fact("a", "1")) == 3


def test_what_an_action_raises_ends_that_firing_only(started: Start) -> None:
    def motivate(name: Value) -> Value:
        raise ValueError("no sensor")

    engine = started(
        """
        (defrule first (a) => (assert (before)) (motivate wander) (assert (after)))
        (defrule second (declare (salience -1)) (word ?w) => (if (> ?w 1) then (assert (large))))
        (defrule third (declare (salience -2)) (before) => (printout t "on" crlf))
        """,
        motivate=motivate,
    )
    engine.assert_fact(fact("a"))
    engine.assert_fact(fact("word", Symbol("red")))
    first, second, third = run(engine)
    assert first.error == "ValueError: no sensor"
    assert [str(one.fact) for one in first.changes] == ["(before)"]
    assert second.error is not None
    assert third.printed == "on\n"
    assert third.error is None


def test_halt_and_resume(started: Start) -> None:
    engine = started("(defrule stop (a ?) => (halt))")
    engine.assert_fact(fact("a", 1))
    engine.assert_fact(fact("a", 2))
    assert len(run(engine)) == 1
    assert engine.halted
    engine.resume()
    assert len(run(engine)) == 1


def test_one_activation_of_the_agenda_fires_or_is_dropped(started: Start) -> None:
    engine = started("(defrule seen (a ?x) => (printout t ?x))")
    for number in range(3):
        engine.assert_fact(fact("a", number))
    last = engine.agenda()[-1]
    assert last == Activation("seen", (1,))
    fired = engine.fire(last)
    assert fired is not None
    assert fired.printed == "0"
    engine.drop(Activation("seen", (3,)))
    assert [one.facts for one in engine.agenda()] == [(2,)]
    with pytest.raises(KeyError):
        engine.drop(last)


def test_reset_brings_back_globals_and_deffacts(started: Start) -> None:
    engine = started(
        "(defglobal ?*n* = 1) (deffacts start (a ?*n*)) (defrule more (a ?x) => (bind ?*n* 5) (assert (b ?*n*)))"
    )
    run(engine)
    assert engine.globals() == {"n": 5}
    assert standing(engine) == ["(a 1)", "(b 5)"]
    engine.reset()
    assert engine.globals() == {"n": 1}
    assert standing(engine) == ["(a 1)"]
    assert names(engine) == ["more"]
    with pytest.raises(KeyError):
        engine.set_global("m", 1)
