"""The planning module after a restart: it decides as if nothing had happened, and what happened meanwhile it makes up for."""

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from blackboard.kinds import COMMUNICATION_ERROR, FACT, FIRING, FOCUS, MISSION, MOTIVATION, RULE_ERROR, TARGET
from blackboard.messages.control import Fact
from blackboard.messages.motion import Motivation

BenchOf = Callable[..., Any]

COUNTING = """
(deftemplate count (slot of) (slot n (default 0)))
(deffacts beginning (mode watch) (count (of seen)))
(defrule see (target (id ?t)) => (assert (seen ?t)))
(defrule count-it ?new <- (seen ?t) ?count <- (count (of seen) (n ?n)) => (retract ?new) (modify ?count (n (+ ?n 1))))
(defrule none-left (mode watch) (not (target)) => (assert (none-left)))
(defrule some-again ?none <- (none-left) (target) => (retract ?none))
(defrule go (target (id ?t) (place-x-m ?x)) (test (> ?x 5.0)) => (behaviour-select target_nav on ?x 0.0))
"""


@pytest.fixture(params=["experta", "clips"])
def engine(request: pytest.FixtureRequest) -> str:
    if request.param == "clips":
        pytest.importorskip("clips")
    return str(request.param)


def fired(bench: Any) -> dict[str, int]:
    return {entry.value.rule: entry.revision for entry in bench.board.entries(FIRING)}


def test_what_has_fired_does_not_fire_again(bench_of: BenchOf, engine: str) -> None:
    bench = bench_of(COUNTING, engine=engine)
    bench.target("a")
    bench.target("b", 7.0)
    bench.cycle()
    before, facts = fired(bench), sorted(bench.facts())
    bench.restart(bench.kept())
    bench.cycle()
    assert fired(bench) == before
    assert sorted(bench.facts()) == facts
    assert "(count (of seen) (n 2))" in facts


def test_without_a_kept_state_only_the_newest_firing_may_come_once_more(bench_of: BenchOf, engine: str) -> None:
    bench = bench_of("(defrule a (target (id x)) => (assert (a)))", "(defrule b (a) => (assert (b)))", engine=engine)
    bench.target("x")
    bench.cycle()
    bench.restart(None)
    bench.cycle()
    assert fired(bench) == {"a": 1, "b": 2}
    assert sorted(bench.facts()) == ["(a)", "(b)"]


@pytest.mark.parametrize("keeps", [True, False])
def test_deffacts_are_not_asserted_twice(bench_of: BenchOf, keeps: bool) -> None:
    bench = bench_of("(deffacts once (token)) (defrule take ?t <- (token) => (retract ?t) (assert (taken)))")
    bench.cycle()
    bench.restart(bench.kept() if keeps else None)
    bench.cycle()
    assert bench.facts() == ["(taken)"]
    assert fired(bench) == {"take": 1}


def test_where_nothing_had_begun_it_begins_as_ever(bench_of: BenchOf) -> None:
    bench = bench_of("(deffacts once (token))")
    bench.restart(bench.kept())
    bench.cycle()
    assert bench.facts() == ["(token)"]


def test_what_came_and_went_meanwhile_is_made_up_for(bench_of: BenchOf, engine: str) -> None:
    bench = bench_of(COUNTING, engine=engine)
    bench.target("a")
    bench.cycle()
    kept = bench.kept()
    bench.board.retract(TARGET, "a", source="frontier_targets")  # no cycle: nobody decides
    bench.restart(kept)
    bench.cycle()
    assert "(none-left)" in bench.facts()
    kept = bench.kept()
    bench.target("c", 9.0)
    bench.restart(kept)
    bench.cycle()
    assert "(none-left)" not in bench.facts()
    assert bench.motivation("target_nav") == Motivation(on=True, number=1, parameters=(9.0, 0.0))


def test_what_fired_after_the_state_was_kept_is_done_at_least_once(bench_of: BenchOf, engine: str) -> None:
    bench = bench_of(COUNTING, engine=engine)
    bench.cycle()
    kept = bench.kept()
    for name in ("a", "b", "c"):
        bench.target(name)
        bench.cycle()
    bench.restart(kept)
    bench.cycle()
    assert bench.facts()[-1] in [f"(count (of seen) (n {n}))" for n in (3, 4, 5)]  # c is not counted twice
    assert "(none-left)" not in bench.facts()


def test_motivations_are_numbered_on(bench_of: BenchOf) -> None:
    bench = bench_of(COUNTING)
    bench.target("a", 6.0)
    bench.cycle()
    kept = bench.kept()
    bench.target("a", 7.0)
    bench.cycle()
    for keeps in (kept, None):
        number = bench.motivation("target_nav").number
        bench.restart(keeps)
        bench.target("a", 8.0 + number)
        bench.cycle()
        assert bench.motivation("target_nav").number > number


def test_a_number_that_was_acknowledged_but_does_not_stand_is_not_given_again(bench_of: BenchOf) -> None:
    bench = bench_of(COUNTING)
    bench.acknowledge("target_nav", 41)
    bench.target("a")
    bench.cycle()
    bench.restart(None)
    bench.target("a", 8.0)
    bench.cycle()
    assert bench.motivation("target_nav").number == 42


