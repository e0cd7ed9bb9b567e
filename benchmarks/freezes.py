"""SIGSTOP for ten seconds, of each process in turn, of a reader that reads slowly, of a monitor: is anything lost, do others wait?

python benchmarks/freezes.py [--mission M] [--pace P] [--each NAME ...] [--for S]

One run of the mission to its end, in real time. Beside its five processes: `ski watch` (monitor), a reader of the whole board
that takes 50 ms for each message (slow reader), and a reader of readings and commands that notes when each came. A row for each
that was frozen: the longest time in which that reader got no reading, and no command, less the time between two of them, while
the other stood still and for three seconds after it; the first row is of such a stretch without anything frozen. Under the
table how the mission ended, what was posted, what of it the keeper has not got, and what the boards of the hosts have missed.
"""

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from board_reader import longest_gap_s
from deployment import CHECKOUT, HOSTS, KEEPER, Deployment, Processes, free_port
from trial import run_to_end

LIMIT_S = 3600.0  # mission seconds
CYCLE_S = 0.1  # between two readings, on the mission's clock
FIRST_S = 20.0  # all are at work
AFTER_S = 3.0  # looked at after the thaw
REST_S = 7.0  # then all is as before
MUST_S = 0.3
MONITOR, SLOW = "monitor", "slow reader"
NOBODY = "(nobody)"
HEAD = "frozen               at s   no reading for s   no command for s"


@dataclass
class Stretch:
    """Who was frozen, from when to when by the monotonic clock."""

    name: str
    at_s: float = 0.0
    from_s: float = 0.0
    until_s: float = 0.0


class Frozen:
    """Freezes one after the other while the mission runs."""

    def __init__(self, processes: Processes, names: list[str], for_s: float) -> None:
        self.stretches = [Stretch(name) for name in (NOBODY, *names)]
        pace = processes.deployment.pace
        self.acts: list[tuple[float, Callable[[], None]]] = []
        for number, stretch in enumerate(self.stretches):
            stretch.at_s = FIRST_S * pace + number * (for_s + AFTER_S + REST_S) * pace
            self.acts.append((stretch.at_s, lambda s=stretch: self._freeze(s)))  # type: ignore[misc]
            self.acts.append((stretch.at_s + for_s * pace, lambda s=stretch: self._thaw(s)))  # type: ignore[misc]
        self._processes = processes

    def _freeze(self, stretch: Stretch) -> None:
        stretch.from_s = time.monotonic()
        if stretch.name != NOBODY:
            self._processes.freeze(stretch.name)

    def _thaw(self, stretch: Stretch) -> None:
        if stretch.name != NOBODY:
            self._processes.thaw(stretch.name)
        stretch.until_s = time.monotonic()


def readers(deployment: Deployment, notes: Path) -> dict[str, list[str]]:
    """Return the commands of those who read along."""
    board = f"ski/{deployment.robot}"
    reader = [sys.executable, str(CHECKOUT / "benchmarks" / "board_reader.py"), deployment.address]
    watch = [sys.executable, "-m", "blackboard.command.main", "watch", "--connect", deployment.address, "--for", "3600"]
    return {
        MONITOR: watch,
        SLOW: [*reader, f"{board}/**", "--hold", "0.05"],
        "reader of readings": [*reader, f"{board}/observations/signal/odometry", "--notes", str(notes / "readings")],
        "reader of commands": [*reader, f"{board}/commands/drive", "--notes", str(notes / "commands")],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mission", default="explore-lab")
    parser.add_argument("--pace", type=float, default=1.0, help="mission seconds per second")
    everybody = [MONITOR, SLOW, "knowledge_sources", "rules", "behaviours", "robot", KEEPER]
    parser.add_argument("--each", nargs="+", default=everybody, choices=[*HOSTS, KEEPER, MONITOR, SLOW])
    parser.add_argument("--for", dest="for_s", type=float, default=10.0, metavar="S")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave journals and logs here")
    options = parser.parse_args()
    print(f"{options.mission}, pace {options.pace:g}, frozen for {options.for_s:g} s\n{HEAD}", flush=True)
    with tempfile.TemporaryDirectory() as passing:
        folder = (options.keep or Path(passing)) / "freezes"
        deployment = Deployment(
            folder=folder, address=f"tcp/127.0.0.1:{free_port()}", mission=options.mission, pace=options.pace
        )
        with Processes(deployment) as processes:
            frozen = Frozen(processes, options.each, options.for_s)
            begin = (0.0, lambda: _read_along(processes, readers(deployment, folder)))
            report = run_to_end(processes, [begin, *frozen.acts], limit_s=LIMIT_S)
        good = report.outcome.state == "done" and not (report.account.lost or report.outcome.collisions)
        period_s = CYCLE_S / options.pace
        for stretch in frozen.stretches:
            if not stretch.until_s:
                print(f"{stretch.name:18}{'not frozen: the mission was over':>40}")
                good = False
                continue
            span = (stretch.from_s, stretch.until_s + AFTER_S)
            gaps = [longest_gap_s(folder / notes, "/", *span) - period_s for notes in ("readings", "commands")]
            good = good and (stretch.name in ("robot", KEEPER) or gaps[0] <= MUST_S)
            print(f"{stretch.name:18}{stretch.at_s:7.0f}{gaps[0]:19.2f}{gaps[1]:19.2f}")
    outcome, account = report.outcome, report.account
    print(
        f"the mission: {outcome.state} after {outcome.time_s:.0f} s, {100 * outcome.aligned_fraction:.1f} % decided, "
        f"collisions: {outcome.collisions}\nlost: {account.lost} of {account.posted} posted; "
        f"still waiting: {account.in_outboxes}; missed by hosts: {account.missed}"
    )
    raise SystemExit(0 if good else 1)


def _read_along(processes: Processes, commands: dict[str, list[str]]) -> None:
    for name, command in commands.items():
        processes.start_beside(name, command)


if __name__ == "__main__":
    main()
