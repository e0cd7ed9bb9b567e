"""A host: one process that runs its share of a mission on a replica of the board, in real time.

The loop waits for what comes and for what is due by the mission's clock. Arrivals wake knowledge sources, behaviours and the safety
layer at once. Nothing here depends on what other hosts do: where they fall silent, this one goes on with what it knows.
"""

import platform
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from queue import Empty, SimpleQueue

from blackboard.assembly import Assembly, assemble
from blackboard.errors import LinkError, MissionError
from blackboard.folder_lock import FolderLock
from blackboard.link.clock import CLOCK_OFF_S, clock_is_off
from blackboard.link.replica import JOIN_S, Item
from blackboard.link.session import LinkParams, Session, open_session
from blackboard.link.share import Share
from blackboard.members import member, members, share_world
from blackboard.mission import Mission
from blackboard.placement import placement

BEAT_S = 0.2
BURST = 500  # arrivals handled before what is due is looked at again
FLUSH_S = 3.0  # at the end: to have the last posts acknowledged


@dataclass(frozen=True, kw_only=True)
class HostOptions:
    """How a host runs. `state` is the folder of its outbox and checkpoints; None: nothing outlives a kill."""

    link: LinkParams
    seed: int = 0
    pace: float = 1.0
    state: Path | None = None
    strict: bool = False
    machine: str = ""
    patience_s: float = 0.0  # so long it waits for a keeper that is not there when it starts


class Host:
    """One host of a mission. `run` returns when somebody calls `stop` (from any thread, or a signal's handler).

    Of a mission with several robots, the host of the robots works on the boards of all of them, any other on one.
    """

    def __init__(self, mission: Mission, name: str, options: HostOptions) -> None:
        plans = {plan.name: plan for plan in placement(mission)}
        if name not in plans:
            raise MissionError(f"{mission.path}: there is no host '{name}'; there are {', '.join(plans)}")
        self.plan = plans[name]
        self.options = options
        self.machine = options.machine or platform.node()
        missions = [member(mission, self.plan.of)] if self.plan.of else members(mission)
        self._assemblies = [assemble(its, options.seed) for its in missions]
        if self.plan.robot:
            share_world(missions, [assembly.robot for assembly in self._assemblies])
        self._queue: SimpleQueue[Item] = SimpleQueue()
        self._stopping = False
        self._clock_told = False
        self._troubles: set[str] = set()  # told

    def run(self) -> None:
        """Join the boards and work until stopped. Raises LinkError where no keeper answers."""
        with ExitStack() as closing:
            if self.options.state is not None:
                closing.callback(FolderLock(self.options.state, "host", "--state").release)
            session = closing.enter_context(self._linked())
            shares: list[Share] = []
            for assembly in self._assemblies:
                shares.append(self._share(session, assembly))
                closing.callback(shares[-1].close)
            for share in shares:
                begin_s = shares[0].replica.now_s() if share is not shares[0] else None
                share.join(self.options.pace, begin_s, timeout_s=max(JOIN_S, self.options.patience_s))
            self._loop(shares)
            self._finish(shares)

    def _linked(self) -> Session:
        until_s = time.monotonic() + self.options.patience_s
        while True:
            try:
                return open_session(self.options.link)  # tries for some seconds
            except LinkError:
                if self._stopping or time.monotonic() >= until_s:
                    raise

    def stop(self) -> None:
        """End soon."""
        self._stopping = True
        self._queue.put(lambda: None)

    def _share(self, session: Session, assembly: Assembly) -> Share:
        state = self.options.state
        if state is not None and len(self._assemblies) > 1:
            state = state / assembly.robot.name
        seed, strict = self.options.seed, self.options.strict
        return Share(session, assembly, self.plan, self._queue, seed=seed, state=state, strict=strict)

    def _loop(self, shares: Sequence[Share]) -> None:
        beaten_s = float("-inf")
        more = False
        while not self._stopping:
            monotonic_s = time.monotonic()
            if monotonic_s - beaten_s >= BEAT_S:
                beaten_s = monotonic_s
                self._beat(shares)
            due_s = min(share.until_due_s for share in shares)
            self._take(0.0 if more else min(beaten_s + BEAT_S - monotonic_s, due_s))
            left = [share.work() for share in shares]  # in turns, also where robots are behind: their world is one
            more = any(left)

    def _beat(self, shares: Sequence[Share], *, leaving: bool = False) -> None:
        for share in shares:
            share.beat(self.machine, _VERSION, leaving=leaving)
        for share in shares:
            trouble = share.replica.trouble
            if trouble and trouble not in self._troubles:
                self._troubles.add(trouble)
                sys.stderr.write(f"ski: {self.plan.name}: {trouble}\n")
        clock = shares[0].replica.clock
        if clock.running and not self._clock_told and abs(clock.best.wall_offset_s) > CLOCK_OFF_S:
            self._clock_told = True
            sys.stderr.write(f"ski: {self.machine}: {clock_is_off(clock.best.wall_offset_s)}\n")

    def _take(self, wait_s: float) -> None:
        """Wait for an arrival, and handle it and what came with it."""
        queue = self._queue
        try:
            item = queue.get(timeout=wait_s) if wait_s > 0 else queue.get_nowait()
            for _ in range(BURST):
                item()
                item = queue.get_nowait()
            item()
        except Empty:
            return

    def _finish(self, shares: Sequence[Share]) -> None:
        for share in shares:
            share.stages.finish()
        end_s = time.monotonic() + FLUSH_S
        while any(share.replica.unacknowledged for share in shares) and time.monotonic() < end_s:
            self._take(0.05)
            self._beat(shares)
        self._beat(shares, leaving=True)


_VERSION = version("sensory-knowledge-integrator")
