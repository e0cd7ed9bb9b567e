"""`ski rules check` and `ski rules templates` as a user sees them."""

import json
from pathlib import Path

import pytest

from blackboard.command.main import main
from blackboard.vocabulary import Vocabulary
from rules.command.check import ELSEWHERE_HINT
from rules.language.reader import read_text
from rules.language.templates import planning_templates


def test_the_shipped_rules_are_sound(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rules", "check"]) == 0
    assert capsys.readouterr().out.endswith(" files: no errors, no warnings.\n")


def test_faults_are_told_with_their_places_and_errors_end_with_status_2(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mine.clp").write_text("(defrule a (trap (trap cyclin)) =>\n  (behaviour-select curiosity onn))\n")
    assert main(["rules", "check", "mine.clp"]) == 2
    assert capsys.readouterr().out.splitlines() == [
        "mine.clp:1:24: warning: the slot 'trap' of 'trap' is never cyclin; did you mean 'cycling'?",
        "mine.clp:2:31: error: behaviour-select: onn must be on or off",
        "1 file: 1 error, 1 warning.",
    ]
    assert main(["rules", "check", "mine.clp", "--json"]) == 2
    second = json.loads(capsys.readouterr().out)[1]
    assert second == {
        "severity": "error",
        "file": "mine.clp",
        "line": 2,
        "column": 31,
        "text": "behaviour-select: onn must be on or off",
    }


def test_all_syntax_errors_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.clp").write_text("(defrule a (b) => (foo))\n(defrul b)\n")
    assert main(["rules", "check", str(tmp_path / "mine.clp")]) == 2
    out = capsys.readouterr().out
    assert "mine.clp:1:19: error: there is no function 'foo'" in out
    assert "mine.clp:2:1: error: 'defrul' begins no construct; did you mean 'defrule'?" in out


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("explor", "there is no rule file 'explor'; did you mean 'explore'?"),
        ("none.toml", "there is no mission file 'none.toml'"),
        (
            "explore-lab-lines",
            "the mission 'explore-lab-lines' has no rules; give it a [rules] table with files = [...]",
        ),
    ],
)
def test_what_is_not_there_to_check_is_told(given: str, told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rules", "check", given]) == 2
    assert capsys.readouterr().err == f"ski: {told}\n"


def test_templates_are_printed_as_deftemplates_that_can_be_read(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rules", "templates"]) == 0
    read = read_text(capsys.readouterr().out).templates
    assert [(template.name, template.slots) for template in read] == [
        (template.name, template.slots) for template in planning_templates(Vocabulary())
    ]
    assert main(["rules", "templates", "trap"]) == 0
    assert "  (slot trap)       ; cycling or no-progress or u-shape\n" in capsys.readouterr().out


def test_an_unknown_template_is_told_with_the_nearest_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rules", "templates", "targt"]) == 2
    assert capsys.readouterr().err == "ski: there is no template 'targt'; did you mean 'target'?\n"


def test_a_file_that_needs_others_is_told_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rules", "check", "traps"]) == 2
    assert ELSEWHERE_HINT in capsys.readouterr().out
    assert main(["rules", "check", "arbitration", "explore", "traps"]) == 0
    assert ELSEWHERE_HINT not in capsys.readouterr().out
