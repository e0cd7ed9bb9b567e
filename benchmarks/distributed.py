"""Exploring in five processes: does it end as in one, and is anything lost on the way?

python benchmarks/distributed.py [--mission M] [--pace P] [--seeds N]

For each seed the mission runs in one process (in lock-step, as `ski run`), then in five: keeper, robot, behaviours, knowledge
sources, rules, in real time times `--pace`. One row each: how the mission ended and when by its own clock, the share of the
reachable floor that the grid decided (as the map lies, and with the world laid on it), the largest error of the pose, contacts
that the robot caused; of the five what was posted, what the keeper has written down, what is missing of it, what waits in an
outbox, and what the boards of the hosts have missed.
"""

import argparse
import tempfile
from pathlib import Path

from deployment import Deployment, Processes, free_port, parts_of
from exploring import Outcome as Embedded
from exploring import explore
from trial import Report, run_to_end

from blackboard.mission import find_mission, load_mission

LIMIT_S = 1800.0  # mission seconds: six times what exploring the lab takes
HEAD = (
    "seed  processes  ended      time s   decided %   aligned %   error m max  collisions   wall s |"
    "  posted   written  missing  twice  refused  waiting  missed"
)


def embedded_row(seed: int, outcome: Embedded) -> str:
    """Return the line of a run in one process."""
    return (
        f"{seed:4}{1:11}  {outcome.state:9}{outcome.time_s:8.1f}{100 * outcome.decided_fraction:12.1f}"
        f"{100 * outcome.aligned_fraction:12.1f}{outcome.error_max_m:14.2f}{outcome.collisions:12}{outcome.seconds:9.1f} |"
    )


def row(seed: int, report: Report) -> str:
    """Return the line of a run in five."""
    outcome, account = report.outcome, report.account
    failed = f"  failed: {', '.join(outcome.failed)}" if outcome.failed else ""
    return (
        f"{seed:4}{5:11}  {outcome.state:9}{outcome.time_s:8.1f}{100 * outcome.decided_fraction:12.1f}"
        f"{100 * outcome.aligned_fraction:12.1f}{outcome.error_max_m:14.2f}{outcome.collisions:12}{report.seconds:9.1f} |"
        f"{account.posted:8}{account.written:10}{account.lost:9}{account.twice:7}{account.refused:9}"
        f"{account.in_outboxes:9}{account.missed:8}{failed}"
    )


def run(mission: str, pace: float, seed: int, folder: Path) -> Report:
    """Run a mission in five processes."""
    robot, hosts = parts_of(mission)
    address = f"tcp/127.0.0.1:{free_port()}"
    deployment = Deployment(
        folder=folder, address=address, mission=mission, robot=robot, hosts=hosts, pace=pace, seed=seed
    )
    with Processes(deployment) as processes:
        return run_to_end(processes, limit_s=LIMIT_S)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="explore-lab")
    parser.add_argument("--pace", type=float, default=1.0, help="mission seconds per second")
    parser.add_argument("--seeds", type=int, default=1, help="how many, from --first on")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave journals and logs here")
    options = parser.parse_args()
    print(f"{options.mission}, pace {options.pace:g}\n{HEAD}", flush=True)
    reports = []
    for seed in range(options.first, options.first + options.seeds):
        print(embedded_row(seed, explore(load_mission(find_mission(options.mission)), LIMIT_S, seed)), flush=True)
        with tempfile.TemporaryDirectory() as passing:
            report = run(options.mission, options.pace, seed, (options.keep or Path(passing)) / f"seed{seed}")
        reports.append(report)
        print(row(seed, report), flush=True)
    good = all(r.outcome.state == "done" and not r.account.lost and not r.outcome.collisions for r in reports)
    raise SystemExit(0 if good else 1)


if __name__ == "__main__":
    main()
