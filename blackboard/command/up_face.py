"""What `ski up` shows while a mission runs: a table on a terminal, lines elsewhere."""

import os
import sys
import time
from types import TracebackType
from typing import Self

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from blackboard.command.process_table import last_end, process_table
from blackboard.command.spoken import tell_what_is_said
from blackboard.processes.overseer import Overseer
from blackboard.processes.protocol import ProcessReport

REDRAW_S = 0.25


class Face:
    """Shows how an overseer's mission fares. `ready` is a pipe on which a detached one says that it is up."""

    def __init__(self, overseer: Overseer, began_s: float, ready: int | None = None) -> None:
        self._overseer = overseer
        self._began_s = began_s
        self._ready = ready
        self._console = Console(stderr=True)
        self._live = Live(console=self._console, auto_refresh=False, transient=True)
        self._drawn_s = float("-inf")
        self._told: dict[str, tuple[str, int]] = {}
        self._moved = False
        self._missing: tuple[str, ...] = ()

    def __enter__(self) -> Self:
        boards = self._overseer.boards
        for robot, board in boards.items():
            tell_what_is_said(board, self._console, f"{robot}: " if len(boards) > 1 else "")
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.stop()

    def show(self) -> None:
        """Show what has changed."""
        overseer = self._overseer
        if not self._moved and overseer.moved_s is not None:
            self._moved = True
            robot = overseer.orders.robot
            said = f"{robot} moves, {overseer.moved_s - self._began_s:.1f} s after `ski up`"
            self._say(said)
            self._be_ready(said)
        elif not self._moved and not overseer.assembly.robot.moves and overseer.elapsed_s > 0:
            self._moved = True
            self._be_ready(f"{overseer.orders.robot} gives its readings")
        processes = overseer.manager.processes
        if self._console.is_terminal:
            now_s = time.monotonic()
            if now_s - self._drawn_s >= REDRAW_S:
                self._drawn_s = now_s
                self._live.update(self._picture(processes), refresh=True)
        else:
            self._tell_changes(processes)

    def end(self) -> None:
        """Say that everything is being stopped."""
        self._live.stop()
        if self._console.is_terminal:
            self._say("stopping")

    def _picture(self, processes: list[ProcessReport]) -> Group:
        overseer = self._overseer
        title = f"{overseer.assembly.mission.name}: {overseer.elapsed_s:.0f} s"
        return Group(process_table(processes, title), *(Text(line, style="bold red") for line in self._troubles()))

    def _troubles(self) -> list[str]:
        manager = self._overseer.manager
        lines = [f"waiting for `ski agent` on {machine}" for machine in manager.missing]
        return lines + [f"{machine}: {why}" for machine, why in manager.refusals.items()]

    def _tell_changes(self, processes: list[ProcessReport]) -> None:
        for process in processes:
            now = (process.state, process.restarts)
            if self._told.get(process.name) != now and (process.state != "starting" or process.restarts):
                how = f" ({last_end(process)})" if last_end(process) else ""
                self._say(f"{process.name} on {process.machine}: {process.state}{how}")
            self._told[process.name] = now
        troubles = tuple(self._troubles())
        if troubles != self._missing and self._overseer.elapsed_s > 0:
            self._missing = troubles
            for line in troubles:
                self._say(line)

    def _say(self, line: str) -> None:
        if self._console.is_terminal:
            self._console.print(f"ski: {line}", markup=False, highlight=False)
        else:
            sys.stderr.write(f"ski: {line}\n")
            sys.stderr.flush()

    def _be_ready(self, said: str) -> None:
        if self._ready is not None:
            with os.fdopen(self._ready, "w") as pipe:
                pipe.write(said)
            self._ready = None
