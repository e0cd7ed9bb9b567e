"""Rule files that are changed under way, and files that cannot be used."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from blackboard.errors import SkiError
from blackboard.kinds import RULES
from rules.planning import PlanningModule, PlanningParams

BenchOf = Callable[..., Any]


def rewrite(path: Path, text: str) -> None:
    """Change a file so that its time or size tells."""
    path.write_text(text + "\n" * (len(path.read_text(encoding="utf-8")) + 1), encoding="utf-8")


RELOADED = """
(deffacts start (mode wander) (count 0))
(defrule once (mode wander) ?c <- (count ?n) (target (id ?t)) => (retract ?c) (assert (met ?t)))
"""


@pytest.mark.parametrize("engine", ["experta", "clips"])
def test_a_changed_file_takes_over_without_losing_facts_or_firing_again(bench_of: BenchOf, engine: str) -> None:
    if engine == "clips":
        pytest.importorskip("clips")
    bench = bench_of(RELOADED, reload_s=0.1, engine=engine)
    bench.target("frontier-1")
    bench.cycle()
    assert sorted(bench.facts()) == ["(met frontier-1)", "(mode wander)"]
    rewrite(bench.paths[0], RELOADED + "(defrule new (met ?t) (target (id ?t) (place-x-m ?x)) => (assert (new ?t ?x)))")
    bench.cycle(1.0)
    assert sorted(bench.facts()) == ["(met frontier-1)", "(mode wander)", "(new frontier-1 1.0)"]
    assert bench.firing("once").revision == 1
    rules = bench.board.newest(RULES)
    assert rules is not None
    assert (rules.revision, rules.value.refused) == (2, "")
    assert "defrule new" in rules.value.files[0].text


def test_a_rule_that_has_fired_does_not_fire_again_on_the_same_facts(bench_of: BenchOf) -> None:
    fire = "(defrule fire (target (id ?t)) => (assert (fired ?t)))"
    bench = bench_of(fire, reload_s=0.1)
    bench.target("frontier-1")
    bench.cycle()
    rewrite(bench.paths[0], fire + " (defrule other (never) => (halt))")
    bench.cycle(1.0)
    assert bench.firing("fire").revision == 1
    rewrite(bench.paths[0], fire.replace("fired", "noticed"))
    bench.cycle(1.0)
    assert bench.firing("fire").revision == 2  # the rule itself has changed: it looks afresh
    assert "(noticed frontier-1)" in bench.facts()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("(defrule broken (mode wander) => (assert (x)", "rules0.clp:1"),
        (
            "(deftemplate mode (slot is)) (defrule r (mode (is wander)) => (assert (x)))",
            "the fact (mode wander) stands, but",
        ),
        (
            "(defrule p (mode wander) => (post (trap (id a) (trap cycling) (place-x-m 0) (place-y-m 0) (size-m 1))))",
            "did not; run anew",
        ),
    ],
)
def test_a_bad_file_is_refused_and_the_old_rules_stay(bench_of: BenchOf, text: str, says: str) -> None:
    bench = bench_of(RELOADED, reload_s=0.1)
    bench.cycle()
    rewrite(bench.paths[0], text)
    bench.cycle(1.0)
    rules = bench.board.newest(RULES)
    assert rules is not None
    assert says in rules.value.refused
    assert "\n" not in rules.value.refused
    assert rules.value.files[0].text == RELOADED
    bench.target("frontier-1")
    bench.cycle(1.0)
    assert "(met frontier-1)" in bench.facts()


def test_a_file_that_is_gone_for_a_moment_is_no_change(bench_of: BenchOf) -> None:
    bench = bench_of(RELOADED, reload_s=0.1)
    bench.cycle()
    bench.paths[0].unlink()
    bench.cycle(1.0)
    rules = bench.board.newest(RULES)
    assert rules is not None
    assert rules.revision == 1


def start_error(tmp_path: Path, names: Sequence[Path]) -> str:
    with pytest.raises(SkiError) as caught:
        PlanningModule(PlanningParams(files=tuple(names)), name="rules")
    return str(caught.value)


def test_rule_files_that_are_missing_are_refused(tmp_path: Path) -> None:
    assert "there is no rule file 'explor'; did you mean 'explore'?" in start_error(tmp_path, [Path("explor")])
    binary = tmp_path / "b.clp"
    binary.write_bytes(b"(defrule \xff)")
    assert "no UTF-8" in start_error(tmp_path, [binary])


def test_two_files_of_one_name_are_refused(tmp_path: Path) -> None:
    paths = [tmp_path / folder / "mine.clp" for folder in ("a", "b")]
    for path in paths:
        path.parent.mkdir()
        path.write_text("(deffacts start (a))", encoding="utf-8")
    assert f"{paths[1]}: there is another 'mine.clp' ({paths[0]}); rename one of them" in start_error(tmp_path, paths)


def test_a_mark_of_utf_8_at_the_beginning_is_no_part_of_the_rules(bench_of: BenchOf) -> None:
    bench = bench_of("\ufeff(deffacts start (a))")
    bench.cycle()
    assert bench.facts() == ["(a)"]
