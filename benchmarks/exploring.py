"""Exploring to the end: does it finish by itself, what has it decided of the floor, did it touch anything, how long did it take.

python benchmarks/exploring.py [--mission M] [--world W ...] [--seeds N] [--duration S] [--reflexes [N]] [--disturbed] [--jobs N]

One row a seed: how the mission ended and when, the share of the reachable floor that the grid decided, as the map lies and
with the world laid on it (docs/outputs.md),
contacts that the robot caused, the largest and the last error of its pose, the run's pace (simulated seconds a second of CPU,
journal written, no pictures). With --reflexes beside each run the same mission without its rules, for the same time: curiosity,
boundary following and random wander are selected, and nothing decides. With --disturbed a chair is put in the robot's way, a
person stands in a passage for a minute, and a door closes for good, at times and places drawn with the seed
(sim/disturbances.py); what can be reached is then what can be from where the robot ends. Odometry errors are on; with --set
robot.drawn_odometry=true each seed has wheels of its own. In the world "random" each seed has a floor plan of its own.
"""

import argparse
import os
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from math import hypot
from pathlib import Path
from statistics import median
from time import process_time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core a run

from blackboard.command.gather import gather
from blackboard.component import Trigger
from blackboard.journal import FILE_NAME, JournalWriter
from blackboard.kinds import MISSION, MOTIVATION
from blackboard.mission import Mission, Spec, find_mission, load_mission, parse_settings
from blackboard.runner import Run, RunOptions
from sim.world_by_name import RANDOM

REFLEXES = ("curiosity", "boundary_following", "random_wander")  # what moves the robot where nothing decides
MOST_JOBS = 2
MANY = 1_000_000


@dataclass(frozen=True)
class Outcome:
    """What became of one run."""

    state: str  # done, given up, or underway when the time was over
    detail: str
    time_s: float
    seconds: float  # of CPU
    decided_fraction: float
    aligned_fraction: float  # with the world laid on the map
    collisions: int
    error_max_m: float
    error_last_m: float
    ends: tuple[float, float]  # where the robot stands, m
    disturbances: str


def without_rules(mission: Mission) -> Mission:
    """Return a mission whose reflexes are left to themselves, without the sources that wait for motivations."""
    return replace(
        mission,
        rules=None,
        behaviours=tuple(_left_alone(spec) for spec in mission.behaviours),
        knowledge_sources=tuple(spec for spec in mission.knowledge_sources if not _waits_for_rules(spec)),
    )


def _waits_for_rules(spec: Spec) -> bool:
    triggers = spec.build(0).triggers
    return MOTIVATION in [t.kind if isinstance(t, Trigger) else t for t in triggers]


def _left_alone(spec: Spec) -> Spec:
    """Return a reflex as it is when it is selected and nothing holds it back; any other behaviour as it was."""
    wired = replace(spec.wiring, selected=True, gain=1.0, threshold=0.0)
    return replace(spec, wiring=wired) if spec.name in REFLEXES else spec


def explore(mission: Mission, duration_s: float, seed: int) -> Outcome:
    """Run a mission once, to its own end or for this long, and score it."""
    with tempfile.TemporaryDirectory() as folder, JournalWriter(Path(folder) / FILE_NAME) as journal:
        started = process_time()
        run = Run(mission, RunOptions(seed=seed, strict=True))
        run.board.journal = journal
        run.run(duration_s)
        seconds = process_time() - started
    result = gather(run, mission.name)
    status = run.board.newest(MISSION)
    truth, believed = result.true_trajectory, result.trajectory
    assert truth is not None
    x_m, y_m = float(truth[-1, 1]), float(truth[-1, 2])
    return Outcome(
        state="no end" if status is None else status.value.state,
        detail="" if status is None else status.value.detail,
        time_s=float(truth[-1, 0]),
        seconds=seconds,
        decided_fraction=float(result.table.get("reachable_decided_fraction", 0.0)),
        aligned_fraction=float(result.table.get("reachable_decided_aligned_fraction", 0.0)),
        collisions=int(result.table["collisions"]),
        error_max_m=float(result.table["pose_error_max_m"]),
        error_last_m=hypot(float(believed[-1, 1]) - x_m, float(believed[-1, 2]) - y_m),
        ends=(x_m, y_m),
        disturbances=str(result.table.get("disturbances", "")),
    )


