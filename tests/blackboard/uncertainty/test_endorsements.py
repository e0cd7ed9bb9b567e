"""Endorsements: the source's mug and its handle, what stands, who outweighs whom, and what is still to be found out."""

from typing import Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Endorsement
from blackboard.errors import UncertaintyError
from blackboard.history import HistoryParams
from blackboard.kinds import LINE
from blackboard.messages.geometry import Point
from blackboard.messages.world import Line
from blackboard.uncertainty.endorsements import (
    UNRESOLVED,
    VerdictRule,
    by_strength,
    judge,
    lacking,
    reasons,
    standing,
    strongest_side,
)
from blackboard.vocabulary import Vocabulary

CONFIRMED = VerdictRule(verdict="confirmed", all_for=("body-seen", "handle-seen"), none_against=("*",))
DENIED = VerdictRule(verdict="denied", any_against=("body-seen",))
TIERS = (("bumper",), ("laser", "look-again-*"), ("sonar",))


def said(who: str, verdict: str, stamp_s: float = 0.0, why: str = "as seen") -> Endorsement:
    return Endorsement(who=who, verdict=verdict, why=why, stamp_s=stamp_s)  # type: ignore[arg-type]


ENDORSEMENTS = st.lists(
    st.builds(said, st.sampled_from(["bumper", "laser", "look-again-3", "sonar", "map"]),
              st.sampled_from(["for", "against"]), st.integers(0, 5).map(float)),
    max_size=12,
)  # fmt: skip


def test_the_mug_whose_handle_is_not_in_view() -> None:
    """Section 2.6: the missing handle weakens the mug and is recorded; a second view finds it, and the mug is confirmed."""
    first = (said("body-seen", "for", 1.0), said("handle-seen", "against", 1.0, "no handle in this view"))
    weak = judge(first, [CONFIRMED, DENIED])
    assert (weak.verdict, weak.rule, weak.standing) == (UNRESOLVED, None, first)
    assert lacking(first, CONFIRMED) == ("handle-seen",)  # what to look for from elsewhere
    second = (*first, said("handle-seen", "for", 9.0, "handle seen from behind"))
    sure = judge(second, [CONFIRMED, DENIED])
    assert (sure.verdict, sure.rule) == ("confirmed", CONFIRMED)
    assert [e.why for e in sure.standing] == ["as seen", "handle seen from behind"]
    assert lacking(second, CONFIRMED) == ()
    gone = judge((*second, said("body-seen", "against", 12.0)), [CONFIRMED, DENIED])
    assert gone.verdict == "denied"


def test_the_latest_word_of_each_stands() -> None:
    a, b, c = said("laser", "for", 1.0), said("sonar", "against", 2.0), said("laser", "against", 3.0)
    assert standing([a, b, c]) == standing([c, b, a]) == (b, c)
    same = said("laser", "for", 3.0)
    assert standing([c, same]) == (same,)  # of one stamp the one given later
    assert standing([said("sonar", "for"), said("laser", "for")]) == (said("laser", "for"), said("sonar", "for"))
    assert reasons([a, b, c], "against") == (b, c)
    assert reasons([a, b, c], "for") == (a,)


def test_one_endorser_with_several_reasons() -> None:
    """The mug detector itself sees the body and misses the handle; each reason stands and falls by itself."""

    def word(about: str, verdict: Literal["for", "against", "withdrawn"], stamp_s: float) -> Endorsement:
        return Endorsement(who="mug", verdict=verdict, why="as seen", stamp_s=stamp_s, about=about)

    body, missing, found = word("body", "for", 1.0), word("handle", "against", 1.0), word("handle", "for", 9.0)
    assert standing([body, missing]) == (body, missing)
    assert strongest_side([body, missing], []) == "divided"
    assert standing([body, missing, found]) == (body, found)
    assert standing([body, missing, word("handle", "withdrawn", 5.0)]) == (body,)
    rule = VerdictRule(verdict="confirmed", all_for=("mug/body", "*/handle"))
    assert lacking([body, missing], rule) == ("*/handle",)
    assert judge([body, missing, found], [rule]).verdict == "confirmed"
    assert judge([body], [VerdictRule(verdict="likely", any_for=("mug",))]).verdict == "likely"  # whatever it is about


def test_tiers_order_by_strength() -> None:
    sonar, again, map_, bumper = (
        said("sonar", "for"),
        said("look-again-3", "for"),
        said("map", "for"),
        said("bumper", "for"),
    )
    assert by_strength([sonar, again, map_, bumper], TIERS) == ((bumper,), (again,), (sonar,), (map_,))
    assert judge([sonar, again, map_, bumper], [], TIERS).standing == (bumper, again, sonar, map_)


def test_one_strong_reason_outweighs_many_weak_ones() -> None:
    weak = [said(f"sonar-{i}", "for") for i in range(20)]
    rules = [
        VerdictRule(verdict="denied", strongest="against"),
        VerdictRule(verdict="confirmed", strongest="for"),
        VerdictRule(verdict="look again", strongest="divided"),
    ]
    tiers = (("bumper", "laser"), ("sonar-*",))
    assert judge(weak, rules, tiers).verdict == "confirmed"
    assert judge([*weak, said("bumper", "against")], rules, tiers).verdict == "denied"
    assert judge([*weak, said("bumper", "against"), said("laser", "for")], rules, tiers).verdict == "look again"
    assert judge([], rules, tiers).verdict == UNRESOLVED
    assert strongest_side([], tiers) is None


