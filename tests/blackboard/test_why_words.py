"""What rules did, as sentences, down to what they matched."""

from pathlib import Path
from typing import Any

import pytest

from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.journal import FILE_NAME, JournalWriter, read_journal
from blackboard.kinds import DRIVE, FACT, FIRING, MOTIVATION, RESPONSE, RULES, TARGET, VELOCITY, Kind
from blackboard.messages.control import Fact, Firing, RuleFile, RuleFiles
from blackboard.messages.geometry import Point
from blackboard.messages.motion import Drive, Motivation, Response, Velocity
from blackboard.messages.symbols import Target
from blackboard.vocabulary import Vocabulary
from blackboard.why import Record, render
from blackboard.why_words import plain_fact


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A target, the rule that chose it, the fact that it asserted, the rule that selected a behaviour for it, and the drive."""
    board = Board(Vocabulary(), robot="k2a")

    def post(kind: Kind[Any], value: Any, name: str | None, *behind: Entry[Any]) -> Entry[Any]:
        return board.post(kind, value, id=name, source="planner", supports=tuple(e.as_support() for e in behind))

    with JournalWriter(tmp_path / FILE_NAME) as journal:
        board.journal = journal
        text = RuleFiles(engine="experta", files=(RuleFile(name="explore.clp", text=""),))
        board.post(RULES, text, source="planner")
        start = board.post(FACT, Fact(relation="mode", fact="(mode choose)"), id="1", source="planner")
        place = Point(x_m=3.2, y_m=1.1)
        value = Target(place=place, stand=place, reason="frontier", size_m=1.0)
        target = board.post(TARGET, value, id="frontier-3", source="frontiers")
        board.now_s = 12.3
        matched = (
            "(mode choose)",
            '(target (id frontier-3) (key "ski/k2a/x") (stamp-s 0.0) (size-m 1.0))',
            "",
        )
        choice = Firing(rule="explore-nearest-target", number=1, facts=matched)
        chosen = post(FIRING, choice, "explore-nearest-target", start, target)
        goal = Fact(relation="goal", fact="(goal (target frontier-3) (x-m 3.2000000000000002))")
        goal_entry = post(FACT, goal, "2", chosen)
        asked = Firing(rule="goal-asks-for-path", number=2, facts=(goal.fact,))
        fired = post(FIRING, asked, "goal-asks-for-path", goal_entry)
        motivation = post(MOTIVATION, Motivation(on=True, number=4, parameters=(3.2, 1.1)), "path_following", fired)
        response = post(RESPONSE, Response(forward=1.0), "path_following", motivation)
        velocity = post(VELOCITY, Velocity(forward_mps=0.3, turn_radps=0.0, valid_until_s=13.0), None, response)
        post(DRIVE, Drive(forward_mps=0.3, turn_radps=0.0, limited_by="nothing"), None, velocity)
        board.now_s = 20.0
        board.post(MOTIVATION, Motivation(on=False, number=5), id="path_following", source="planner")
        board.retract(FACT, "1", source="planner")
    return tmp_path


def test_a_drive_reaches_the_rule_its_facts_and_what_they_stand_on(folder: Path) -> None:
    record = Record(read_journal(folder))
    lines = [line.strip("│├└─ ") for line in render(record.explain(record.find("commands/drive")))]
    assert lines[3:] == [
        "path_following was asked to go to (3.20, 1.10) at 12.30 s  [motivations/motivation/path_following revision 1]",
        "because rule goal-asks-for-path fired at 12.30 s: it matched (goal (target frontier-3) (x-m 3.2))"
        "  [control/firing/goal-asks-for-path revision 1]",
        "the fact (goal (target frontier-3) (x-m 3.2)) was asserted at 12.30 s  [control/fact/2 revision 1]",
        "because rule explore-nearest-target fired at 12.30 s: it matched (mode choose), "
        "(target (id frontier-3) (size-m 1.0))  [control/firing/explore-nearest-target revision 1]",
        "the fact (mode choose) stood from the start  [control/fact/1 revision 1]",
        "hypotheses/symbol/target/frontier-3 revision 1 at 0.00 s by frontiers: place (3.2, 1.1), stand (3.2, 1.1), "
        "reason frontier, size_m 1",
    ]


def test_other_sentences(folder: Path) -> None:
    record = Record(read_journal(folder))

    def first(key: str) -> str:
        return next(render(record.explain(record.find(key))))

    assert first("motivations/motivation/path_following").startswith("path_following was told to stop at 20.00 s")
    assert first("control/fact/1").startswith("the fact (mode choose) was retracted")
    assert first("control/rules").startswith("the rules of explore.clp came into force at 0.00 s")
    assert first("control/firing/goal-asks-for-path").startswith(
        "rule goal-asks-for-path fired"
    )  # no `because` at the top


def test_a_fact_without_what_only_tells_where_it_came_from() -> None:
    assert (
        plain_fact('(travel (id a) (key "ski/r/x y") (stamp-s 1.5) (length-m 3.05731))')
        == "(travel (id a) (length-m 3.057))"
    )
    assert plain_fact("(at -0.123456 1e-5 12 v1.2345)") == "(at -0.1235 1e-5 12 v1.2345)"
    assert len(plain_fact(f"(word {'x' * 200})")) == 90
