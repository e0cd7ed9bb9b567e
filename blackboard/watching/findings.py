"""What is wrong with a setup, and what to do about it: from facts to findings, nothing is asked or measured here."""

from blackboard.watching.board_findings import board_findings
from blackboard.watching.finding import DoctorParams, Finding, Rule
from blackboard.watching.host_findings import component_findings, host_findings
from blackboard.watching.link_findings import keeper_findings, link_findings
from blackboard.watching.setup_facts import SetupFacts

RULES: tuple[Rule, ...] = (keeper_findings, host_findings, component_findings, board_findings)


def findings(facts: SetupFacts, params: DoctorParams | None = None) -> list[Finding]:
    """Return all that is wrong; where the keeper is not reached, that is all that can be said."""
    params = params or DoctorParams()
    unreached = list(link_findings(facts))
    return unreached or [found for rule in RULES for found in rule(facts, params)]