def test_whoever_owes_an_acknowledgement_has_time_for_it_once_more(bench_of: BenchOf) -> None:
    bench = bench_of(COUNTING, acknowledge_s=0.5)
    bench.target("a", 6.0)
    bench.cycle()
    kept = bench.kept()
    bench.board.now_s += 60.0  # nobody decided for a minute
    bench.restart(kept)
    bench.cycle(0.1)
    assert bench.board.entries(COMMUNICATION_ERROR) == []
    bench.cycle(0.6)
    assert [entry.id for entry in bench.board.entries(COMMUNICATION_ERROR)] == ["target_nav"]
    bench.restart(bench.kept())
    bench.cycle()
    assert [entry.id for entry in bench.board.entries(COMMUNICATION_ERROR)] == ["target_nav"]
    bench.acknowledge("target_nav", 1)
    bench.cycle()
    assert bench.board.entries(COMMUNICATION_ERROR) == []


def test_an_acknowledgement_that_came_meanwhile_counts(bench_of: BenchOf) -> None:
    bench = bench_of(COUNTING, acknowledge_s=0.5)
    bench.target("a", 6.0)
    bench.cycle()
    kept = bench.kept()
    bench.acknowledge("target_nav", 1)
    bench.restart(kept)
    bench.cycle(5.0)
    assert bench.board.entries(COMMUNICATION_ERROR) == []


def test_globals_keep_their_values(bench_of: BenchOf, engine: str) -> None:
    text = """
    (defglobal ?*n* = 0)
    (defrule up (target (id ?t)) => (bind ?*n* (+ ?*n* 1)) (assert (up ?t ?*n*)))
    """
    bench = bench_of(text, engine=engine)
    bench.target("a")
    bench.cycle()
    bench.restart(bench.kept())
    bench.target("b")
    bench.cycle()
    assert bench.facts() == ["(up a 1)", "(up b 2)"]


def test_what_rules_have_posted_they_may_still_retract(bench_of: BenchOf) -> None:
    text = """
    (defrule begin (target (id a)) => (post (mission (state underway) (detail "looking"))))
    (defrule end ?m <- (mission (detail "looking")) (target (id b)) => (retract-entry ?m))
    """
    bench = bench_of(text)
    bench.target("a")
    bench.cycle()
    bench.restart(None)
    bench.target("b")
    bench.cycle()
    assert bench.board.newest(MISSION) is None
    assert bench.board.entries(RULE_ERROR) == []


def test_focus_and_motivation_stay_as_they_stand(bench_of: BenchOf) -> None:
    bench = bench_of("(defrule f (target) => (focus line_finder 30) (behaviour-select random_wander on))")
    bench.target("a")
    bench.cycle()
    bench.restart(bench.kept())
    bench.cycle(5.0)
    assert [entry.revision for entry in bench.board.entries(FOCUS)] == [1]
    assert [entry.revision for entry in bench.board.entries(MOTIVATION)] == [1]


def test_a_fact_that_cannot_be_read_back_is_told(bench_of: BenchOf) -> None:
    bench = bench_of("(deffacts some (a) (b))")
    bench.cycle()
    bench.board.post(FACT, Fact(relation="b", fact="(b ((("), id="2", source="rules")
    bench.restart(None)
    bench.cycle()
    assert bench.facts() == ["(a)"]
    (fault,) = bench.board.entries(RULE_ERROR)
    assert "could not be read back and is lost: (b (((" in fault.value.text


def test_a_changed_rule_looks_afresh_after_a_restart_too(bench_of: BenchOf) -> None:
    bench = bench_of("(defrule see (target (id ?t)) => (assert (seen ?t)))")
    bench.target("a")
    bench.cycle()
    kept = bench.kept()
    bench.paths[0].write_text("(defrule see (target (id ?t)) => (assert (looked-at ?t)))", encoding="utf-8")
    bench.restart(kept)
    bench.cycle()
    assert sorted(bench.facts()) == ["(looked-at a)", "(seen a)"]


Step = tuple[str, str, float]
STEPS = st.lists(
    st.tuples(
        st.sampled_from(("post", "retract", "cycle", "cycle")), st.sampled_from("abc"), st.sampled_from((1.0, 6.0, 8.0))
    ),
    max_size=14,
)


@given(before=STEPS, after=STEPS)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_restart_from_what_was_kept_just_now_changes_nothing(
    bench_of: BenchOf, before: list[Step], after: list[Step]
) -> None:
    lived, died = bench_of(COUNTING, reload_s=0.0), bench_of(COUNTING, reload_s=0.0)
    for bench in (lived, died):
        run(bench, [*before, ("cycle", "a", 1.0)])
    died.restart(died.kept())
    for bench in (lived, died):
        run(bench, [*after, ("cycle", "a", 1.0)])
    assert sorted(died.facts()) == sorted(lived.facts())
    assert fired(died) == fired(lived)
    assert died.motivation("target_nav") == lived.motivation("target_nav")


def run(bench: Any, steps: list[Step]) -> None:
    for what, name, x_m in steps:
        if what == "post":
            bench.target(name, x_m)
        elif what == "cycle":
            bench.cycle()
        elif bench.board.newest(TARGET, name) is not None:
            bench.board.retract(TARGET, name, source="frontier_targets")
