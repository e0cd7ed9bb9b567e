"""A rule file is changed while the robot runs: how long rules are away, whether a fact is lost, whether the reflexes miss a cycle.

python benchmarks/reload.py [--mission M] [--times N] [--engine experta|clips]

The rule files of a mission are copied, one of them is changed every five seconds of the mission, and each cycle is measured: the
time of the cycle in which the changed rules took over, beside the median of the others, in the same run.
"""

import argparse
import os
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from blackboard.kinds import DRIVE, FACT, RULES
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions
from rules.rule_files import find_rule_file

BETWEEN = 50  # cycles


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="explore-lab")
    parser.add_argument("--times", type=int, default=20)
    parser.add_argument("--engine", default="experta")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        named = load_mission(find_mission(options.mission)).rules
        assert named is not None
        copies = []
        for path in named.params.files:
            copies.append(Path(folder) / find_rule_file(path).name)
            copies[-1].write_text(find_rule_file(path).read_text(encoding="utf-8"), encoding="utf-8")
        settings = {"rules": {"files": [str(path) for path in copies], "engine": options.engine}}
        run = Run(load_mission(find_mission(options.mission), settings), RunOptions(seed=2, strict=True))
        drives: list[float] = []
        run.board.subscribe(run.board.key(DRIVE), lambda entry: drives.append(entry.stamp_s))
        plain, taking, lost, taken = [], [], 0, 1
        for cycle in range((options.times + 1) * BETWEEN):
            if cycle and cycle % BETWEEN == 0:
                text = copies[cycle // BETWEEN % len(copies)]
                text.write_text(text.read_text(encoding="utf-8") + f"\n; change {cycle}\n", encoding="utf-8")
            before = {entry.value.fact for entry in run.board.entries(FACT)}
            started = perf_counter()
            run.cycle()
            took = perf_counter() - started
            rules = run.board.newest(RULES)
            assert rules is not None
            if rules.revision > taken:
                taken = rules.revision
                taking.append(took)
                lost += len(
                    {f for f in before if not f.startswith("(candidate")}
                    - {e.value.fact for e in run.board.entries(FACT)}
                )
            else:
                plain.append(took)
        run.close()
    missed = (options.times + 1) * BETWEEN - len(set(drives))
    print(f"{options.mission} on {options.engine}: {len(taking)} changed files took over")
    print(f"the cycle that changed rules: median {1000 * median(taking):.0f} ms, longest {1000 * max(taking):.0f} ms")
    print(f"any other cycle: median {1000 * median(plain):.1f} ms; ratio {median(taking) / median(plain):.0f}")
    print(f"facts lost: {lost}; cycles without a command to the wheels: {missed}")


if __name__ == "__main__":
    main()
