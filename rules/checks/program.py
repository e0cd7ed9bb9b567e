"""All checks of a program together."""

from blackboard.component import Parts
from rules.checks.bounds import bound_findings
from rules.checks.endless import endless_findings
from rules.checks.finding import Finding, in_order
from rules.checks.names import Board, name_findings
from rules.checks.order import order_findings
from rules.checks.reach import reach_findings
from rules.checks.second_look import second_look
from rules.checks.slot_values import slot_value_findings
from rules.language.errors import RuleError, RuleErrors
from rules.language.syntax import Program


def findings(program: Program, board: Board) -> list[Finding]:
    """Return what is wrong with a program, in the order of its text."""
    found = [
        *name_findings(program, board),
        *slot_value_findings(program, board),
        *reach_findings(program),
        *bound_findings(program),
        *order_findings(program),
        *endless_findings(program),
    ]
    return in_order(found) if found else list(second_look(program))


def refuse_faults(program: Program, parts: Parts) -> None:
    """Raise RuleErrors where the rules ask for what the mission does not have; warnings are for `ski rules check`."""
    errors = [finding for finding in name_findings(program, Board(parts)) if finding.is_error]
    if errors:
        raise RuleErrors([RuleError(error.text, error.position) for error in errors])