@pytest.mark.parametrize(
    ("rule", "holds"),
    [
        (VerdictRule(verdict="x", all_for=("laser", "sonar")), True),
        (VerdictRule(verdict="x", all_for=("laser", "map")), False),
        (VerdictRule(verdict="x", any_for=("map", "sonar")), True),
        (VerdictRule(verdict="x", any_for=("bumper", "map")), False),
        (VerdictRule(verdict="x", none_for=("bumper", "map")), True),
        (VerdictRule(verdict="x", none_for=("s*",)), False),
        (VerdictRule(verdict="x", all_against=("bumper",)), True),
        (VerdictRule(verdict="x", all_against=("bumper", "laser")), False),
        (VerdictRule(verdict="x", any_against=("bumper", "laser")), True),
        (VerdictRule(verdict="x", any_against=("laser",)), False),
        (VerdictRule(verdict="x", none_against=("laser", "sonar")), True),
        (VerdictRule(verdict="x", none_against=("*",)), False),
        (VerdictRule(verdict="x", any_for=("laser",), none_against=("bumper",)), False),
        (VerdictRule(verdict="x", strongest="divided"), True),
        (VerdictRule(verdict="x", strongest="for"), False),
    ],
)
def test_each_condition(rule: VerdictRule, holds: bool) -> None:
    """The laser and the sonar are for it, the bumper against."""
    spoken = [said("laser", "for"), said("sonar", "for"), said("bumper", "against")]
    assert (judge(spoken, [rule]).verdict == "x") is holds


def test_the_first_rule_that_holds_decides() -> None:
    first, second = VerdictRule(verdict="first", any_for=("*",)), VerdictRule(verdict="second", any_for=("laser",))
    assert judge([said("laser", "for")], [first, second]).rule is first
    assert judge([said("laser", "for")], [second, first]).rule is second


@given(ENDORSEMENTS)
def test_what_was_taken_back_changes_nothing(spoken: list[Endorsement]) -> None:
    stands = standing(spoken)
    assert standing(stands) == stands
    assert len({e.who for e in stands}) == len(stands) == len({e.who for e in spoken})
    rules = [VerdictRule(verdict="confirmed", strongest="for"), CONFIRMED, DENIED]
    assert judge(spoken, rules, TIERS) == judge(stands, rules, TIERS)
    assert sum(by_strength(spoken, ()), ()) == stands


@given(ENDORSEMENTS, st.randoms(use_true_random=False))
def test_the_order_of_telling_does_not_matter(spoken: list[Endorsement], random: object) -> None:
    apart = [said(e.who, e.verdict, float(i)) for i, e in enumerate(spoken)]
    shuffled = list(apart)
    random.shuffle(shuffled)  # type: ignore[attr-defined]
    rules = [VerdictRule(verdict="confirmed", strongest="for"), VerdictRule(verdict="denied", any_against=("*",))]
    assert judge(shuffled, rules, TIERS) == judge(apart, rules, TIERS)


def test_on_the_board() -> None:
    board = Board(Vocabulary(), robot="k2a", history=HistoryParams())
    start, end = Point(x_m=0.0, y_m=0.0), Point(x_m=0.0, y_m=2.0)
    line = Line(start=start, end=end, alpha_rad=0.0, rho_m=0.0, sigma_rho_m=0.01, support=9)
    laser, sonar = Access(board, "laser", [LINE], []), Access(board, "sonar", [LINE], [])
    entry = board.post(LINE, line, id="7", source="finder")
    for access, verdict, why in (
        (laser, "against", "free space there"),
        (laser, "for", "seen again"),
        (sonar, "for", "echo there"),
    ):
        entry = access.endorse(entry, verdict, why)  # type: ignore[arg-type]
    rules = [VerdictRule(verdict="confirmed", all_for=("laser", "sonar"), none_against=("*",))]
    assert judge(entry.endorsements, rules).verdict == "confirmed"


def test_bad_rules_are_refused_in_one_line() -> None:
    cases = [
        (lambda: VerdictRule(verdict=""), "needs a verdict"),
        (lambda: VerdictRule(verdict="confirmed"), "rule for 'confirmed' has no condition"),
        (lambda: VerdictRule(verdict="x", all_for="laser"), "all_for of the rule for 'x' = 'laser' must be a list"),  # type: ignore[arg-type]
        (lambda: VerdictRule(verdict="x", any_for=("",)), "must be a list of names"),
        (lambda: VerdictRule(verdict="x", any_for=("a", "a")), "names an endorser twice"),
        (lambda: VerdictRule(verdict="x", strongest="yes"), "strongest = 'yes' must be"),  # type: ignore[arg-type]
        (lambda: judge([], [], ["laser"]), "tier 1 = 'laser' must be a list of names"),
    ]
    for call, message in cases:
        with pytest.raises(UncertaintyError, match=message):
            call()
