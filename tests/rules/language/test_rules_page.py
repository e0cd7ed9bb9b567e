"""What docs/rules.md shows can be read, checked and called."""

import re
from pathlib import Path

from blackboard.vocabulary import Vocabulary
from rules.checks.names import Board
from rules.checks.parts import parts_of_all
from rules.checks.program import findings
from rules.language.functions import FUNCTIONS, STOP_EARLY
from rules.language.reader import read_text
from rules.language.reading.vocabulary import BOARD_ACTIONS
from rules.language.templates import planning_templates

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "rules.md").read_text(encoding="utf-8")


def section(name: str) -> str:
    return PAGE.split(f"\n## {name}\n")[1].split("\n## ")[0]


def test_the_example_is_sound() -> None:
    text = PAGE.split("```clips\n")[1].split("```")[0]
    program = read_text(text, "example.clp", planning_templates(Vocabulary()))
    assert [rule.name for rule in program.rules] == ["battery-low-go-home", "home-reached-charge"]
    assert [str(f) for f in findings(program, Board(parts_of_all(), certain=False))] == []


def test_the_functions_are_those_that_there_are() -> None:
    table = section("Functions").split("| --- | --- |")[1]
    assert sorted(re.findall(r"`([^`]+)`", table)) == sorted([*FUNCTIONS, *STOP_EARLY])


def test_every_board_action_is_told() -> None:
    told = section("Actions")
    assert all(f"({name}" in told or f"`{name}`" in told for name in BOARD_ACTIONS)