def explore_twice(mission: Mission, duration_s: float, beside: int, seed: int) -> tuple[Outcome, Outcome | None]:
    """Run a mission, and for the seeds below `beside` the same for the same time without its rules."""
    if mission.robot.params.world == RANDOM:
        mission = replace(mission, robot=replace(mission.robot, params=replace(mission.robot.params, world_seed=seed)))
    outcome = explore(mission, duration_s, seed)
    return outcome, explore(without_rules(mission), outcome.time_s, seed) if seed < beside else None


HEAD = (
    "seed  ended          time s   decided %   aligned %  collisions   error m max  last   pace x |"
    "  reflexes: decided %  collisions |"
    " stands at"
)


def row(seed: int, outcome: Outcome, alone: Outcome | None) -> str:
    """Return one line of the table."""
    beside = f"{'-':>20}{'-':>12}"
    if alone is not None:
        beside = f"{100 * alone.decided_fraction:20.1f}{alone.collisions:12}"
    told = "" if outcome.state == "done" else f"  {outcome.detail}"
    told += f"  {outcome.disturbances}" if outcome.disturbances else ""
    return (
        f"{seed:4}  {outcome.state:12}{outcome.time_s:9.1f}{100 * outcome.decided_fraction:12.1f}"
        f"{100 * outcome.aligned_fraction:12.1f}{outcome.collisions:12}"
        f"{outcome.error_max_m:14.2f}{outcome.error_last_m:6.2f}{outcome.time_s / outcome.seconds:9.0f} |{beside} |"
        f" ({outcome.ends[0]:.1f}, {outcome.ends[1]:.1f}){told}"
    )


def summary(outcomes: Sequence[tuple[Outcome, Outcome | None]]) -> str:
    """Return what the runs tell together."""
    runs = [outcome for outcome, _ in outcomes]
    alone = [outcome for _, outcome in outcomes if outcome is not None]
    times = [run.time_s for run in runs]
    lines = [
        f"finished by itself: {sum(run.state == 'done' for run in runs)} of {len(runs)}; "
        f"collisions: {sum(run.collisions for run in runs)}; reachable decided: {_shares(runs)}",
        f"simulated time: median {median(times):.0f} s, longest {max(times):.0f} s; "
        f"pace: median {median(run.time_s / run.seconds for run in runs):.0f} x real time on one core",
    ]
    if alone:
        lines.append(
            f"without rules, for the same time: collisions: {sum(run.collisions for run in alone)}; "
            f"reachable decided: {_shares(alone)}"
        )
    return "\n".join(lines)


def _shares(runs: Sequence[Outcome]) -> str:
    shares, aligned = [run.decided_fraction for run in runs], [run.aligned_fraction for run in runs]
    return (
        f"median {100 * median(shares):.1f} %, least {100 * min(shares):.1f} %"
        f" (aligned {100 * median(aligned):.1f}, {100 * min(aligned):.1f})"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="explore-lab")
    parser.add_argument("--world", nargs="+", default=["lab"])
    parser.add_argument("--seeds", type=int, default=20, help="how many, from --first on")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--duration", type=float, default=3600.0, metavar="S", help="given up then")
    parser.add_argument(
        "--reflexes",
        type=int,
        nargs="?",
        const=MANY,
        default=0,
        metavar="N",
        help="also without rules, for the same time: the first N seeds (all unless told)",
    )
    parser.add_argument("--disturbed", action="store_true", help="with a chair, a person and a door in the way")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--jobs", type=int, default=MOST_JOBS, choices=range(1, MOST_JOBS + 1))
    options = parser.parse_args()
    settings = parse_settings(options.set)
    seeds = range(options.first, options.first + options.seeds)
    for world in options.world:
        robot = {"odometry_errors": True, **settings.get("robot", {}), "world": world}
        if options.disturbed:
            robot["disturbances"] = ["chair", "person", "door"]
        mission = load_mission(find_mission(options.mission), {**settings, "robot": robot})
        print(f"{options.mission} in {world}, {options.seeds} seeds {' '.join(options.set)}\n{HEAD}", flush=True)
        outcomes = []
        with ProcessPoolExecutor(max_workers=options.jobs) as pool:
            beside = options.first + options.reflexes
            ran = pool.map(partial(explore_twice, mission, options.duration, beside), seeds)
            for seed, (outcome, alone) in zip(seeds, ran, strict=True):
                outcomes.append((outcome, alone))
                print(row(seed, outcome, alone), flush=True)
        print(f"{summary(outcomes)}\n", flush=True)


if __name__ == "__main__":
    main()
