"""One interface to every theory: the mug of section 2.6, what adds up, and what symmetry asks for."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.entry import Endorsement
from blackboard.uncertainty.theories import THEORIES, Theory, judge

MIRRORED = {"confirmed": "denied", "denied": "confirmed", "unresolved": "unresolved"}


def said(about: str, verdict: Any, strength: Any = "fair", stamp_s: float = 0.0) -> Endorsement:
    return Endorsement(who="me", verdict=verdict, why="as seen", stamp_s=stamp_s, about=about, strength=strength)


@pytest.mark.parametrize("theory", THEORIES)
def test_the_mug_and_its_handle(theory: Theory) -> None:
    needs = ("body", "handle")
    body = said("body", "for")
    missing, found = said("handle", "against", stamp_s=1.0), said("handle", "for", "strong", 2.0)
    nowhere = said("handle", "against", "strong", 2.0)
    first = judge(theory, [body, missing], needs)
    assert (first.outcome, first.lacking) == ("unresolved", ("handle",))
    assert first.belief <= 0.5 <= first.plausibility
    second = judge(theory, [body, missing, found], needs)
    assert (second.outcome, second.lacking) == ("confirmed", ())
    assert second.belief > first.belief
    assert judge(theory, [body, missing, nowhere], needs).outcome == "denied"


@pytest.mark.parametrize("theory", THEORIES)
def test_what_decides(theory: Theory) -> None:
    fair, strong = said("a", "for"), said("b", "for", "strong")
    assert judge(theory, []).outcome == "unresolved"
    assert judge(theory, [fair]).outcome == "unresolved"
    assert judge(theory, [strong]).outcome == "confirmed"
    assert judge(theory, [strong, said("c", "against")]).outcome == "confirmed"
    assert judge(theory, [strong, said("c", "against", "strong")]).outcome == "unresolved"
    assert judge(theory, [strong], needs=("a",)).outcome == "unresolved"  # sure, but not of what counts
    two_fair = judge(theory, [fair, said("b", "for")]).outcome
    assert two_fair == ("unresolved" if theory == "fuzzy" else "confirmed")
    assert judge(theory, [said(str(i), "for", "weak") for i in range(3)]).outcome == "unresolved"


def test_numbers_worked_by_hand() -> None:
    both = [said("a", "for"), said("b", "for", "strong"), said("c", "against")]
    assert judge("certainty-factors", both[:2]).belief == pytest.approx((0.95 + 1) / 2)  # 0.5 + 0.9 - 0.45
    assert judge("bayes", both).belief == pytest.approx(20 / 21)  # odds 3 * 20 / 3
    found = judge("dempster-shafer", [both[0], both[2]])  # k = 0.25: a third each for true, false and either
    assert (found.belief, found.plausibility) == (pytest.approx(1 / 3), pytest.approx(2 / 3))
    vague = judge("fuzzy", both)
    assert (vague.belief, vague.plausibility) == (pytest.approx(0.6), pytest.approx(0.9))  # min(0.9, 1 - 0.4); 1 - 0.1
    assert (judge("endorsements", both).belief, judge("endorsements", []).plausibility) == (1.0, 1.0)


SAID = st.lists(
    st.builds(said, st.sampled_from("abcd"), st.sampled_from(["for", "against", "withdrawn"]),
              st.sampled_from(["weak", "fair", "strong"]), st.integers(0, 3).map(float)),
    max_size=8,
)  # fmt: skip


@given(SAID, st.sampled_from(THEORIES))
def test_bounds_and_symmetry(reasons: list[Endorsement], theory: Theory) -> None:
    found = judge(theory, reasons)
    assert 0.0 <= found.belief <= found.plausibility <= 1.0
    turned = {"for": "against", "against": "for", "withdrawn": "withdrawn"}
    mirrored = judge(theory, [said(e.about, turned[e.verdict], e.strength, e.stamp_s) for e in reasons])
    assert mirrored.outcome == MIRRORED[found.outcome]
    assert mirrored.belief == pytest.approx(1.0 - found.plausibility)
    assert found.outcome != "confirmed" or any(e.verdict == "for" for e in reasons)
