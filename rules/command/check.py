"""`ski rules check [FILE|MISSION ...]`: what is wrong with rule files, each fault with file, line and column.

Rule files that are named together are one program; a mission's are one with that mission's behaviours and knowledge sources.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from blackboard.mission import Mission, find_mission, load_mission, shipped_missions
from rules.checks.finding import Finding
from rules.checks.names import Board
from rules.checks.parts import complete_missions, parts_of, parts_of_all
from rules.checks.program import findings
from rules.language.errors import RuleError, RuleErrors
from rules.language.reader import read_program
from rules.language.templates import planning_templates
from rules.planning import PlanningParams
from rules.rule_files import find_rule_file

EXIT_ERROR = 2
ELSEWHERE = ("is its deftemplate missing?", "there is no function", "there is no global", "nothing asserts")
ELSEWHERE_HINT = "What other files define is known where they are named too, or the mission that names them all.\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "what",
        nargs="*",
        metavar="FILE|MISSION",
        help="rule files (.clp, or the name of a shipped one), or missions (.toml, or the name of a shipped one); "
        "all shipped missions with rules unless given",
    )
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    found: list[Finding] = []
    files: list[Path] = []
    for paths, board in _programs(options.what):
        files += [path for path in paths if path not in files]
        try:
            program = read_program(paths, planning_templates(board.parts.vocabulary))
        except RuleErrors as errors:
            found += [_of_error(error) for error in errors.errors]
            continue
        found += findings(program, board)
    found = list(dict.fromkeys(found))
    errors_found = sum(finding.is_error for finding in found)
    if options.json:
        sys.stdout.write(json.dumps([_as_json(finding) for finding in found], indent=2) + "\n")
    else:
        for finding in found:
            sys.stdout.write(f"{finding}\n")
        if any(sign in finding.text for finding in found for sign in ELSEWHERE):
            sys.stdout.write(ELSEWHERE_HINT)
        warnings = len(found) - errors_found
        sys.stdout.write(
            f"{_many(len(files), 'file')}: {_many(errors_found, 'error')}, {_many(warnings, 'warning')}.\n"
        )
    return EXIT_ERROR if errors_found else 0


def _programs(what: Sequence[str]) -> Iterator[tuple[Sequence[Path], Board]]:
    """Yield what is to be checked together, with what it may ask of the board."""
    missions = shipped_missions()
    named = what or [name for name, mission in complete_missions().items() if _rule_files(mission)]
    files = [one for one in named if one not in missions and not one.endswith(".toml")]
    for one in named:
        if one not in files:
            mission = load_mission(find_mission(one))
            paths = _rule_files(mission)
            if not paths:
                raise RuleError(f"the mission '{one}' has no rules; give it a [rules] table with files = [...]")
            yield paths, Board(parts_of(mission))
    if files:
        yield [_found(Path(one)) for one in files], Board(parts_of_all(), certain=False)


def _rule_files(mission: Mission) -> list[Path]:
    params = None if mission.rules is None else mission.rules.params
    return list(map(_found, params.files)) if isinstance(params, PlanningParams) else []


def _found(path: Path) -> Path:
    """Return a rule file, as seen from here where it lies below."""
    found = find_rule_file(path)
    here = Path.cwd()
    return found.relative_to(here) if found.is_relative_to(here) else found


def _of_error(error: RuleError) -> Finding:
    text = str(error)
    if error.position is not None:
        text = text.removeprefix(f"{error.position}: ")
    return Finding(text, error.position, is_error=True)


def _as_json(finding: Finding) -> dict[str, str | int | None]:
    at = finding.position
    return {
        "severity": "error" if finding.is_error else "warning",
        "file": None if at is None else at.file,
        "line": None if at is None else at.line,
        "column": None if at is None else at.column,
        "text": finding.text,
    }


def _many(number: int, what: str) -> str:
    return f"{number or 'no'} {what}{'' if number == 1 else 's'}"
