"""experta and CLIPS in lockstep, on random programs with fixed seeds and on the rule files that come with the project."""

from pathlib import Path

import pytest

pytest.importorskip("clips")

import lockstep

ROOT = Path(lockstep.__file__).parent.parent
BLOCKS, IN_BLOCK = 10, 30


@pytest.mark.parametrize("block", range(BLOCKS))
def test_random_programs(block: int) -> None:
    total = lockstep.Tally()
    for seed in range(block * IN_BLOCK, (block + 1) * IN_BLOCK):
        tally, fault = lockstep.lockstep(seed)
        assert fault is None, f"seed {seed}: {fault}"
        total.add(tally)
    assert total.refused < IN_BLOCK / 5
    assert total.firings > 60
    assert total.activations > 300
