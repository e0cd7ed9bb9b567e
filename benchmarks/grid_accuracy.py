"""How much of what the grid decided is right after ten simulated minutes, exact odometry: occupied and empty cells apart.

python benchmarks/grid_accuracy.py [--seeds N] [--robot R] [--people] [--plain] [WORLD ...]

An occupied cell is right within 10 cm of a surface, an empty one on free floor (`blackboard/report/scores.py`). `--plain` takes
the scheme of Bou-Ghannam 1992, section 5.2.1 as it stands: echoes up to 10 m, all of an arc raised alike, no shadows.
"""

import argparse
import os
from statistics import mean
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core

from blackboard.grid import Grid
from blackboard.kinds import GRID
from blackboard.mission import find_mission, load_mission
from blackboard.report.scores import area_decided, grid_score
from blackboard.runner import Run, RunOptions

DURATION_S = 600.0
HEADINGS = ("decided", "right %", "occupied", "right %", "empty", "right %", "floor decided %")
PLAIN = {"share": 0.0, "shadow": False, "sonar_range_m": 10.0}


def figures(world: str, seed: int, options: argparse.Namespace) -> list[float]:
    """Run explore-lab once; return its figures in the order of HEADINGS."""
    settings: dict[str, dict[str, Any]] = {
        "robot": {"world": world, "robot": options.robot, "people": options.people, "odometry_errors": False},
        "eou_grid": PLAIN if options.plain else {},
    }
    run = Run(load_mission(find_mission("explore-lab"), settings), RunOptions(seed=seed, strict=True))
    start, truth = run.robot.true_pose(), run.robot.truth()
    run.run(DURATION_S)
    grid = Grid.from_tiles(entry.value for entry in run.board.entries(GRID))
    assert start is not None
    assert truth is not None
    assert grid is not None
    score = grid_score(grid, truth)
    right = [score.right_fraction, score.occupied_right_fraction, score.empty_right_fraction]
    right += [area_decided(grid, truth, start, run.robot.description.radius_m)]
    percent = [100.0 * (fraction or 0.0) for fraction in right]
    return [score.decided, percent[0], score.occupied, percent[1], score.empty, percent[2], percent[3]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("worlds", nargs="*", default=["lab"])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--robot", default="k2a")
    parser.add_argument("--people", action="store_true")
    parser.add_argument("--plain", action="store_true")
    options = parser.parse_args()
    print(f"{'world':10}{'seed':>6}" + "".join(f"{heading:>17}" for heading in HEADINGS))
    for world in options.worlds:
        rows = []
        for seed in range(options.seeds):
            rows.append(figures(world, seed, options))
            print(f"{world:10}{seed:6}" + "".join(f"{figure:17.1f}" for figure in rows[-1]), flush=True)
        means = [mean(column) for column in zip(*rows, strict=True)]
        print(f"{world:10}{'mean':>6}" + "".join(f"{figure:17.1f}" for figure in means))


if __name__ == "__main__":
    main()
