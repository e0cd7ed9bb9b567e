"""The plain matcher of explanations finds the matches that an engine finds, on random programs with fixed seeds."""

from collections import Counter

import pytest
from random_programs import Writer

from rules.engines.experta_engine import ExpertaEngine
from rules.explaining.why_not import why_not
from rules.language.reader import read_text

BLOCKS, IN_BLOCK = 4, 25
FACTS = 12


@pytest.mark.parametrize("block", range(BLOCKS))
def test_random_programs(block: int) -> None:
    found = 0
    for seed in range(block * IN_BLOCK, (block + 1) * IN_BLOCK):
        writer = Writer(seed)
        text = writer.program()
        program = read_text(text, f"program {seed}")
        engine = ExpertaEngine(program)
        engine.reset()
        for _ in range(FACTS):
            engine.assert_fact(writer.fact())
        facts = engine.facts()
        expected: Counter[tuple[str, tuple[int, ...]]] = Counter()
        for activation in engine.agenda():
            expected[activation.rule, tuple(i for i in activation.facts if i is not None)] += 1
        ways: Counter[tuple[str, tuple[int, ...]]] = Counter()
        for rule in program.rules:
            for way in why_not(program, rule, facts).ways:
                ways[rule.name, tuple(i for i in way.facts if i is not None)] += 1
        engine.close()
        assert ways == expected, f"seed {seed}\n{text}"
        found += sum(expected.values())
    assert found > 50
