"""The engine on CLIPS: what passes between Python and CLIPS, and what CLIPS must not be given."""

from collections.abc import Callable

import pytest

from rules.language.errors import RuleError
from rules.language.reader import read_text
from rules.language.values import FactAddress, FactValue, Symbol, Value

clips = pytest.importorskip("clips")

from rules.engines.clips_engine import ClipsEngine  # noqa: E402
from rules.engines.clips_values import from_clips, to_clips  # noqa: E402

VALUES: tuple[Value, ...] = (
    Symbol("red"),
    "red",
    'a "b" \\ c',
    "",
    "two\nlines",
    1,
    -2.5,
    1e-07,
    Symbol("TRUE"),
    2**62,
)


def started(text: str, **externals: Callable[..., Value | None]) -> ClipsEngine:
    engine = ClipsEngine(read_text(text), externals)
    engine.reset()
    return engine


@pytest.mark.parametrize("value", [*VALUES, VALUES, ()])
def test_values_come_back_as_they_went(value: Value) -> None:
    fact = FactValue("seen", (value, (value,) if not isinstance(value, tuple) else value), ("one", "many"))
    if isinstance(value, tuple):
        fact = FactValue("seen", (0, value), ("one", "many"))
    engine = started(
        "(deftemplate seen (slot one) (multislot many)) (defrule copy (seen (one ?x) (many $?m)) => (assert (copy ?x $?m)))"
    )
    engine.assert_fact(fact)
    firing = engine.fire()
    assert firing is not None
    many = fact.fields[1]
    assert isinstance(many, tuple)
    assert firing.changes[0].fact.key == FactValue("copy", (fact.fields[0], *many)).key
    assert from_clips(to_clips(value)) == value


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (Symbol("two words"), "no symbol"),
        (Symbol("?x"), "no symbol"),
        (Symbol("12"), "read as a number"),
        (float("inf"), "no number that CLIPS can read"),
        (2**63, "64 bits"),
        (FactAddress(1), "by rules only"),
        ((Symbol(""),), "no symbol"),
    ],
)
def test_what_clips_cannot_read_is_told(value: Value, said: str) -> None:
    with pytest.raises(RuleError, match=said):
        started("").assert_fact(FactValue("a", (value,)))


def test_external_functions_get_their_arguments_whole_and_may_be_called_as_clips_functions_are() -> None:
    seen: list[tuple[Value, ...]] = []

    def focus(*arguments: Value) -> None:
        seen.append(arguments)

    engine = started("(defrule look (a $?all ?last) => (focus ?all ?last))", focus=focus)
    engine.assert_fact(FactValue("a", (1, Symbol("red"), "red")))
    firing = engine.fire()
    assert firing is not None
    assert firing.error is None
    assert seen == [((1, Symbol("red")), "red")]


@pytest.mark.parametrize("pattern", ["(row $? =(+ ?x 1))", "(row $? ?y&?x|1)", "(row $? ~=(+ ?x 1))"])
def test_patterns_that_would_end_the_process_are_refused(pattern: str) -> None:
    with pytest.raises(RuleError, match=r"<text>:1:\d+: CLIPS 6.42 crashes"):
        ClipsEngine(read_text(f"(defrule crash (a ?x) {pattern} =>)"))


def test_a_test_that_cannot_be_evaluated_does_not_match() -> None:
    engine = started("(defrule large (a ?x&:(> ?x 1)) =>) (defrule small (b ?x) (test (< ?x 1)) =>)")
    engine.assert_fact(FactValue("a", (Symbol("red"),)))
    engine.assert_fact(FactValue("b", (Symbol("red"),)))
    assert engine.agenda() == []
    engine.assert_fact(FactValue("a", (2,)))
    assert len(engine.agenda()) == 1


def test_what_clips_writes_does_not_reach_the_terminal(capfd: pytest.CaptureFixture[str]) -> None:
    engine = started('(defrule say (a ?x) => (printout t "x is " ?x crlf) (if (> ?x 1) then (printout t large)))')
    engine.assert_fact(FactValue("a", (Symbol("red"),)))
    firing = engine.fire()
    assert firing is not None
    assert firing.printed == "x is red\n"
    assert firing.error is not None
    assert "expected argument #1" in firing.error
    engine.retract(1)
    engine.close()
    del engine
    assert capfd.readouterr() == ("", "")
