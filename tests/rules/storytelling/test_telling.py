"""Stories told to an engine: what happens in a step, and how a difference is told."""

import json
from pathlib import Path

import pytest

from blackboard.command.main import main
from rules.storytelling.telling import Outcome, tell

RULES = """(deftemplate goal (slot target) (slot x-m))
(deffacts beginning (mode choose) (hurries path_following))
(defrule choose
  ?mode <- (mode choose)
  (travel (id ?t) (state reachable) (length-m ?l))
  (not (travel (length-m ?m&:(< ?m ?l))))
  =>
  (retract ?mode)
  (assert (mode go) (goal (target ?t) (x-m ?l)))
  (behaviour-select path_following on ?l 0.5))
(defrule arrived
  ?goal <- (goal (target ?t))
  (motivation (id path_following) (number ?n))
  (behaviour (id path_following) (acknowledged ?n) (outcome reached))
  =>
  (printout t "arrived at " ?t crlf)
  (retract ?goal))
(defrule late
  (clock (time-s ?s&:(> ?s 50.0)))
  (goal)
  (hurries ?behaviour)
  =>
  (behaviour-select ?behaviour on 1.0))
"""
FIRST = """files = "rules.clp"

[[step]]
say = "two targets"
at_s = 1
entries = [
  "(travel (id a) (state reachable) (length-m 4.0))",
  "(travel (id b) (state reachable) (length-m 2.5))",
]
"""


def told(folder: Path, text: str, engine: str = "experta") -> Outcome:
    (folder / "rules.clp").write_text(RULES)
    path = folder / "story.toml"
    path.write_text(text)
    return tell(path, engine)


@pytest.mark.parametrize("engine", ["experta", "clips"])
def test_a_story_as_told(tmp_path: Path, engine: str) -> None:
    if engine == "clips":
        pytest.importorskip("clips")
    text = (
        FIRST
        + """expect = ["(mode go)", "(goal (target b) (x-m ?x&:(< ?x 3)))", "(travel (id a) (length-m 4.0))"]
expect_not = ["(mode choose)", "(goal (target a))"]
motivations = "path-following on 2.5 0.5"
does = "select path_following on*"
does_not = "post*"
fires = "choose"
fires_not = "arrived"

[[step]]
at_s = 9
entries = "(behaviour (id path_following) (outcome reached))"
expect_not = "(goal)"
prints = "arrived at b"
"""
    )
    outcome = told(tmp_path, text, engine)
    assert outcome.failures == ()
    assert [seen.fired for _, seen in outcome.played] == [["choose"], ["arrived"]]
    assert outcome.story.steps[0].expectations == 10


def test_the_difference_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (
        FIRST
        + """expect = ["(goal (target a))", "(done)"]
expect_not = "(mode go)"
motivations = ["path_following on 4.0 0.5", "curiosity off"]
does = "post mission*"
fires = "arrived"
prints = "well"

[[step]]
expect = "(never told)"
"""
    )
    assert told(tmp_path, text).failures
    path = tmp_path / "story.toml"
    assert main(["rules", "test", str(path)]) == 1
    assert capsys.readouterr().out.splitlines() == [
        f"{path}:3: story: step 1, two targets",
        "  line 10: expected  a fact (goal (target a))",
        "           found     (goal (target b)): target is b, wanted a",
        "  line 10: expected  a fact (done)",
        "           found     no fact (done ...) at all",
        "  line 11: expected  no fact (mode go)",
        "           found     (mode go)",
        "  line 12: expected  motivation path_following on 4.0 0.5",
        "           found     path_following on 2.5 0.5",
        "  line 12: expected  motivation curiosity off",
        "           found     curiosity was never asked for anything",
        "  line 13: expected  rules do: post mission*",
        "           found     select path_following on with 2.5, 0.5",
        "  line 14: expected  rule arrived fires",
        "           found     fired: choose",
        "  line 15: expected  printed: well",
        "           found     nothing was printed",
        "  rules that fired in this step: choose",
        "0 of 1 stories are as told",
    ]


def test_errors_of_rules_fail_a_story_unless_they_are_expected(tmp_path: Path) -> None:
    late = "\n[[step]]\nat_s = 60\n"
    (failure,) = told(tmp_path, FIRST + late).failures
    assert failure.line == 11
    assert "takes x_m y_m" in failure.found[0]
    assert told(tmp_path, FIRST + late + 'errors = "late: *takes x_m y_m*"\n').failures == ()


def test_facts_by_hand(tmp_path: Path) -> None:
    text = (
        FIRST
        + """
[[step]]
modify = "(goal (target b)) (x-m 7.0) (target c)"
retract = "(mode ?)"
assert = ["(mode rest)", '(note "a word" 1 2.5)']
expect = ["(goal (target c) (x-m 7.0))", "(mode rest)", '(note "a word" 1 2.5)']
expect_not = ["(goal (target b))", "(mode go)"]
"""
    )
    assert told(tmp_path, text).failures == ()


def test_an_entry_keeps_what_is_not_told_anew_until_it_is_gone(tmp_path: Path) -> None:
    text = (
        FIRST
        + """
[[step]]
entries = "(travel (id a) (length-m 1.0))"
expect = "(travel (id a) (state reachable) (length-m 1.0))"

[[step]]
gone = "(travel (id a))"
expect_not = "(travel (id a))"
expect = "(travel (id b))"
"""
    )
    assert told(tmp_path, text).failures == ()


def test_who_is_silent_is_late(tmp_path: Path) -> None:
    text = (
        'silent = "path_following"\n'
        + FIRST
        + """
[[step]]
at_s = 3
entries = "(behaviour (id path_following) (outcome reached))"
expect = "(goal)"
fires_not = "arrived"
"""
    )
    assert told(tmp_path, text).failures == ()


def test_told_in_full_and_as_data(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told(tmp_path, FIRST + 'expect = "(mode go)"\n')
    path = str(tmp_path / "story.toml")
    assert main(["rules", "test", path, "--verbose"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "story.toml: story: 1 steps, 1 expectations",
        "  two targets at 1 s",
        "    choose: select path_following on with 2.5, 0.5",
        "1 of 1 stories are as told",
    ]
    assert main(["rules", "test", path, "--json"]) == 0
    (data,) = json.loads(capsys.readouterr().out)
    assert (data["as_told"], data["failures"]) == (True, [])
    assert data["steps"] == [
        {"say": "two targets", "fired": ["choose"], "did": ["select path_following on with 2.5, 0.5"]}
    ]
