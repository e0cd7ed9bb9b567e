"""Rules and facts as they stood at some time of a run, out of its record; and the words of `ski rules why-not`."""

from collections.abc import Iterable
from pathlib import Path

import pytest

from blackboard.board import Board
from blackboard.errors import RecordingError
from blackboard.journal import FILE_NAME, JournalWriter, read_journal
from blackboard.kinds import COMPONENT, FACT, FIRING, RULES, TRAVEL, slot
from blackboard.messages.base import Message
from blackboard.messages.control import ComponentStatus, Fact, Firing, RuleFile, RuleFiles
from blackboard.messages.geometry import Point
from blackboard.messages.routes import Travel
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions
from blackboard.vocabulary import Vocabulary
from rules.explaining.record import situation
from rules.explaining.told import as_dict, told
from rules.explaining.why_not import brief, why_not
from rules.language.values import FactValue
from rules.planning import PlanningModule
from rules.working_memory import slots_looked_at

RULES_TEXT = """(deffacts beginning (mode choose))
(defrule nearest-target-go "Go there"
  (mode choose)
  (clock (time-s ?now))
  (travel (id ?target) (state reachable) (length-m ?length&:(< ?length 5.0)))
  (not (given-up ?target))
  =>
  (assert (mode go)))
(defrule blocked-give-up
  (blocked ?target)
  =>
  (assert (given-up ?target)))
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A run of 10 s: frontier-1 comes nearer at 2 s, the rule fires at 3 s, the target is given up at 5 s."""
    board = Board(Vocabulary(), robot="k2a")
    with JournalWriter(tmp_path / FILE_NAME) as journal:
        board.journal = journal
        files = RuleFiles(engine="experta", files=(RuleFile(name="explore.clp", text=RULES_TEXT),))
        board.post(RULES, files, source="planner")
        board.post(FACT, Fact(relation="mode", fact="(mode choose)"), id="1", source="planner")
        for stamp_s, length_m in ((1.0, 9.0), (2.0, 4.0)):
            board.now_s = stamp_s
            travel = Travel(state="reachable", stand=Point(x_m=1.0, y_m=2.0), length_m=length_m)
            board.post(TRAVEL, travel, id="frontier-1", source="travel")
        board.now_s = 3.0
        matched = ("(mode choose)", "(clock (time-s 3.0))", "(travel ...)", "")
        firing = Firing(rule="nearest-target-go", number=1, facts=matched)
        board.post(FIRING, firing, id="nearest-target-go", source="planner")
        board.now_s = 5.0
        board.post(FACT, Fact(relation="given-up", fact="(given-up frontier-1)"), id="9", source="planner")
        board.now_s = 8.0
        board.retract(FACT, "1", source="planner")
        board.post(FACT, Fact(relation="x", fact='(x "unbalanced)'), id="11", source="planner")
    return tmp_path


def words(folder: Path, rule: str, at_s: float | None) -> list[str]:
    then = situation(read_journal(folder), at_s)
    named = {one.name: one for one in then.program.rules}[rule]
    return list(told(why_not(then.program, named, then.facts), then))


def test_working_memory_as_it_stood(folder: Path) -> None:
    assert [str(fact) for fact in situation(read_journal(folder), 1.5).facts.values()] == [
        "(clock (time-s 1.5))",
        '(travel (id frontier-1) (key "ski/k2a/hypotheses/feature/travel/frontier-1") (stamp-s 1.0) (state reachable) '
        "(stand-x-m 1.0) (stand-y-m 2.0) (length-m 9.0))",
        "(mode choose)",
    ]
    end = situation(read_journal(folder))
    assert (end.stamp_s, end.unread, [fact.relation for fact in end.facts.values()]) == (
        8.0,
        1,
        ["clock", "travel", "given-up"],
    )
    assert [one.name for one in end.program.deffacts] == ["beginning"]  # those read back are no part of the program


def test_why_not_in_words(folder: Path) -> None:
    assert words(folder, "nearest-target-go", 1.5) == [
        "nearest-target-go (explore.clp:2): Go there",
        "  At 1.5 s condition 3 of 4 kept it from firing: no fact matches it.",
        "    (travel (id ?target) (state reachable) (length-m ?length&:(< ?length 5.0)))   at explore.clp:5",
        "      (travel (id frontier-1) (state reachable) (length-m 9.0)): "
        "length-m is 9.0, wanted ?length&:(< ?length 5.0)",
        "    (travel ...) is an entry of hypotheses/feature/travel on the board",
        "  The conditions before it hold: (mode choose) (clock (time-s 1.5))",
        "  It had never fired until then.",
    ]
    later = words(folder, "nearest-target-go", 6.0)
    assert later[1] == "  At 6 s condition 4 of 4 kept it from firing: what must not be is so."
    assert later[3:5] == ["      there is (given-up frontier-1)", "    what would match is asserted by blocked-give-up"]
    assert later[-1] == "  It had fired once until then, the last time at 3.00 s."


