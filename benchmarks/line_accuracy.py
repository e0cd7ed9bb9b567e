"""How good the lines are after ten simulated minutes of explore-lab with exact odometry, by either method, and what they cost.

python benchmarks/line_accuracy.py [--seeds N] [--robot R] [--method M] [--people] [WORLD ...]

Found: of the wall length that was visible, what lies within 5 cm and 3 degrees of a line. Spurious: of the length of all lines,
what lies on no wall (`blackboard/report/scores.py`). A batch's CPU time is also given as a ratio to a plain Hough transform of 500
points in numpy, 360 angles each, measured in the same run.
"""

import argparse
import os
from statistics import mean
from time import process_time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core

import numpy as np

from blackboard.entry import Entry
from blackboard.kinds import LINE
from blackboard.messages.world import PointSet
from blackboard.mission import find_mission, load_mission
from blackboard.report.scores import line_score, sensing_range_m
from blackboard.runner import Run, RunOptions

DURATION_S = 600.0
HEADINGS = ("visible m", "found %", "lines", "lines m", "spurious %", "batches", "ms/batch", "x baseline")


def baseline_s(times: int = 50) -> float:
    """Return what the votes of 500 points in 360 directions cost in plain numpy."""
    rng = np.random.default_rng(1)
    points = rng.uniform(-4, 4, (500, 2))
    angles = np.deg2rad(np.arange(360))
    started = process_time()
    for _ in range(times):
        rho = points[:, :1] * np.cos(angles) + points[:, 1:] * np.sin(angles)
        bins = (rho / 0.05).astype(np.intp)
        near = (rho >= 0) & (bins < 200)
        np.bincount((np.arange(360) * 200 + bins)[near], minlength=360 * 200)
    return (process_time() - started) / times


def figures(world: str, seed: int, options: argparse.Namespace) -> list[float]:
    """Run explore-lab once; return its figures in the order of HEADINGS."""
    settings = {
        "robot": {"world": world, "robot": options.robot, "people": options.people, "odometry_errors": False},
        "line_finder": {"method": options.method},
    }
    run = Run(load_mission(find_mission("explore-lab"), settings), RunOptions(seed=seed, strict=True))
    finder = next(source for source in run.sources if source.name == "line_finder")
    spent: list[float] = []
    activate = finder.activate

    def timed(trigger: Entry[PointSet], board: object) -> None:
        started = process_time()
        activate(trigger, board)  # type: ignore[arg-type]
        spent.append(process_time() - started)

    finder.activate = timed  # type: ignore[method-assign]
    run.run(DURATION_S)
    truth, path = run.robot.truth(), run.true_trajectory()
    assert truth is not None
    assert path is not None
    lines = [entry.value for entry in run.board.entries(LINE)]
    score = line_score(lines, truth, path, sensing_range_m(run.robot.description))
    found, spurious = 100.0 * (score.found_fraction or 0.0), 100.0 * (score.spurious_fraction or 0.0)
    batch_s = mean(spent) if spent else 0.0
    return [
        score.visible_m, found, len(lines), score.lines_m, spurious, len(spent), 1e3 * batch_s, batch_s / baseline_s()
    ]  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("worlds", nargs="*", default=["lab"])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--robot", default="k2a")
    parser.add_argument("--method", default="tangent", choices=("tangent", "axis"))
    parser.add_argument("--people", action="store_true")
    options = parser.parse_args()
    print(f"{'world':10}{'seed':>6}" + "".join(f"{heading:>12}" for heading in HEADINGS))
    for world in options.worlds:
        rows = []
        for seed in range(options.seeds):
            rows.append(figures(world, seed, options))
            print(f"{world:10}{seed:6}" + "".join(f"{figure:12.1f}" for figure in rows[-1]), flush=True)
        means = [mean(column) for column in zip(*rows, strict=True)]
        print(f"{world:10}{'mean':>6}" + "".join(f"{figure:12.1f}" for figure in means))


if __name__ == "__main__":
    main()
