"""The processes of a mission as `ski up` runs them, for trials: killed from outside, started again by the executor daemon."""

import os
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from deployment import START_S, Deployment, Processes

from blackboard.processes.state_folder import StateFolder

UP = "ski up"


@dataclass(frozen=True, kw_only=True)
class ManagedDeployment(Deployment):
    """What is to run, and where; all is in one folder."""

    @property
    def state(self) -> StateFolder:
        """Where `ski up` and its executor write down who runs."""
        return StateFolder(self.address, self.folder / "state")

    @property
    def journal(self) -> Path:
        """Where the keeper writes the board, and where `ski up` puts it in the end."""
        out = self.folder / "out"
        return out / "board.jsonl" if (out / "board.jsonl").exists() else out / "board" / self.robot / "board.jsonl"

    def outbox(self, host: str) -> Path:
        """Where a host keeps what is not acknowledged."""
        there = sorted(self.state.path.glob(f"hosts/*/{host}/outbox"))
        return there[0] if there else self.state.path / "hosts" / "none" / host / "outbox"

    def command(self, name: str) -> list[str]:
        """Return how all of it is started."""
        settings = [word for setting in self.settings for word in ("--set", setting)]
        options = ["--connect", self.address, "--pace", str(self.pace), "--seed", str(self.seed), *settings]
        ski = ["env", f"SKI_STATE={self.folder / 'state'}", sys.executable, "-m", "blackboard.command.main"]
        return [*ski, "up", self.mission, "--out", str(self.folder / "out"), *options]


class ManagedProcesses(Processes):
    """A mission under `ski up`."""

    deployment: ManagedDeployment

    def start_all(self) -> None:
        """Start `ski up`, and wait for its keeper."""
        self.start_beside(UP, self.deployment.command(UP))
        self.until_listening(UP)

    @property
    def over(self) -> bool:
        """Say whether `ski up` has ended: it does so by itself."""
        return not self.runs(UP)

    def kill(self, name: str) -> None:
        """Kill -9; whoever watches the process starts another. What it had posted is read at once, before that."""
        record = self.deployment.state.record(name)
        if record is None:
            raise RuntimeError(f"{name} does not run:\n{self.log(UP)}")
        os.kill(record.who.pid, signal.SIGKILL)
        self.note(name)

    def start(self, name: str) -> None:
        """Nobody but the executor starts it again."""

    def stop_all(self) -> dict[str, int]:
        """Wait for `ski up` to end."""
        end_s = time.monotonic() + START_S
        while not self.over and time.monotonic() < end_s:
            time.sleep(0.05)
        return super().stop_all()