def test_a_rule_that_could_fire(folder: Path) -> None:
    lines = words(folder, "nearest-target-go", 2.5)
    assert lines[1] == "  At 2.5 s it could fire: all its conditions hold."
    assert lines[2].startswith("    (mode choose) (clock (time-s 2.5)) (travel (id frontier-1)")
    assert lines[3] == "  It waits for its turn: the facts are newer than the last firing, or a rule said halt."


def test_failures_are_told(folder: Path) -> None:
    board = Board(Vocabulary(), robot="k2a")
    lines = list(read_journal(folder))
    with JournalWriter(folder / "more") as journal:
        board.journal = journal
        board.now_s = 9.0
        failed = Firing(rule="nearest-target-go", number=2, error="there is no behaviour 'x'")
        board.post(FIRING, failed, id="nearest-target-go", source="planner")
        board.post(COMPONENT, ComponentStatus(state="failed", error="it broke"), id="planner", source="planner")
    then = situation([*lines, *read_journal(folder / "more")])
    said = list(told(why_not(then.program, then.program.rules[0], then.facts), then))
    assert said[1] == "  The planning module had failed, so no rule fired any more: it broke"
    assert said[-1].endswith("the last time at 9.00 s, and failed: there is no behaviour 'x'.")


def test_working_memory_is_that_of_the_planning_module(tmp_path: Path) -> None:
    run = Run(load_mission(find_mission("explore-lab")), RunOptions(seed=2))
    with JournalWriter(tmp_path / FILE_NAME) as journal:
        run.board.journal = journal
        run.run(30.0)
    assert run.planning is not None
    module = run.planning.planner
    assert isinstance(module, PlanningModule)
    then = situation(read_journal(tmp_path))
    looked_at = slots_looked_at(then.program)

    def shown(facts: Iterable[FactValue]) -> list[str]:
        return sorted(
            brief(fact, looked_at[fact.relation] - {"stamp-s", "key"}) for fact in facts if fact.relation != "clock"
        )

    assert len(then.facts) > 20
    assert shown(then.facts.values()) == shown(module.memory.engine.facts().values())
    fired = {firing.value.rule for firing in then.firings}
    for rule in then.program.rules:  # nothing waits at the end of a cycle: what could fire has fired
        assert rule.name in fired or not why_not(then.program, rule, then.facts).ways, rule.name


def test_as_data(folder: Path) -> None:
    then = situation(read_journal(folder), 6.0)
    data = as_dict(why_not(then.program, then.program.rules[0], then.facts), then)
    assert data["could_fire"] is False
    assert data["fired"] == [3.0]
    assert data["obstacle"]["condition"] == 4
    assert data["obstacle"]["reasons"] == ["there is (given-up frontier-1)"]


class Mug(Message, frozen=True, kw_only=True):
    size_m: float


def test_rules_about_kinds_of_a_missions_own(tmp_path: Path) -> None:
    mug = slot("hypotheses/symbol/mug", Mug, "a mug")
    vocabulary = Vocabulary([mug])
    board = Board(vocabulary)
    with JournalWriter(tmp_path / FILE_NAME) as journal:
        board.journal = journal
        text = "(defrule mug-large (mug (size-m ?s&:(> ?s 1.0))) => (assert (large)))"
        files = RuleFiles(engine="experta", files=(RuleFile(name="mug.clp", text=text),))
        board.post(RULES, files, source="planner")
        board.post(mug, Mug(size_m=0.5), source="mugs")
    then = situation(read_journal(tmp_path), vocabulary=vocabulary)
    obstacle = why_not(then.program, then.program.rules[0], then.facts).obstacle
    assert obstacle is not None
    assert obstacle.reasons == ("(mug (size-m 0.5)): size-m is 0.5, wanted ?s&:(> ?s 1.0)",)
    with pytest.raises(RecordingError, match="where the mission has kinds of its own, name it: --mission FILE"):
        situation(read_journal(tmp_path))


def test_a_run_without_rules(tmp_path: Path) -> None:
    (tmp_path / FILE_NAME).write_bytes(b"")
    with pytest.raises(RecordingError, match=r"no rules decided in this run; its mission has no \[rules\]"):
        situation(read_journal(tmp_path))
