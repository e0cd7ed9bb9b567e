"""Brackets: what is not closed is told at its opening bracket, and what follows is read all the same."""

import pytest

from rules.language.errors import RuleError
from rules.language.reading.forms import top_forms
from rules.language.reading.tokens import tokens


def read(text: str) -> tuple[list[str], list[str]]:
    faults: list[RuleError] = []
    heads = [form.head for form in top_forms(tokens(text, "f", faults), faults)]
    return heads, [str(fault) for fault in faults]


@pytest.mark.parametrize(
    ("text", "heads", "told"),
    [
        ("(deffacts a (x))(defrule b (y))", ["deffacts", "defrule"], []),
        (
            "(defrule a (x)\n  =>\n  (assert (y))\n(defrule b (z) => )",
            ["defrule"],
            ["f:1:1: this bracket is not closed: (defrule a ..."],
        ),
        ("(defrule a\n  (x (test (y\n  =>\n  (z))", ["defrule"], ["f:2:12: (y is not closed before the =>"]),
        ("(deffacts a (x)) )\n(deffacts b)", ["deffacts", "deffacts"], ["f:1:18: this bracket {}"]),
        ("(deffacts a (x))) (y) z\n(deffacts b)", ["deffacts", "deffacts"], ["f:1:17: this bracket {}"]),
        ("loose (deffacts b)", ["deffacts"], ["f:1:1: 'loose' {}"]),
    ],
)
def test_faults_of_brackets(text: str, heads: list[str], told: list[str]) -> None:
    outside = "stands outside of any construct: a bracket too many before it, or one missing?"
    assert read(text) == (heads, [line.format(outside) for line in told])
