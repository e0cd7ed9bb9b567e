"""A host: one process that runs its share of a mission on a replica of the board, in real time.

The loop waits for what comes and for what is due by the mission's clock. Arrivals wake knowledge sources, behaviours and the safety
layer at once. Nothing here depends on what other hosts do: where they fall silent, this one goes on with what it knows.
"""

import platform
import time
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from queue import Empty

from blackboard.assembly import assemble
from blackboard.checkpoint import mission_identity
from blackboard.errors import MissionError
from blackboard.link.kept_states import KeptStates
from blackboard.link.lanes import Lane
from blackboard.link.replica import Item, Replica
from blackboard.link.session import LinkParams, open_session
from blackboard.link.stages import Stages
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


class Host:
    """One host of a mission. `run` returns when somebody calls `stop` (from any thread, or a signal's handler)."""

    def __init__(self, mission: Mission, name: str, options: HostOptions) -> None:
        plans = {plan.name: plan for plan in placement(mission)}
        if name not in plans:
            raise MissionError(f"{mission.path}: there is no host '{name}'; there are {', '.join(plans)}")
        self.plan = plans[name]
        self.options = options
        self.machine = options.machine or platform.node()
        self._assembly = assemble(mission, options.seed)
        self._stopping = False
        self._replica: Replica | None = None

    def run(self) -> None:
        """Join the board and work until stopped. Raises LinkError where no keeper answers."""
        robot = self._assembly.robot
        with open_session(self.options.link) as session:
            newest: tuple[Lane, ...] = ("signal",) if self.plan.behaviours or self.plan.robot else ()
            replica = self._replica = Replica(
                session,
                self._assembly.vocabulary,
                robot.description.name,
                self.plan.name,
                state=self.options.state,
                history=self._assembly.mission.history,
                newest=newest,
            )
            stages = Stages(replica.board, self._assembly, self.plan, strict=self.options.strict)
            try:
                begin_s = robot.start_s if self.plan.robot else None
                replica.join(begin_s=begin_s, pace=self.options.pace)
                replica.board.now_s = max(replica.board.now_s, replica.now_s())
                kept = self._kept(replica)
                stages.resume(kept.restored())
                if stages.robot is not None:
                    stages.robot.begin(replica.now_s())
                self._loop(replica, stages, kept)
                self._finish(replica, stages)
            finally:
                replica.close()
                robot.close()

    def stop(self) -> None:
        """End soon."""
        self._stopping = True
        if self._replica is not None:
            self._replica.queue.put(lambda: None)

    def _loop(self, replica: Replica, stages: Stages, kept: KeptStates) -> None:
        board = replica.board
        beaten_s = float("-inf")
        more = False
        while not self._stopping:
            monotonic_s = time.monotonic()
            if monotonic_s - beaten_s >= BEAT_S:
                beaten_s = monotonic_s
                replica.beat(stages.components, self.machine, _VERSION)
                replica.tend()
            wait_s = 0.0 if more else min(beaten_s + BEAT_S - monotonic_s, self._until_due_s(replica, stages))
            self._take(replica, wait_s)
            now_s = replica.now_s()
            if stages.robot is not None and replica.clock.running:
                while stages.robot.next_s <= now_s and not self._stopping:
                    stages.robot.cycle()
                    if stages.behaviours is not None:
                        stages.behaviours.answer()
                        stages.robot.obey()
                    kept.keep_robot(board.now_s, stages.robot)
            board.now_s = max(board.now_s, now_s)
            more = stages.work()
            kept.keep(board.now_s, stages)

    def _kept(self, replica: Replica) -> KeptStates:
        identity = mission_identity(self._assembly.mission, self.options.seed)
        return KeptStates(self.options.state, identity, replica.boot, replica.board)

    def _until_due_s(self, replica: Replica, stages: Stages) -> float:
        if not replica.clock.running:
            return BEAT_S
        return max(0.0, (stages.next_s - replica.now_s()) / replica.clock.pace)

    def _take(self, replica: Replica, wait_s: float) -> None:
        """Wait for an arrival, and handle it and what came with it."""
        queue = replica.queue
        item: Item
        try:
            item = queue.get(timeout=wait_s) if wait_s > 0 else queue.get_nowait()
            for _ in range(BURST):
                replica.handle(item)
                item = queue.get_nowait()
            replica.handle(item)
        except Empty:
            return

    def _finish(self, replica: Replica, stages: Stages) -> None:
        stages.finish()
        end_s = time.monotonic() + FLUSH_S
        while replica.unacknowledged and time.monotonic() < end_s:
            self._take(replica, 0.05)
            replica.tend()
            replica.beat(stages.components, self.machine, _VERSION)
        replica.beat(stages.components, self.machine, _VERSION, leaving=True)


_VERSION = version("sensory-knowledge-integrator")
