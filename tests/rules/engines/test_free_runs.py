"""experta running by itself: the same firings whatever the hash seed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import random_programs

from rules.engines.engine import Firing
from rules.engines.experta_engine import ExpertaEngine
from rules.language.reader import read_text

PROGRAMS = 60


def run(seed: int) -> list[Firing]:
    """Run the program of a seed, fed with facts from outside."""
    writer = random_programs.Writer(seed)
    engine = ExpertaEngine(read_text(writer.program()))
    engine.reset()
    firings: list[Firing] = []
    for _ in range(10):
        for _ in range(15):
            firing = engine.fire()
            if firing is None:
                break
            firings.append(firing)
        engine.assert_fact(writer.fact())
    return firings


def test_the_hash_seed_changes_nothing() -> None:
    told = []
    for hash_seed in ("0", "1", "4242"):
        environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": os.pathsep.join(sys.path)}
        done = subprocess.run(
            [sys.executable, Path(__file__)], env=environment, capture_output=True, text=True, check=True, timeout=60
        )
        told.append(done.stdout)
    assert told[0].count("Firing(") > 50
    assert told[0] == told[1] == told[2]


@pytest.mark.parametrize("seed", range(3))
def test_a_second_run_is_the_same(seed: int) -> None:
    assert run(seed) == run(seed)


if __name__ == "__main__":
    for number in range(PROGRAMS):
        print(run(number))
