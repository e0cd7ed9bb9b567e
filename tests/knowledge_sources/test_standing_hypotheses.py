"""Hypotheses kept in step with what is found; names of places that are found again."""

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Support
from blackboard.kinds import TRAP, VERDICT
from blackboard.messages.geometry import Point
from blackboard.messages.symbols import Trap
from blackboard.uncertainty.theories import THEORIES, Theory
from blackboard.vocabulary import Vocabulary
from knowledge_sources.standing_hypotheses import Episodes, Found, Names, Reason, StandingHypotheses
from knowledge_sources.verdicts import Verdicts


def trap(size_m: float) -> Trap:
    return Trap(trap="u-shape", place=Point(x_m=1.0, y_m=2.0), size_m=size_m)


def test_posted_revised_when_it_differs_denied_when_gone() -> None:
    board = Board(Vocabulary())
    access = Access(board, "me", (), (TRAP,))
    kept: StandingHypotheses[Trap] = StandingHypotheses(TRAP, lambda a, b: abs(a.size_m - b.size_m) > 0.5)
    for size_m, why in ((1.0, "so"), (1.1, "so"), (1.2, "thus"), (1.3, "so"), (2.0, "")):
        kept.keep(
            access, {"a": Found(trap(size_m), (), [Reason(why)] if why else [])}, lambda t: f"{t.size_m} is no more"
        )
    (entry,) = board.entries(TRAP)
    assert entry.value.size_m == 2.0  # the smaller changes were no revision
    said = [(e.verdict, e.why) for e in entry.endorsements]  # each reason once, until there is another
    assert said == [("for", "so"), ("for", "thus"), ("for", "so"), ("withdrawn", "it does not hold any more")]
    kept.keep(access, {}, lambda t: f"{t.size_m} is no more")
    assert board.entries(TRAP) == []
    last = board.history.revisions(Support(entry.key, 1, 99))[-1]
    assert last.event == "retracted"
    assert [(e.verdict, e.why) for e in last.endorsements][-1] == ("against", "2.0 is no more")
    kept.keep(access, {"a": Found(trap(3.0), (), [Reason("so")])}, lambda t: "gone")
    (entry,) = board.entries(TRAP)
    assert [e.why for e in entry.endorsements] == ["so"]  # a new life


def test_what_comes_to_hold_again_is_another() -> None:
    board = Board(Vocabulary())
    access = Access(board, "me", (), (TRAP,))
    episodes: Episodes[Trap] = Episodes(TRAP, "cycling")
    stood = []
    for size_m in (None, 1.0, 2.0, None, 3.0):
        episodes.keep(access, None if size_m is None else Found(trap(size_m), (), [Reason("so")]), "new places")
        stood.append([(entry.id, entry.value.size_m) for entry in board.entries(TRAP)])
    assert stood == [[], [("cycling-1", 1.0)], [("cycling-1", 1.0)], [], [("cycling-2", 3.0)]]


@pytest.mark.parametrize("theory", THEORIES)
def test_the_verdict_follows_the_reasons(theory: Theory) -> None:
    board = Board(Vocabulary())
    access = Access(board, "me", (), (TRAP, VERDICT))
    kept: StandingHypotheses[Trap] = StandingHypotheses(TRAP, lambda a, b: False, Verdicts(theory))
    told: list[tuple[str, str]] = []
    board.subscribe("ski/*/hypotheses/symbol/verdict/*", lambda e: told.append((e.event, e.value.outcome)))
    once, sure = Reason("seen once", "walls"), Reason("seen often", "walls", strength="strong")
    for reasons in ([once], [once], [sure], [sure, Reason("no echo", "echo", "against")]):
        kept.keep(access, {"a": Found(trap(1.0), (), reasons)}, lambda _: "it is no more")
    (verdict,) = board.entries(VERDICT)
    assert (verdict.id, verdict.value.theory, verdict.value.outcome) == ("trap.a", theory, "confirmed")
    assert (verdict.value.place, verdict.supports[0].key) == (Point(x_m=1.0, y_m=2.0), verdict.value.hypothesis)
    kept.keep(access, {}, lambda _: "it is no more")
    assert [event for event, _ in told] == ["posted", "revised", "revised", "revised", "retracted"]
    assert [outcome for _, outcome in told] == ["unresolved", "confirmed", "confirmed", "denied", "denied"]


def test_the_nearest_keeps_its_name() -> None:
    names = Names("target", 0.5)
    assert names.name([(0.0, 0.0), (2.0, 0.0)]) == ["target-1", "target-2"]
    assert names.name([(2.1, 0.0), (0.3, 0.0), (0.1, 0.0)]) == ["target-2", "target-3", "target-1"]
    assert names.name([(9.0, 0.0)]) == ["target-4"]
    assert names.name([(0.1, 0.0)]) == ["target-5"]  # once given up, a name does not come back
    assert names.name([(0.5, 0.0)]) == names.name([(0.9, 0.0)]) == ["target-5"]
    assert names.name([]) == []


def test_what_wanders_off_its_anchor_gets_another_name() -> None:
    names = Names("target", 0.5, anchored=True)
    assert names.name([(0.0, 0.0)]) == names.name([(0.4, 0.0)]) == ["target-1"]
    assert names.name([(0.8, 0.0)]) == names.name([(1.2, 0.0)]) == ["target-2"]
