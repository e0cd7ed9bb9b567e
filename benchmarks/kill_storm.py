"""kill -9 again and again, whichever process the dice show, while others are just starting: is anything lost?

python benchmarks/kill_storm.py [--mission M] [--pace P] [--runs N] [--every S] [--for S]

In each run a process is killed every so many seconds of the wall clock, for a stretch of the mission, sometimes two at once; then
the mission goes on to its end. A row each, as in kills.py, with the number of kills.
"""

import argparse
import random
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from deployment import HOSTS, KEEPER, Processes
from kills import HEAD, LIMIT_S, at_work, good, row
from trial import Report, run_to_end

FIRST_S = 20.0  # mission seconds: all are at work
TWICE = 0.3  # how likely another one dies in the same moment


def storm(processes: Processes, drawn: random.Random, every_s: float, for_s: float) -> tuple[Report, int]:
    """Run a mission through a storm of kills; return what became of it, and how many there were."""
    count = [0]

    def kill(names: list[str]) -> None:
        for name in names:
            processes.kill(name)
        for name in names:
            processes.start(name)
        count[0] += len(names)

    acts: list[tuple[float, Callable[[], None]]] = []
    at_s = FIRST_S
    while at_s < FIRST_S + for_s:
        names = drawn.sample([*HOSTS, KEEPER], 2 if drawn.random() < TWICE else 1)
        acts.append((at_s, partial(kill, names)))
        at_s += every_s * drawn.uniform(0.5, 1.5) * processes.deployment.pace
    with processes:
        return run_to_end(processes, acts, limit_s=LIMIT_S), count[0]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="explore-lab")
    parser.add_argument("--pace", type=float, default=1.0, help="mission seconds per second")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--every", type=float, default=4.0, metavar="S", help="of the wall clock, on average")
    parser.add_argument("--for", dest="for_s", type=float, default=200.0, metavar="S", help="mission seconds")
    parser.add_argument("--seed", type=int, default=0, help="of the dice")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave journals and logs here")
    options = parser.parse_args()
    drawn = random.Random(options.seed)
    print(f"{options.mission}, pace {options.pace:g}, a kill every {options.every:g} s\n{HEAD}", flush=True)
    reports = []
    for number in range(options.runs):
        with tempfile.TemporaryDirectory() as passing:
            folder = (options.keep or Path(passing)) / f"storm{number:02}"
            processes = at_work(options.mission, options.pace, folder, up=False)
            report, kills = storm(processes, drawn, options.every, options.for_s)
        reports.append(report)
        print(row(f"{kills} processes", None, report, None), flush=True)
    raise SystemExit(0 if all(good(report) for report in reports) else 1)


if __name__ == "__main__":
    main()
