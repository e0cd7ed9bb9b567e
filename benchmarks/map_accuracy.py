"""How good the map of the lab is after ten simulated minutes of wander-lab, seed by seed and in the mean.

python benchmarks/map_accuracy.py [--seeds N] [--world W] [--robot R]

Four tables: the shipped settings, and the plain scheme of Bou-Ghannam 1992, section 5.2 (cones of 10 m whose arcs are raised
alike, nothing filtered, lines through the points on the cones' axes), both with exact odometry, so that they show what the map
builder does; then the shipped settings with the odometry's errors, which nobody corrects; then explore-lab-joint, which does.
What is right, `blackboard/report/scores.py` says.
"""

import argparse
import os
from collections.abc import Mapping
from pathlib import Path
from statistics import mean
from time import process_time
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core

from blackboard.command.gather import gather
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions

DURATION_S = 600.0
COLUMNS = (  # key in the run's table, heading, factor
    ("grid_right_fraction", "grid right %", 100.0),
    ("reachable_decided_fraction", "floor decided %", 100.0),
    ("walls_found_fraction", "walls found %", 100.0),
    ("lines_spurious_fraction", "lines spurious %", 100.0),
    ("lines", "lines", 1.0),
)
PLAIN: Mapping[str, Mapping[str, Any]] = {
    "eou_grid": {"share": 0.0, "shadow": False, "sonar_range_m": 10.0},
    "filter_raw": {"use_grid": False},
    "line_finder": {"method": "axis"},
}


def figures(seed: int, settings: Mapping[str, Mapping[str, Any]], mission: str) -> list[float]:
    """Run the mission once; return its figures in the order of COLUMNS (0 where there are no lines), and CPU seconds."""
    started = process_time()
    run = Run(load_mission(find_mission(mission), settings), RunOptions(seed=seed, strict=True))
    run.run(DURATION_S)
    table = gather(run, mission).table
    return [float(table.get(key, 0.0)) * factor for key, _, factor in COLUMNS] + [process_time() - started]


def show(title: str, seeds: int, settings: Mapping[str, Mapping[str, Any]], mission: str = "wander-lab") -> None:
    """Print one table."""
    print(f"\n{title}")
    print("seed  " + "".join(f"{heading:>18}" for _, heading, _ in COLUMNS) + f"{'s CPU':>10}")
    rows = []
    for seed in range(seeds):
        rows.append(figures(seed, settings, mission))
        print(
            f"{seed:4}  " + "".join(f"{figure:18.1f}" for figure in rows[-1][:-1]) + f"{rows[-1][-1]:10.1f}", flush=True
        )
    means = [mean(column) for column in zip(*rows, strict=True)]
    print("mean  " + "".join(f"{figure:18.1f}" for figure in means[:-1]) + f"{means[-1]:10.1f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--world", type=Path, default=Path("lab"))
    parser.add_argument("--robot", type=Path, default=Path("k2a"))
    parser.add_argument("--only", choices=("shipped", "plain", "errors", "joint"), help="one of the tables")
    options = parser.parse_args()
    robot = {"world": str(options.world), "robot": str(options.robot)}
    exact, wrong = {**robot, "odometry_errors": False}, {**robot, "odometry_errors": True}
    if options.only in (None, "shipped"):
        show("Shipped settings, exact odometry", options.seeds, {"robot": exact})
    if options.only in (None, "plain"):
        show("Plain scheme of the thesis, exact odometry", options.seeds, {"robot": exact, **PLAIN})
    if options.only in (None, "errors"):
        show("Shipped settings, odometry with errors", options.seeds, {"robot": wrong})
    if options.only in (None, "joint"):
        show(
            "Pose and lines in one estimate, odometry with errors", options.seeds, {"robot": wrong}, "explore-lab-joint"
        )


if __name__ == "__main__":
    main()
