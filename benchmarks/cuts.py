"""Two machines, the cable between them pulled in mid-mission: what is lost, and does the robot stand while it is cut off?

python benchmarks/cuts.py [--mission M] [--together] [--cuts 2 6 20] [--pace P]

Two network namespaces with a cable between them (as root, with iproute2): in one the keeper, the knowledge sources, the rules and
the behaviours, in the other the robot (`--together`: robot and behaviours in one process, which goes on driving). The keeper
listens on the cable, with keys. The cable is pulled for each of the times. A row for each: when, for how long; after which time the
robot was told to stand, and after which its wheels stood, by its own posts, handed in later; how far it drove meanwhile; after
which time it went on once the cable was in again. All in mission seconds. Under the table how the mission ended, what was posted,
and what of it the keeper has not got.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from cut_off import clock_at, cut_off, moves
from deployment import CHECKOUT, HOSTS, Deployment, Processes
from namespaces import NEAR_ADDRESS, Cable, plug, pull, why_not
from trial import TRIAL, run_to_end

PORT = 7447  # nobody else is in the namespace
LIMIT_S = 1800.0
TOGETHER = ('hosts.robot.runs=["robot", "behaviours"]',)
MUST_STAND_S = 0.5
ROLES = {"robot": "robot", "behaviours": "robot", "knowledge_sources": "knowledge", "rules": "planner", TRIAL: "viewer"}
HEAD = "cut at s   for s   told to stand s   wheels stood s   driven m   went on s"


def make_keys(folder: Path, robot: str) -> dict[str, Path]:
    """Make keys for the keeper and every process; return where they are."""
    ski = [sys.executable, "-m", "blackboard.command.main", "keys"]
    _run([*ski, "init", str(folder), "--host", NEAR_ADDRESS])
    for name, role in ROLES.items():
        _run([*ski, "add", str(folder), role, name, *(["--robot", robot] if role == "robot" else [])])
    return {"keeper": folder, **{name: folder / "members" / name for name in ROLES}}


def trial(options: argparse.Namespace, folder: Path) -> bool:
    """Run the mission inside the near namespace; print what became of it, and return whether all is as it must be."""
    deployment = Deployment(
        folder=folder,
        address=f"tls/{NEAR_ADDRESS}:{PORT}",
        mission=options.mission,
        pace=options.pace,
        keys=make_keys(folder / "keys", "k2a"),
        inside={"robot": options.inside[1]},
        settings=TOGETHER if options.together else (),
        hosts=("robot", "knowledge_sources", "rules") if options.together else HOSTS,
    )
    times: list[tuple[float, float]] = []  # wall clock: pulled, plugged
    acts: list[tuple[float, Callable[[], None]]] = []
    at_s = options.first
    for for_s in options.cuts:

        def cut() -> None:
            pull(options.inside[0])
            times.append((time.time(), 0.0))

        def heal() -> None:
            plug(options.inside[0])
            times[-1] = (times[-1][0], time.time())

        acts += [(at_s, cut), (at_s + for_s * options.pace, heal)]
        at_s += for_s * options.pace + options.rest
    with Processes(deployment) as processes:
        report = run_to_end(processes, acts, limit_s=options.duration)
        drives, readings = moves(deployment.journal, deployment.robot)
    outcome, account = report.outcome, report.account
    good = not (account.lost or outcome.collisions or account.in_outboxes)
    for pulled_s, plugged_s in times:
        from_s, until_s = (clock_at(deployment.journal, wall_s) for wall_s in (pulled_s, plugged_s))
        found = cut_off(drives, readings, from_s, until_s)
        shown = [_shown(s) for s in (found.told_to_stand_s, found.wheels_stood_s, found.driven_m, found.went_on_s)]
        print(f"{from_s:8.1f}{until_s - from_s:8.1f}{shown[0]:>18}{shown[1]:>17}{shown[2]:>11}{shown[3]:>12}")
        stood = found.told_to_stand_s is not None and found.told_to_stand_s <= MUST_STAND_S
        good = good and stood != options.together
        good = good and found.went_on_s is not None
    good = good and len(times) == len(options.cuts) and (outcome.state == "done" or options.duration < LIMIT_S)
    refused = f"; refused: {account.refused}" if account.refused else ""
    print(
        f"the mission: {outcome.state} after {outcome.time_s:.0f} s, {100 * outcome.aligned_fraction:.1f} % decided, "
        f"collisions: {outcome.collisions}\nlost: {account.lost} of {account.posted} posted; "
        f"still waiting: {account.in_outboxes}; missed by hosts: {account.missed}{refused}"
    )
    return good


def _shown(number: float | None) -> str:
    return "never" if number is None else f"{number:.2f}"


def _run(command: list[str]) -> None:
    subprocess.run(
        command, check=True, stdout=subprocess.DEVNULL, cwd=CHECKOUT, env={**os.environ, "PYTHONPATH": str(CHECKOUT)}
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="explore-lab")
    parser.add_argument("--together", action="store_true", help="robot and behaviours are one process")
    parser.add_argument("--cuts", nargs="+", type=float, default=[2.0, 6.0, 20.0], metavar="S")
    parser.add_argument("--first", type=float, default=30.0, metavar="S", help="when, mission seconds")
    parser.add_argument("--rest", type=float, default=25.0, metavar="S", help="between two cuts")
    parser.add_argument("--pace", type=float, default=1.0, help="mission seconds per second")
    parser.add_argument("--duration", type=float, default=LIMIT_S, help="mission seconds at most", metavar="S")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave journals and logs here")
    parser.add_argument("--inside", nargs=2, metavar=("NEAR", "FAR"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.inside:
        with tempfile.TemporaryDirectory() as passing:
            raise SystemExit(0 if trial(options, (options.keep or Path(passing)) / "cuts") else 1)
    reason = why_not()
    if reason:
        raise SystemExit(f"not possible here: {reason}")
    far = "robot and behaviours, in one process" if options.together else "robot"
    print(f"{options.mission}, pace {options.pace:g}, on the other machine: {far}\n{HEAD}", flush=True)
    with Cable() as cable:
        inside = ["ip", "netns", "exec", cable.near, sys.executable, __file__, "--inside", cable.near, cable.far]
        raise SystemExit(subprocess.run([*inside, *sys.argv[1:]], check=False).returncode)


if __name__ == "__main__":
    main()
