"""experta and CLIPS in lockstep, on random programs with fixed seeds and on the rule files that come with the project."""

import tomllib

import pytest

from blackboard.vocabulary import Vocabulary
from rules.language.reader import read_program
from rules.language.templates import planning_templates
from rules.rule_files import shipped_rule_files

pytest.importorskip("clips")

import lockstep

BLOCKS, IN_BLOCK = 10, 30
SHIPPED = shipped_rule_files()


@pytest.mark.parametrize("block", range(BLOCKS))
def test_random_programs(block: int) -> None:
    total = lockstep.Tally()
    for seed in range(block * IN_BLOCK, (block + 1) * IN_BLOCK):
        tally, fault = lockstep.lockstep(seed)
        assert fault is None, f"seed {seed}: {fault}"
        total.add(tally)
    assert total.refused < IN_BLOCK / 5
    assert total.first > 0.97 * total.firings, "experta by itself fires in the same order but for a few ties"
    assert total.firings > 60
    assert total.activations > 300


def file_sets() -> list[tuple[str, ...]]:
    """Return the sets of rule files that missions use together; a file that none uses is a set of its own."""
    sets: dict[tuple[str, ...], None] = {}
    for mission in sorted((SHIPPED["explore"].parent / "missions").glob("*.toml")):
        table = tomllib.loads(mission.read_text(encoding="utf-8"))
        names = tuple(table.get("rules", {}).get("files", ()))
        if names:
            sets[names] = None
    used = {name for names in sets for name in names}
    return [*sets, *((name,) for name in SHIPPED if name not in used)]


@pytest.mark.parametrize("names", file_sets(), ids="+".join)
def test_rule_files_of_the_project(names: tuple[str, ...]) -> None:
    program = read_program([SHIPPED[name] for name in names], planning_templates(Vocabulary()))
    total = lockstep.Tally()
    for seed in range(5):
        tally, fault = lockstep.lockstep_of(program, seed)
        assert fault is None, f"seed {seed}: {fault}"
        total.add(tally)
    assert len(set(total.fired)) > 0.6 * len(program.rules), "facts are to be had for most rules"
    assert total.first > 0.97 * total.firings, "experta by itself fires in the same order but for a few ties"
