"""How right the corners are, against the true floor: ten simulated minutes of explore-lab-symbols in each world.

python benchmarks/corners.py [--seeds N]

A corner is right within 15 cm of a true one of its shape; asked for are true corners whose sides are at least 0.4 m. They can
be found where a line stands for either side, which the fourth column counts: the rest nobody has heard well enough.
"""

import argparse
import os
from statistics import mean

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core

import shapely

from blackboard.kinds import CORNER, LINE
from blackboard.mission import find_mission, load_mission
from blackboard.report.corner_scores import KNOWN_SIDE_M, SIDE_M, true_corners
from blackboard.report.result import segments
from blackboard.runner import Run, RunOptions

WORLDS = ("lab", "office", "trap")
BESIDE_M = 0.05  # a line stands for a side within this distance of it


def figures(world: str, seed: int) -> list[int]:
    """Return how many corners there are, are right, are asked for, could be found, and how many of these were."""
    run = Run(
        load_mission(find_mission("explore-lab-symbols"), {"robot": {"world": world}}),
        RunOptions(seed=seed, strict=True),
    )
    run.run(600.0)
    truth = run.robot.truth()
    if truth is None:
        raise SystemExit(f"{world} has no truth")
    found = [entry.value for entry in run.board.entries(CORNER)]
    walls = shapely.multilinestrings(
        shapely.linestrings(segments([entry.value for entry in run.board.entries(LINE)]).reshape(-1, 2, 2))
    )
    known, asked = true_corners(truth, KNOWN_SIDE_M), true_corners(truth, SIDE_M)
    could = [true for true in asked if all(walls.distance(shapely.Point(place)) <= BESIDE_M for place in true.beside)]
    return [
        len(found),
        sum(any(true.is_met(corner) for true in known) for corner in found),
        len(asked),
        len(could),
        sum(any(true.is_met(corner) for corner in found) for true in could),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    options = parser.parse_args()
    print(f"mean of {options.seeds} seeds x 10 minutes")
    print(f"{'world':8}{'corners':>9}{'right %':>9}{'asked for':>11}{'could be found':>16}{'of these found %':>18}")
    for world in WORLDS:
        rows = [figures(world, seed) for seed in range(options.seeds)]
        count, right, asked, could, of_these = (mean(column) for column in zip(*rows, strict=True))
        shares = [100.0 * part / whole if whole else 0.0 for part, whole in ((right, count), (of_these, could))]
        print(f"{world:8}{count:9.1f}{shares[0]:9.1f}{asked:11.1f}{could:16.1f}{shares[1]:18.1f}", flush=True)


if __name__ == "__main__":
    main()
