"""The planning module on a board: entries become facts, rules fire, and what they ask for stands on the board."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from blackboard.component import Parts
from blackboard.errors import SkiError
from blackboard.kinds import COMMUNICATION_ERROR, FACT, FOCUS, MISSION, MOTIVATION, RULE_ERROR, RULES, SWITCH, TARGET
from blackboard.messages.motion import Motivation, Switch
from blackboard.messages.symbols import Target

BenchOf = Callable[..., Any]

# Bou-Ghannam 1992, appendix A1.2, with what it speaks of: the scan at the tenth position is over, a frontier was found there.
THESIS = """
(deffacts situation
  (mode end-wander-scan)
  (position-index 10)
  (position-index 10 frontier-center 3.5 1.25))

(defrule active-target
    ?mode <- (mode end-wander-scan)
    (position-index ?num)
    ?f <- (position-index ?num frontier-center ?xt ?yt)
    =>
    (retract ?mode ?f)
    (assert (target ?xt ?yt))
    (behavior-select "target-nav" "ON" ?xt ?yt) )
"""


def test_the_rule_of_the_thesis_runs_as_printed(bench_of: BenchOf) -> None:
    bench = bench_of(THESIS)
    bench.cycle()
    assert bench.motivation("target_nav") == Motivation(on=True, number=1, parameters=(3.5, 1.25))
    assert bench.facts() == ["(position-index 10)", "(target 3.5 1.25)"]
    firing = bench.firing("active-target")
    assert firing.value.facts == (
        "(mode end-wander-scan)",
        "(position-index 10)",
        "(position-index 10 frontier-center 3.5 1.25)",
    )
    assert {support.key for support in firing.supports} == {f"ski/k2a/control/fact/{index}" for index in (1, 2, 3)}
    rules = bench.board.newest(RULES)
    assert rules is not None
    known = bench.board.newest(FACT, "2")  # what deffacts say stands on the rule files themselves
    assert known is not None
    assert known.supports == (rules.as_support(),)
    motivation = bench.board.newest(MOTIVATION, "target_nav")
    assert motivation is not None
    assert motivation.supports == (firing.as_support(),)


@pytest.mark.parametrize("engine", ["experta", "clips"])
def test_both_engines_do_the_same(bench_of: BenchOf, engine: str) -> None:
    if engine == "clips":
        pytest.importorskip("clips")
    bench = bench_of(THESIS, engine=engine)
    bench.cycle()
    assert bench.motivation("target_nav") == Motivation(on=True, number=1, parameters=(3.5, 1.25))
    assert bench.facts() == ["(position-index 10)", "(target 3.5 1.25)"]


def test_a_missing_acknowledgement_becomes_a_fact_until_it_comes(bench_of: BenchOf) -> None:
    silent = "(defrule silent (communication-error (id ?b) (number ?n)) => (assert (silent ?b ?n)))"
    bench = bench_of(THESIS, silent, acknowledge_s=0.5)
    bench.cycle()
    bench.cycle(0.4)
    assert bench.board.entries(COMMUNICATION_ERROR) == []
    bench.cycle(0.2)
    error = bench.board.newest(COMMUNICATION_ERROR, "target_nav")
    assert error is not None
    assert error.value.waited_s == pytest.approx(0.6)
    assert "(silent target_nav 1)" in bench.facts()
    bench.acknowledge("target_nav", 1)
    bench.cycle()
    assert bench.board.entries(COMMUNICATION_ERROR) == []


def test_an_acknowledgement_in_time_is_no_error(bench_of: BenchOf) -> None:
    bench = bench_of(THESIS, acknowledge_s=0.5)
    bench.cycle()
    bench.acknowledge("target_nav", 1)
    bench.cycle(2.0)
    assert bench.board.entries(COMMUNICATION_ERROR) == []


def test_nobody_is_blamed_for_silence_after_the_mission(bench_of: BenchOf) -> None:
    bench = bench_of(
        THESIS, "(defrule end (declare (salience 100)) => (post (mission (state done))))", acknowledge_s=0.5
    )
    bench.cycle()
    assert bench.board.newest(MISSION) is not None
    bench.cycle(2.0)
    assert bench.board.entries(COMMUNICATION_ERROR) == []


COUNT = """
(defrule see (target (id ?t) (place-x-m ?x)) => (assert (seen ?t ?x)))
(defrule lose ?seen <- (seen ?t ?) (not (target (id ?t))) => (retract ?seen))
"""


def test_only_a_change_of_what_rules_look_at_is_news(bench_of: BenchOf) -> None:
    bench = bench_of(COUNT)
    first = bench.target("frontier-1")
    bench.cycle()
    assert bench.facts() == ["(seen frontier-1 1.0)"]
    assert bench.firing("see").supports == (first.as_support(),)
    other = replace_size(first.value)
    bench.board.post(TARGET, other, id="frontier-1", source="frontier_targets")  # a slot that no rule mentions
    bench.cycle()
    assert bench.firing("see").revision == 1
    bench.target("frontier-1", 2.0)
    bench.cycle()
    assert bench.firing("see").revision == 2
    bench.board.retract(TARGET, "frontier-1", source="frontier_targets")
    bench.cycle()
    assert bench.facts() == []


def replace_size(target: Target) -> Target:
    return Target(place=target.place, stand=target.stand, reason=target.reason, size_m=9.0)


def test_why_goes_from_a_fact_through_its_firing_to_the_entry(bench_of: BenchOf) -> None:
    bench = bench_of(COUNT, "(defrule go (seen ?t ?x) => (behaviour-select target-nav on ?x 0))")
    target = bench.target("frontier-1", 3.0)
    bench.cycle()
    go = bench.firing("go")
    [fact] = bench.board.entries(FACT)
    assert go.supports == (fact.as_support(),)
    assert fact.supports == (bench.firing("see").as_support(),)
    assert bench.firing("see").supports == (target.as_support(),)


def test_what_a_rule_raises_is_told_and_the_others_go_on(bench_of: BenchOf) -> None:
    bench = bench_of(
        "(deffacts start (a 0) (b))"
        "(defrule divide (declare (salience 1)) (a ?x) => (assert (before)) (assert (c (/ 1 ?x))) (assert (after)))"
        "(defrule other (b) => (assert (fine)))"
        "(defrule mend (rule-error (rule ?r)) => (assert (mended ?r)))",
    )
    bench.cycle()
    error = bench.board.newest(RULE_ERROR, "divide")
    assert error is not None
    assert "zero" in error.value.text
    assert {"(before)", "(fine)", "(mended divide)"} <= set(bench.facts())
    assert "(after)" not in bench.facts()


@pytest.mark.parametrize(
    "condition", ["(a ?x) (test (> ?x 0))", "(a ?x&:(> ?x 0))", "(z) (a ?x) (not (z ?y&:(> ?x 0)))"]
)
def test_a_condition_that_cannot_be_evaluated_is_told(bench_of: BenchOf, condition: str) -> None:
    rules = (
        "(deffacts start (a x) (z) (z 1))\n"
        "(defrule first (a x) => (assert (b)))\n"
        f"(defrule more {condition} => (assert (big ?x)))"
    )
    bench = bench_of(rules)
    bench.cycle()
    assert "(big x)" not in bench.facts()
    [error] = bench.board.entries(RULE_ERROR)
    assert error.id == "more"
    assert error.value.text.startswith("rules0.clp:3:")
    assert error.value.text.endswith("(> ...) takes numbers, not a symbol (x)")
    bench.target("frontier-1")
    bench.cycle()
    assert bench.board.entries(RULE_ERROR) == [error]  # told once


def test_an_endless_loop_is_cut_off_and_told(bench_of: BenchOf) -> None:
    loop = "(deffacts start (n 0)) (defrule loop ?n <- (n ?x) => (retract ?n) (assert (n (+ ?x 1))))"
    bench = bench_of(loop, firings_per_cycle=50)
    bench.cycle()
    assert bench.facts() == ["(n 50)"]
    error = bench.board.newest(RULE_ERROR, "loop")
    assert error is not None
    assert "50 rules fired in one cycle" in error.value.text
    bench.cycle()
    assert bench.facts() == ["(n 100)"]  # and the robot lives on


def test_halt_ends_the_cycle_only(bench_of: BenchOf) -> None:
    rules = """
    (deffacts start (go))
    (defrule stop (declare (salience 1)) (go) => (halt))
    (defrule later (go) => (assert (went)))"""
    bench = bench_of(rules)
    bench.cycle()
    assert bench.facts() == ["(go)"]
    bench.target("frontier-1")
    bench.cycle()
    assert bench.facts() == ["(go)", "(went)"]


def act(bench_of: BenchOf, *actions: str) -> Any:
    bench = bench_of(f"(defrule act (target (id ?t)) => {' '.join(actions)})")
    for name in ("target_nav", "explore"):
        bench.board.post(SWITCH, Switch(threshold=0.2), id=name, source="rules")
    bench.target("frontier-1")
    bench.cycle()
    return bench


def test_rules_set_switches_and_ratings(bench_of: BenchOf) -> None:
    bench = act(bench_of, "(set-gain target-nav 0.5)", "(set-threshold explore 1)", "(focus line-finder 55)")
    nav, level, focus = (
        bench.board.newest(SWITCH, "target_nav"),
        bench.board.newest(SWITCH, "explore"),
        bench.board.newest(FOCUS, "line_finder"),
    )
    assert nav is not None
    assert nav.value == Switch(gain=0.5, threshold=0.2)
    assert level is not None
    assert level.value.threshold == 1.0
    assert focus is not None
    assert (focus.value.rating, focus.value.enabled) == (55.0, True)


def test_a_source_can_be_put_to_rest_and_keeps_its_rating(bench_of: BenchOf) -> None:
    bench = act(bench_of, "(focus line_finder off)")
    focus = bench.board.newest(FOCUS, "line_finder")
    assert focus is not None
    assert (focus.value.rating, focus.value.enabled) == (10.0, False)


def test_rules_post_and_take_back_what_they_posted(bench_of: BenchOf) -> None:
    bench = act(bench_of, '(post (mission (state given-up) (detail "enough")))')
    mission = bench.board.newest(MISSION)
    assert mission is not None
    assert (mission.value.state, mission.value.detail) == ("given up", "enough")
    bench = act(
        bench_of,
        "(post (target (id own) (place-x-m 1) (place-y-m 2) (stand-x-m 1) (stand-y-m 2) (reason frontier) (size-m 1)))",
        "(retract-entry ski/k2a/hypotheses/symbol/target/own)",
    )
    assert bench.board.newest(TARGET, "own") is None
    errors = [entry.value.text for entry in bench.board.entries(RULE_ERROR)]
    assert errors == [
        "retract-entry: no rule has posted 'ski/k2a/hypotheses/symbol/target/own'; only its owner may retract an entry"
    ]


def test_motivate_prepares_what_select_uses(bench_of: BenchOf) -> None:
    bench = act(bench_of, "(motivate target-nav 4 5)")
    assert bench.motivation("target_nav") is None
    bench = act(bench_of, "(motivate target-nav 4 5)", "(behaviour-select target-nav on)")
    assert bench.motivation("target_nav") == Motivation(on=True, number=1, parameters=(4.0, 5.0))
    bench = act(bench_of, "(behaviour-select target-nav on 1 2)", "(motivate target-nav 4 5)")
    assert bench.motivation("target_nav") == Motivation(on=True, number=2, parameters=(4.0, 5.0))


def test_motivate_reaches_a_behaviour_that_was_selected_from_the_start(bench_of: BenchOf) -> None:
    bench = bench_of("(defrule act (target) => (motivate target-nav 4 5))")
    bench.acknowledge("target_nav", 0)  # its status: selected, nothing asked for yet
    bench.target("frontier-1")
    bench.cycle()
    assert bench.motivation("target_nav") == Motivation(on=True, number=1, parameters=(4.0, 5.0))


@pytest.mark.parametrize(
    ("action", "says"),
    [
        ("(behaviour-select ?t on)", "this mission has no behaviour 'frontier-1'"),
        ("(bind ?b target-nav) (behaviour-select ?b on 1)", "behaviour 'target_nav' takes x_m y_m; 1 were given"),
        ("(bind ?s perhaps) (behaviour-select target-nav ?s 1 2)", "perhaps must be on or off"),
        ("(bind ?g -1) (set-gain target-nav ?g)", "set-gain target-nav: -1 must be a number in [0, 100]"),
        ("(focus ?t 3)", "this mission has no knowledge source 'frontier-1'"),
        ("(retract-entry ?t)", "no rule has posted 'frontier-1'"),
    ],
)
def test_what_cannot_be_done_is_told_in_one_line(bench_of: BenchOf, action: str, says: str) -> None:
    bench = act(bench_of, action)
    [error] = bench.board.entries(RULE_ERROR)
    assert says in error.value.text
    assert "\n" not in error.value.text


def test_a_kind_with_an_owner_is_not_posted_by_rules(bench_of: BenchOf, parts: Parts) -> None:
    owned = replace(parts, owners={"hypotheses/feature/route": "routes"})
    with pytest.raises(SkiError, match=r"rules0.clp:1:31: post: 'route' is posted by routes already; only one may"):
        bench_of(
            "(defrule r (target (id ?)) => (post (route (state none) (goal-x-m 1) (goal-y-m 1))))",
            parts=owned,
        )


def test_rules_that_ask_for_the_time_are_told_it(bench_of: BenchOf) -> None:
    bench = bench_of("(defrule late (clock (time-s ?t&:(>= ?t 2))) => (assert (late)))", clock_s=1.0)
    for _ in range(15):
        bench.cycle()
    assert bench.facts() == []
    for _ in range(10):
        bench.cycle()
    assert bench.facts() == ["(late)"]
