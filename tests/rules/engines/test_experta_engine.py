"""The engine on experta: what a change costs, counted in calls, and what an engine leaves behind."""

import gc
import sys
import weakref
from collections.abc import Callable
from types import FrameType

from rules.engines.experta_engine import ExpertaEngine
from rules.language.reader import read_text
from rules.language.values import FactValue, Symbol

RULES = """
(deftemplate way (slot id) (slot length-m))
(defrule joined (goal ?id) (way (id ?id) (length-m ?length)) (not (given-up ?id)) => (assert (near ?length)))
(defrule constant (way (id w3) (length-m ?length)) (test (> ?length 100.0)) => (assert (far w3)))
(defrule gone (goal ?id) (not (way (id ?id))) => (assert (lost ?id)))
(defrule given (exists (given-up ?id) (way (id ?id))) => (assert (some)))
"""


def way(number: int, length_m: float) -> FactValue:
    return FactValue("way", (Symbol(f"w{number}"), length_m), ("id", "length-m"))


def calls(action: Callable[[], object]) -> int:
    """Return how many functions an action calls."""
    number = 0

    def count(frame: FrameType, event: str, argument: object) -> None:
        nonlocal number
        number += event in ("call", "c_call")

    gc.collect()
    gc.disable()  # what earlier tests have left must not be cleared away, and counted, now
    sys.setprofile(count)
    try:
        action()
    finally:
        sys.setprofile(None)
        gc.enable()
    return number


def cost_of_a_change(ways: int) -> int:
    engine = ExpertaEngine(read_text(RULES))
    engine.reset()
    for number in range(ways):
        engine.assert_fact(way(number, 1.0))
        engine.assert_fact(FactValue("given-up", (Symbol(f"w{number + 5}"),)))
    engine.assert_fact(FactValue("goal", (Symbol("w3"),)))
    while engine.fire():
        pass

    def change() -> None:
        engine.retract(7)
        assert engine.assert_fact(way(3, 2.0)) is not None
        fired = [engine.fire() for _ in range(2)]
        assert [None if one is None else one.activation.rule for one in fired] == ["joined", None]

    assert str(engine.facts()[7]) == "(way (id w3) (length-m 1.0))"
    return calls(change)


def test_a_change_costs_the_same_however_many_facts_stand() -> None:
    few, many = cost_of_a_change(20), cost_of_a_change(400)
    assert few < 400
    assert abs(many - few) <= 0.1 * few  # a look at every fact would cost hundreds more


def test_nothing_is_left_of_an_engine_that_is_let_go() -> None:
    engine = ExpertaEngine(read_text(RULES))
    engine.reset()
    for number in range(5):
        engine.assert_fact(way(number, 1.0))
    network = weakref.ref(engine._base.matcher.network)
    engine.close()
    assert engine.facts() == {}
    del engine
    gc.collect()
    assert network() is None


def test_nothing_is_left_of_a_fact_that_is_retracted() -> None:
    engine = ExpertaEngine(read_text(RULES))
    engine.reset()
    engine.assert_fact(FactValue("goal", (Symbol("w3"),)))
    index = engine.assert_fact(way(3, 1.0))
    assert index is not None
    fact = weakref.ref(engine._base.facts[index])
    engine.retract(index)
    gc.collect()
    assert fact() is None
