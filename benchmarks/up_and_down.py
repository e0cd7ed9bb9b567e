"""`ski up` to the robot's first motion, back again after a `kill -9` of each process, `ski down`, and what that leaves.

python benchmarks/up_and_down.py [--rounds N] [--mission MISSION]
"""

import argparse
import fcntl
import json
import os
import queue
import signal
import socket
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from blackboard.link.session import LinkParams, Session, open_session
from blackboard.processes.protocol import AgentReport, decode
from blackboard.processes.state_folder import StateFolder

LONG_S = 60.0


class Place:
    """A port and folders of its own."""

    def __init__(self, folder: Path, mission: str) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = int(free.getsockname()[1])
        self.folder = folder
        self.mission = mission
        self.address = f"tcp/127.0.0.1:{self.port}"
        self.state = StateFolder(self.address, folder / "state")

    def ski(self, *arguments: str) -> str:
        """Run `ski`; return what it said on standard error."""
        command = [sys.executable, "-m", "blackboard.command.main", *arguments, "--connect", self.address]
        environment = {**os.environ, "SKI_STATE": str(self.folder / "state")}
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=LONG_S, check=False)
        if done.returncode:
            raise SystemExit(f"{' '.join(arguments)}: {done.stderr}")
        return done.stderr

    def left(self) -> list[str]:
        """Return what is left of it: processes, records, a port in use, files that are locked."""
        left = []
        for place in Path("/proc").glob("[0-9]*/cmdline"):
            try:
                line = place.read_bytes().decode(errors="replace")
                environment = (place.parent / "environ").read_bytes().decode(errors="replace")
            except OSError:
                continue
            if self.address in line or f"SKI_STATE={self.folder}" in environment:
                left.append(f"process {place.parent.name}")
        left += [f"record of {record.name}" for record in self.state.records(alive=False)]
        for path in self.folder.rglob("*.lock"):
            with path.open("rb") as file:
                try:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except OSError:
                    left.append(f"lock {path.name}")
        with socket.socket() as attempt:
            attempt.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                attempt.bind(("127.0.0.1", self.port))
            except OSError:
                left.append(f"port {self.port}")
        return left


def all_run(report: AgentReport) -> bool:
    """Say whether everything is up and has been heard."""
    return len(report.processes) > 1 and all(process.state == "running" for process in report.processes)


def reports_of(session: Session) -> "queue.SimpleQueue[AgentReport]":
    """Return where the executor's reports come."""
    come: queue.SimpleQueue[AgentReport] = queue.SimpleQueue()
    session.subscribe("ski/@agents/*/report", lambda arrived: come.put(decode(arrived.payload, AgentReport)))
    return come


def until(come: "queue.SimpleQueue[AgentReport]", holds: Callable[[AgentReport], bool]) -> AgentReport:
    """Return the first report that something holds of."""
    while True:
        report = come.get(timeout=LONG_S)
        if holds(report):
            return report


def kill_each(place: Place) -> dict[str, float]:
    """Kill every process in turn; return how long each took to be up and heard again."""
    took = {}
    with open_session(LinkParams(address=place.address)) as session:
        come = reports_of(session)
        report = until(come, all_run)
        for name in [process.name for process in report.processes] + ["agent"]:
            record = place.state.record(name)
            assert record is not None
            before, boot = record.who.pid, report.boot
            began_s = time.monotonic()
            os.kill(before, signal.SIGKILL)

            def back(report: AgentReport, name: str = name, before: int = before, boot: str = boot) -> bool:
                other = (
                    [p.pid for p in report.processes if p.name == name] != [before]
                    if name != "agent"
                    else report.boot != boot
                )
                return other and all_run(report)

            report = until(come, back)
            took[name] = time.monotonic() - began_s
    return took


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--mission", default="explore-lab")
    options = parser.parse_args()
    seconds: dict[str, list[float]] = defaultdict(list)
    left: list[str] = []
    for number in range(options.rounds):
        with TemporaryDirectory() as folder:
            place = Place(Path(folder), options.mission)
            try:
                began_s = time.monotonic()
                said = place.ski("up", options.mission, "--out", str(place.folder / "out"), "--detach")
                seconds["up --detach, whole"].append(time.monotonic() - began_s)
                seconds["up to first motion"].append(float(said.partition(" moves, ")[2].partition(" s")[0]))
                for name, took_s in kill_each(place).items() if number == options.rounds - 1 else ():
                    seconds[f"{name} back after kill -9"].append(took_s)
            finally:
                began_s = time.monotonic()
                place.ski("down")
                seconds["down, results written"].append(time.monotonic() - began_s)
            left += place.left()
    width = max(map(len, seconds))
    print(
        f"{options.mission}, {options.rounds} rounds, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores; seconds"
    )
    print(f"{'':{width}}  median  longest")
    for name, found in seconds.items():
        print(f"{name:{width}}  {median(found):6.2f}  {max(found):7.2f}")
    print(f"left behind: {json.dumps(left) if left else 'nothing'}")


if __name__ == "__main__":
    main()
