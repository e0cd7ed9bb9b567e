"""How well a mission knows where the robot is, in simulation: errors of the pose, and whether its covariance is honest.

python benchmarks/consistency.py [--mission M] [--world W] [--robot R] [--seeds N] [--duration S] [--set KEY=VALUE ...] [--jobs N]

One row a seed: position error (mean, max) and heading error (mean) of what the board believed at the time; the same of odometry
alone on the same drive; where the path is corrected at the end, its position error; NEES over (x, y, heading), averaged over
the instants at which a pose estimate was posted, the share of them within the 95 % bound, and whether the run is honest. What
NEES and honest mean, `blackboard/report/pose_scores.py` says.
"""

import argparse
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from math import degrees
from statistics import mean
from time import process_time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core a run

import numpy as np
import numpy.typing as npt

from blackboard.kinds import CORRECTED_PATH
from blackboard.mission import Mission, find_mission, load_mission, parse_settings
from blackboard.report.pose_log import PoseLog
from blackboard.report.pose_scores import BOUND, PathError, honesty, path_error
from blackboard.runner import Run, RunOptions


@dataclass(frozen=True)
class Outcome:
    """What became of one run."""

    seed: int
    driven_m: float
    believed: PathError
    odometry: PathError
    looking_back: PathError | None
    nees: npt.NDArray[np.float64]
    seconds: float


def simulate(mission: Mission, duration_s: float, seed: int) -> Outcome:
    """Run a mission once and score it."""
    started = process_time()
    run = Run(mission, RunOptions(seed=seed, strict=True))
    log = PoseLog(run)
    run.run(duration_s)
    truth = run.true_trajectory()
    assert truth is not None
    corrected = run.board.newest(CORRECTED_PATH)
    believed, odometry = path_error(run.trajectory(), truth), path_error(log.odometry(), truth)
    assert believed is not None
    assert odometry is not None
    return Outcome(
        seed=seed,
        driven_m=float(run.robot.summary()["distance_m"]),
        believed=believed,
        odometry=odometry,
        looking_back=path_error(corrected.value.poses.unpack(), truth) if corrected is not None else None,
        nees=log.nees(truth),
        seconds=process_time() - started,
    )


def run_all(mission: Mission, duration_s: float, seeds: Sequence[int], jobs: int) -> list[Outcome]:
    """Run a mission with each seed, several at a time; print a row as soon as it and all before it are there."""
    outcomes = []
    with ProcessPoolExecutor(max_workers=jobs) as pool:
        for outcome in pool.map(partial(simulate, mission, duration_s), seeds):
            outcomes.append(outcome)
            print(row(outcome), flush=True)
    return outcomes


HEAD = (
    "seed    m driven | error m   max m   deg | odometry m   max m   deg | looking back m |  NEES   inside 95 %  instants  honest |"
    " s CPU"
)


def row(outcome: Outcome) -> str:
    """Return one line of the table."""
    told = honesty(outcome.nees)
    back = "-" if outcome.looking_back is None else f"{outcome.looking_back.mean_m:.3f}"
    covariance = f"{'-':>6}{'-':>14}{'-':>10}{'-':>8}"
    if told is not None:
        verdict = "yes" if told.honest else "no"
        covariance = f"{told.nees_mean:6.1f}{100 * told.inside_fraction:14.1f}{told.instants:10}{verdict:>8}"
    return (
        f"{outcome.seed:4}{outcome.driven_m:12.0f} |{_errors(outcome.believed, 8)} |{_errors(outcome.odometry, 11)} |"
        f"{back:>15} |{covariance} |{outcome.seconds:6.0f}"
    )


def _errors(error: PathError, width: int) -> str:
    return f"{error.mean_m:{width}.3f}{error.max_m:8.3f}{degrees(error.heading_mean_rad):6.2f}"


def summary(outcomes: Sequence[Outcome]) -> str:
    """Return what the runs tell together."""
    believed, odometry = mean(o.believed.mean_m for o in outcomes), mean(o.odometry.mean_m for o in outcomes)
    better = sum(o.believed.mean_m <= o.odometry.mean_m / 2 for o in outcomes)
    lines = [
        f"position error: mean {believed:.3f} m, worst {max(o.believed.max_m for o in outcomes):.3f} m, "
        f"{believed / odometry:.2f} of odometry's {odometry:.3f} m; at most half of it in {better} of {len(outcomes)} runs",
        f"heading error: mean {degrees(mean(o.believed.heading_mean_rad for o in outcomes)):.2f} degrees, "
        f"odometry's {degrees(mean(o.odometry.heading_mean_rad for o in outcomes)):.2f}",
    ]
    if all(o.looking_back is not None for o in outcomes):
        lines.append(
            f"looking back: mean {mean(o.looking_back.mean_m for o in outcomes if o.looking_back is not None):.3f} m"
        )
    told = honesty(np.concatenate([o.nees for o in outcomes]))
    if told is None:
        lines.append("NEES: no pose estimate was posted")
    else:
        honest = [h.honest for h in (honesty(o.nees) for o in outcomes) if h is not None]
        lines.append(
            f"NEES: {told.nees_mean:.1f} on average (3 where honest), {100 * told.inside_fraction:.1f} % of {told.instants} "
            f"instants within {BOUND:.2f}; {sum(honest)} of {len(honest)} runs honest"
        )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="explore-lab-lines")
    parser.add_argument("--world", help="over the mission's")
    parser.add_argument("--robot", help="over the mission's")
    parser.add_argument("--seeds", type=int, default=5, help="how many, from --first on")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--duration", type=float, default=600.0, metavar="S")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    settings = parse_settings(options.set)
    robot = {"odometry_errors": True, **settings.get("robot", {})}
    robot |= {key: value for key in ("world", "robot") if (value := getattr(options, key)) is not None}
    mission = load_mission(find_mission(options.mission), {**settings, "robot": robot})
    print(f"{options.mission}, {options.seeds} seeds x {options.duration:g} s {options.set or ''}\n{HEAD}")
    seeds = range(options.first, options.first + options.seeds)
    print(summary(run_all(mission, options.duration, seeds, options.jobs)))


if __name__ == "__main__":
    main()
