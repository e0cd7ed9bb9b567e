"""The processes of a mission on this machine, for trials: the keeper and the hosts, each to be killed, frozen and started again.

Every process hangs on a leash: it ends when the trial does, however that ends. What a host had posted when it was killed is read
from its outbox there and then (ledger.py).
"""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Self

from ledger import Ledger

from blackboard.assembly import assemble
from blackboard.mission import find_mission, load_mission
from blackboard.placement import placement

CHECKOUT = Path(__file__).resolve().parent.parent
KEEPER = "keeper"
HOSTS = ("robot", "behaviours", "knowledge_sources", "rules")
START_S = 20.0  # two cores may have a lot to do


def free_port() -> int:
    """Return a port that nobody listens at now."""
    with socket.socket() as asked:
        asked.bind(("127.0.0.1", 0))
        return int(asked.getsockname()[1])


def parts_of(mission: str) -> tuple[str, tuple[str, ...]]:
    """Return the name of a mission's robot, and its hosts."""
    loaded = load_mission(find_mission(mission))
    robot = assemble(loaded).robot
    robot.close()
    return robot.description.name, tuple(plan.name for plan in placement(loaded))


@dataclass(frozen=True, kw_only=True)
class Deployment:
    """What is to run, and where."""

    folder: Path
    address: str
    mission: str = "explore-lab"
    robot: str = "k2a"
    hosts: tuple[str, ...] = HOSTS
    pace: float = 1.0  # mission seconds per second
    seed: int = 0
    settings: tuple[str, ...] = ()
    keys: Mapping[str, Path] = field(default_factory=dict)  # by process, where the keeper asks for them
    inside: Mapping[str, str] = field(default_factory=dict)  # processes in a network namespace

    @property
    def journal(self) -> Path:
        """Where the keeper writes the board."""
        return self.folder / KEEPER / self.robot / "board.jsonl"

    def outbox(self, host: str) -> Path:
        """Where a host keeps what is not acknowledged."""
        return self.folder / host / "outbox"

    def command(self, name: str) -> list[str]:
        """Return how a process is started."""
        inside = ["ip", "netns", "exec", self.inside[name]] if name in self.inside else []
        ski = [*inside, sys.executable, "-m", "blackboard.command.main"]
        keys = ["--keys", str(self.keys[name])] if name in self.keys else []
        if name == KEEPER:
            place = ["--listen", self.address, "--out", str(self.folder / KEEPER)]
            return [*ski, "board", "serve", self.mission, *place, *keys]
        settings = [word for setting in self.settings for word in ("--set", setting)]
        options = ["--seed", str(self.seed), "--pace", str(self.pace), "--state", str(self.folder / name)]
        return [*ski, "host", self.mission, "--name", name, "--connect", self.address, *options, *settings, *keys]


class Processes:
    """A deployment at work. Use it in `with`: nothing is left running after it."""

    def __init__(self, deployment: Deployment, ledger: Ledger | None = None) -> None:
        self.deployment = deployment
        self.ledger = ledger or Ledger()
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        self._frozen: set[str] = set()

    def start_all(self) -> None:
        """Start the keeper, then the hosts."""
        for name in (KEEPER, *self.deployment.hosts):
            self.start(name)

    def start(self, name: str) -> None:
        """Start a process; of the keeper wait until it listens."""
        self.start_beside(name, [*self.deployment.command(name), "--leashed"])
        if name == KEEPER and name not in self.deployment.inside:
            self.until_listening(KEEPER)

    def start_beside(self, name: str, command: list[str]) -> None:
        """Start a process that is none of the mission's."""
        folder = self.deployment.folder
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / f"{name}.log").open("ab") as log:
            self._running[name] = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=log,
                stderr=log,
                cwd=CHECKOUT,
                env={**os.environ, "PYTHONPATH": str(CHECKOUT), "OPENBLAS_NUM_THREADS": "1"},
            )

    def pid(self, name: str) -> int:
        """Return a process's number."""
        return self._running[name].pid

    def runs(self, name: str) -> bool:
        """Say whether a process has not ended."""
        return name in self._running and self._running[name].poll() is None

    def kill(self, name: str) -> None:
        """Kill -9, and take note of what the process had posted."""
        process = self._running.pop(name)
        process.kill()
        process.wait()
        if process.stdin is not None:
            process.stdin.close()
        self.note(name)

    def note(self, name: str) -> None:
        """Take note of what stands in a host's outbox."""
        if name != KEEPER:
            self.ledger.note_outbox(self.deployment.outbox(name))

    def freeze(self, name: str) -> None:
        """Stop a process where it is."""
        self._frozen.add(name)
        os.kill(self.pid(name), signal.SIGSTOP)

    def thaw(self, name: str) -> None:
        """Let it go on."""
        self._frozen.discard(name)
        os.kill(self.pid(name), signal.SIGCONT)

    @property
    def over(self) -> bool:
        """Say whether the processes have ended by themselves."""
        return False

    def stop_all(self) -> dict[str, int]:
        """End the hosts in an orderly way, then the keeper; return the exit statuses."""
        hosts = [name for name in self._running if name != KEEPER]
        statuses = {name: status for name in hosts for status in [self._ask_to_end(name)] if status is not None}
        for name in hosts:
            statuses[name] = self._end(name)
        if KEEPER in self._running:
            self._ask_to_end(KEEPER)
            statuses[KEEPER] = self._end(KEEPER)
        return statuses

    def log(self, name: str) -> str:
        """Return what a process has said."""
        path = self.deployment.folder / f"{name}.log"
        return path.read_text(errors="replace") if path.exists() else ""

    def until_listening(self, name: str) -> None:
        """Wait until the keeper can be reached; raise RuntimeError where process `name` ends before."""
        host, port = self.deployment.address.rpartition("/")[2].rsplit(":", 1)
        end_s = time.monotonic() + START_S
        while self.runs(name):
            with socket.socket() as asked:
                if asked.connect_ex((host, int(port))) == 0:
                    return
            if time.monotonic() > end_s:
                break
            time.sleep(0.02)
        raise RuntimeError(f"the keeper does not listen at {self.deployment.address}:\n{self.log(name)}")

    def _ask_to_end(self, name: str) -> int | None:
        process = self._running[name]
        if process.poll() is None:
            process.terminate()
        return process.returncode

    def _end(self, name: str) -> int:
        process = self._running.pop(name)
        try:
            status = process.wait(timeout=START_S)
        except subprocess.TimeoutExpired:
            process.kill()
            status = process.wait()
        if process.stdin is not None:
            process.stdin.close()
        return status

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for name in list(self._frozen):
            if self.runs(name):
                self.thaw(name)
        for process in self._running.values():
            process.kill()
            process.wait()
            if process.stdin is not None:
                process.stdin.close()
        self._running.clear()


class JournalTail:
    """The lines that the keeper has written since they were last asked for, whole ones only."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._at = 0

    def lines(self) -> Iterator[bytes]:
        """Yield what is new."""
        if not self._path.exists():
            return
        with self._path.open("rb") as file:
            file.seek(self._at)
            for line in file:
                if not line.endswith(b"\n"):
                    return
                self._at += len(line)
                yield line
