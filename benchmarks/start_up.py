"""How long `ski --help` takes as a process, against an empty Python in the same run.

python benchmarks/start_up.py
"""

import subprocess
import sys
from statistics import median
from time import perf_counter

ROUNDS = 11


def seconds(*arguments: str) -> float:
    """Return how long a Python process with these arguments lives."""
    started = perf_counter()
    subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)
    return perf_counter() - started


def main() -> None:
    helped, empty = [], []
    for _ in range(ROUNDS):
        helped.append(seconds("-m", "blackboard.command.main", "--help"))
        empty.append(seconds("-c", "pass"))
    ratio = median(helped) / median(empty)
    print(f"ski --help {median(helped):.3f} s, an empty Python {median(empty):.3f} s, ratio {ratio:.1f}")


if __name__ == "__main__":
    main()
