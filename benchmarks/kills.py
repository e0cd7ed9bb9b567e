"""kill -9 of each process in turn, in mid-mission: does the mission finish, is anything lost, does the robot touch anything?

python benchmarks/kills.py [--mission M] [--pace P] [--rounds N] [--each NAME ...] [--seed S] [--up]

In each run one process is killed at a time drawn with the seed, and started again at once (with --up by the executor daemon of
`ski up`). A row each: which process, and when on the mission's clock; how the mission ended and when, and how much later than
without a kill (first row; no two runs are alike, since they are in real time); contacts that the robot caused; what was posted,
what of it the keeper has not got in the end (lost), what stands twice in its journal, what still waits in an outbox, and what
the boards of the hosts have missed.
"""

import argparse
import random
import tempfile
from pathlib import Path
from statistics import median

from deployment import HOSTS, KEEPER, Deployment, Processes, free_port, parts_of
from managed import ManagedDeployment, ManagedProcesses
from trial import Report, run_to_end

LIMIT_S = 1800.0  # mission seconds
EARLIEST_S, LATEST_S = 40.0, 220.0  # of a mission of some 300 s
HEAD = (
    "killed              at s  ended      time s   later s   aligned %   error m max  collisions |"
    "   posted  lost  twice  refused  waiting  missed  boots"
)


def row(name: str, at_s: float | None, report: Report, plain_s: float | None) -> str:
    """Return one line of the table."""
    outcome, account = report.outcome, report.account
    when = f"{at_s:7.0f}" if at_s is not None else "      -"
    later = f"{outcome.time_s - plain_s:10.1f}" if plain_s is not None else f"{'-':>10}"
    failed = f"  failed: {', '.join(outcome.failed)}" if outcome.failed else ""
    boots = sum(account.boots.values())
    return (
        f"{name:17}{when}  {outcome.state:9}{outcome.time_s:8.1f}{later}"
        f"{100 * outcome.aligned_fraction:12.1f}{outcome.error_max_m:14.2f}{outcome.collisions:12} |"
        f"{account.posted:9}{account.lost:6}{account.twice:7}{account.refused:9}{account.in_outboxes:9}{account.missed:8}{boots:7}{failed}"
    )


def at_work(mission: str, pace: float, folder: Path, up: bool) -> Processes:
    """Return the processes of a mission, those of `ski up` or our own."""
    robot, hosts = parts_of(mission)
    make = ManagedDeployment if up else Deployment
    address = f"tcp/127.0.0.1:{free_port()}"
    deployment = make(folder=folder, address=address, mission=mission, robot=robot, hosts=hosts, pace=pace)
    return ManagedProcesses(deployment) if isinstance(deployment, ManagedDeployment) else Processes(deployment)


def run(processes: Processes, name: str | None, at_s: float) -> Report:
    """Run a mission, kill a process on the way and start it again."""
    with processes:

        def kill() -> None:
            if name is not None:
                processes.kill(name)
                processes.start(name)

        return run_to_end(processes, [(at_s, kill)], limit_s=LIMIT_S)


def good(report: Report) -> bool:
    """Say whether a run is as it must be."""
    account = report.account
    return report.outcome.state == "done" and not (account.lost or account.in_outboxes or report.outcome.collisions)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="explore-lab")
    parser.add_argument("--pace", type=float, default=1.0, help="mission seconds per second")
    parser.add_argument("--rounds", type=int, default=4, help="how often each process is killed")
    parser.add_argument("--each", nargs="+", default=[*HOSTS, KEEPER], choices=[*HOSTS, KEEPER])
    parser.add_argument("--seed", type=int, default=0, help="of the times")
    parser.add_argument("--up", action="store_true", help="under `ski up`, whose executor starts again what dies")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave journals and logs here")
    options = parser.parse_args()
    drawn = random.Random(options.seed)
    runs = [(name, drawn.uniform(EARLIEST_S, LATEST_S)) for _ in range(options.rounds) for name in options.each]
    print(f"{options.mission}, pace {options.pace:g}\n{HEAD}", flush=True)
    reports: list[Report] = []
    for number, (name, at_s) in enumerate([(None, 0.0), *runs]):
        with tempfile.TemporaryDirectory() as passing:
            folder = (options.keep or Path(passing)) / f"{number:02}-{name or 'none'}"
            report = run(at_work(options.mission, options.pace, folder, options.up), name, at_s)
        reports.append(report)
        plain_s = reports[0].outcome.time_s
        print(row(name or "(none)", at_s if name else None, report, plain_s), flush=True)
    killed = reports[1:]
    print(
        f"finished: {sum(r.outcome.state == 'done' for r in killed)} of {len(killed)}; "
        f"lost: {sum(r.account.lost for r in killed)} of {sum(r.account.posted for r in killed)}; "
        f"collisions: {sum(r.outcome.collisions for r in killed)}; "
        f"later than without: median {median(r.outcome.time_s - plain_s for r in killed):.0f} s"
    )
    raise SystemExit(0 if all(good(report) for report in reports) else 1)


if __name__ == "__main__":
    main()
