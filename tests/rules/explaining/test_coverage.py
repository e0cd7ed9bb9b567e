"""Rules that fired and rules that never did, counted over runs."""

from pathlib import Path

import pytest

from blackboard.board import Board
from blackboard.command.main import main
from blackboard.journal import FILE_NAME, JournalWriter, read_journal
from blackboard.kinds import FIRING, RULES
from blackboard.messages.control import Firing, RuleFile, RuleFiles
from blackboard.vocabulary import Vocabulary
from rules.explaining.coverage import RuleCount, coverage, rules_of_run, told

EXPLORE = "(defrule go (mode choose) => (assert (mode go)))\n(defrule rest (mode go) => (assert (mode rest)))"
TRAPS = "(defrule escape (trap) => (assert (mode escape)))"


def record(folder: Path, files: dict[str, str], fired: list[str]) -> Path:
    board = Board(Vocabulary())
    folder.mkdir()
    with JournalWriter(folder / FILE_NAME) as journal:
        board.journal = journal
        texts = tuple(RuleFile(name=name, text=text) for name, text in files.items())
        board.post(RULES, RuleFiles(engine="experta", files=texts), source="planner")
        for number, rule in enumerate(fired, 1):
            board.post(FIRING, Firing(rule=rule, number=number), id=rule, source="planner")
    return folder


def test_counts_of_two_runs(tmp_path: Path) -> None:
    both = {"explore.clp": EXPLORE, "traps.clp": TRAPS}
    one = record(tmp_path / "one", both, ["go", "go", "rest"])
    two = record(tmp_path / "two", {"explore.clp": EXPLORE}, ["go"])
    runs = [run for folder in (one, two) if (run := rules_of_run(read_journal(folder))) is not None]
    explore, traps = coverage(runs)
    assert explore.rules == (
        RuleCount("go", "explore.clp", 1, 3, 2),
        RuleCount("rest", "explore.clp", 2, 1, 2),
    )
    assert (explore.fired, explore.firings) == (2, 4)
    assert traps.rules == (RuleCount("escape", "traps.clp", 1, 0, 1),)
    assert list(told([explore, traps], 2)) == [
        "explore.clp: 2 of 2 rules fired, 4 times",
        "  3  go",
        "  1  rest",
        "traps.clp: 0 of 1 rules fired, 0 times",
        "  0  escape  never   in force in 1 of 2 runs",
        "2 of 3 rules fired (67 %), 4 times in 2 runs",
    ]


def test_a_run_without_rules(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "none").mkdir()
    (tmp_path / "none" / FILE_NAME).write_bytes(b"")
    assert rules_of_run(read_journal(tmp_path / "none")) is None
    one = record(tmp_path / "one", {"explore.clp": EXPLORE}, ["go"])
    assert main(["rules", "cover", str(one), str(tmp_path / "none")]) == 0
    said = capsys.readouterr()
    assert "1 of 2 rules fired (50 %), once in 1 run" in said.out
    assert "none: no rules decided in this run; it is left out" in said.err
    assert main(["rules", "cover", str(tmp_path / "none")]) == 2
    assert "no rules decided in any of these runs" in capsys.readouterr().err
