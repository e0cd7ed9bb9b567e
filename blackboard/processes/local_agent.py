"""An executor of this machine that comes and goes with its manager, started anew when it ends before its time."""

import socket
from collections.abc import Callable
from pathlib import Path

from blackboard.errors import LinkError
from blackboard.link.session import LinkParams
from blackboard.processes.child import Child, Ended
from blackboard.processes.commands import agent_command
from blackboard.processes.nursery import fork_nursery
from blackboard.processes.nursery_children import can_fork, link_pair
from blackboard.processes.protocol import Order, encode
from blackboard.processes.restarts import pause_s

RESTARTS, WITHIN_S = 5, 60.0
END_S = 30.0  # its hosts' grace, one after the other the keeper's, and some


class LocalAgent:
    """The executor's process. `ended` is called on another thread and must only see to it that `tend` is called soon."""

    def __init__(
        self, link: LinkParams, machine: str, logs: Path, ended: Callable[[], None], *, share: bool = False
    ) -> None:
        """Start it. With `share`, `fork_nursery` has to be called when the mission is loaded."""
        self._command = agent_command(link, machine)
        self._log = logs / "agent.log"
        self._wake = ended
        self._order: Order | None = None
        self._over: Ended | None = None
        self._ends_s: list[float] = []
        self._start_s: float | None = None
        self.restarts = 0
        self._nursery_end: socket.socket | None = None
        if share and can_fork():
            ours, self._nursery_end = link_pair()
            with ours:
                ours.set_inheritable(True)
                command = (*self._command, "--nursery", str(ours.fileno()))
                self._child = Child("agent", command, self._log, self._note, keep=(ours.fileno(),))
        else:
            self._child = self._start()

    def fork_nursery(self) -> None:
        """Let a copy of this process, as it is now, bring forth the first hosts; it must have no threads and no link yet."""
        if self._nursery_end is not None:
            with self._nursery_end as link:
                fork_nursery(link, self._log.with_name("nursery.log"))
            self._nursery_end = None
            self._child.wait()

    def order(self, order: Order) -> None:
        """Have it run something; told at once, without a link."""
        self._order = order
        self._child.say(encode(order))

    def tend(self, now_s: float) -> None:
        """Start it anew where it has ended. Raises LinkError where it does so again and again."""
        if self._over is not None:
            over, self._over = self._over, None
            self._ends_s.append(now_s)
            pause = pause_s("always", True, self._ends_s, now_s, RESTARTS, WITHIN_S)
            if pause is None:
                raise LinkError(
                    f"the agent of this machine ends again and again: {over.last_line or over.code}; see {self._log}"
                )
            self._start_s = now_s + pause
        if self._start_s is not None and now_s >= self._start_s:
            self._start_s = None
            self.restarts += 1
            self._child = self._start()
            if self._order is not None:
                self._child.say(encode(self._order))

    @property
    def ended(self) -> bool:
        """Say whether it has ended, and with it all that it ran."""
        return self._over is not None

    def end(self) -> None:
        """Let it stop everything, and wait for that."""
        if self._nursery_end is not None:  # it never came to that
            self._nursery_end.close()
            self._nursery_end = None
            self._child.wait()
        self._child.terminate()
        if self._child.join(END_S) is None:
            self._child.kill()
            self._child.join()

    def _start(self) -> Child:
        return Child("agent", self._command, self._log, self._note)

    def _note(self, ended: Ended) -> None:
        self._over = ended
        self._wake()
