"""The hosts of a mission in lock-step in one process, each on a replica of its own, so that any of them can be killed at any post.

What a host posts reaches the others at the end of its turn. A host that was killed comes back as its process would: from its
checkpoint files and from what stands. The same kills give the same run.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from blackboard.assembly import assemble
from blackboard.board import Board
from blackboard.checkpoint import SUFFIX, Checkpointer, mission_identity, read_checkpoint
from blackboard.component import Robot
from blackboard.entry import Entry
from blackboard.kinds import Kind
from blackboard.link.merge import merged
from blackboard.link.mission_end import mission_over
from blackboard.link.stages import Stages
from blackboard.mission import Mission
from blackboard.placement import HostPlan, placement

KEPT_BEFORE_S = 3.0  # checkpoints are written so long before a kill: every second
ROUNDS = 100  # of knowledge sources in one cycle; real hosts go on for as long as something waits


class Killed(BaseException):
    """A process dies between two posts."""


@dataclass(frozen=True, kw_only=True)
class Kill:
    """Which host dies, when (mission's clock), after how many posts from then on, and for how long it is away."""

    host: str
    at_s: float
    posts: int = 0
    away_s: float = 1.0
    forgets: bool = False  # its checkpoints are lost too


class _Process:
    """One host: its replica, its stages, its files."""

    def __init__(
        self, mission: Mission, plan: HostPlan, seed: int, boot: int, folder: Path, sent: list[Entry[Any]]
    ) -> None:
        assembly = assemble(mission, seed)
        self.plan = plan
        self.robot: Robot[Any] = assembly.robot
        self.board = Board(assembly.vocabulary, robot=assembly.robot.description.name, history=mission.history)
        self.stages = Stages(self.board, assembly, plan, strict=True)
        self.board.outgoing = self._send
        self.posts_left: int | None = None
        self._keeps = True
        self._sent = sent
        identity = mission_identity(mission, seed)
        self._paths = {what: folder / f"{plan.name}-{what}{SUFFIX}" for what in ("robot", "components")}
        every_s = {"robot": 0.0, "components": 1.0}
        self._writers = {
            what: Checkpointer(path, identity, boot=str(boot), every_s=every_s[what])
            for what, path in self._paths.items()
        }
        self._identity = identity

    def _send(self, kind: Kind[Any], entry: Entry[Any], raw: bytes) -> None:
        self._sent.append(entry)
        if self.posts_left is not None:
            self.posts_left -= 1
            if self.posts_left < 0:
                raise Killed

    def begin(self, board: Sequence[Entry[Any]], now_s: float) -> None:
        """Join, go on from the checkpoints that are there."""
        self.board.load(board)
        self.board.now_s = now_s
        states: dict[str, object] = {}
        for path in self._paths.values():
            checkpoint = read_checkpoint(path, self._identity)
            if checkpoint is not None:
                found, lost = checkpoint.states(self.board.vocabulary)
                assert not lost, lost
                states |= found
        self.stages.resume(states)
        if self.stages.robot is not None:
            self.stages.robot.begin(now_s)

    def forget(self) -> None:
        """Lose the checkpoints, and keep none from now on."""
        self._keeps = False
        for path in self._paths.values():
            path.unlink(missing_ok=True)

    def keep(self, now_s: float) -> None:
        """Write what is due."""
        if not self._keeps:
            return
        if self.stages.robot is not None:
            assert not self._writers["robot"].write(now_s, self.stages.robot.states())
        if self._writers["components"].is_due(now_s) or self.stages.acted:
            lost = self._writers["components"].write(now_s, self.stages.states())
            assert not lost, lost


@dataclass
class InStep:
    """A mission in hosts; `log` is all that was posted, in order, `standing` the newest of each key, retractions too."""

    mission: Mission
    seed: int
    folder: Path
    log: list[Entry[Any]] = field(default_factory=list)
    standing: dict[str, Entry[Any]] = field(default_factory=dict)
    now_s: float = 0.0
    restarts: int = 0

    def __post_init__(self) -> None:
        self._sent: list[Entry[Any]] = []
        self._plans = placement(self.mission)
        self._hosts: dict[str, _Process] = {}
        self._back_s: dict[str, float] = {}
        self._cycles = 0
        self._waiting: list[Kill] = []
        for plan in self._plans:
            self._start(plan)

    def run(self, kills: Sequence[Kill] = (), until_s: float | None = None) -> bool:
        """Run to the mission's end, at most for as long as it may last; return whether it ended by its own word."""
        self._waiting = waiting = sorted(kills, key=lambda kill: kill.at_s)
        until_s = self.mission.params.duration_s if until_s is None else until_s
        while self.now_s < until_s:
            while waiting and waiting[0].at_s <= self.now_s and waiting[0].host in self._hosts:
                self._doom(waiting.pop(0))
            self._cycle()
            if self.over:
                return True
        return False

    @property
    def over(self) -> bool:
        """Say whether the mission has said that it is over."""
        return any(mission_over(process.board) for process in self._hosts.values())

    @property
    def robot(self) -> Robot[Any]:
        """The robot as it is now, with its world."""
        return next(p.robot for p in self._hosts.values() if p.plan.robot)

    def board(self, host: str) -> Board:
        """Return a host's replica."""
        return self._hosts[host].board

    def _doom(self, kill: Kill) -> None:
        process = self._hosts[kill.host]
        process.posts_left = kill.posts
        self._back_s[kill.host] = kill.away_s
        if kill.forgets:
            process.forget()

    def _start(self, plan: HostPlan) -> None:
        process = _Process(self.mission, plan, self.seed, self.restarts, self.folder, self._sent)
        self._hosts[plan.name] = process
        process.begin(list(self.standing.values()), self.now_s)
        self._deliver(plan.name)

    def _cycle(self) -> None:
        step_s = self.mission.params.step_s
        self.now_s = self._cycles * step_s
        self._cycles += 1
        for plan in self._plans:
            if plan.name not in self._hosts and self.now_s >= self._back_s[plan.name]:
                self.restarts += 1
                self._start(plan)
        for process in self._hosts.values():
            process.board.now_s = max(process.board.now_s, self.now_s)
        for name in [name for name, process in self._hosts.items() if process.plan.robot]:
            self._turn(name)
        for name in [name for name, process in self._hosts.items() if not process.plan.robot]:
            self._turn(name)
        for name, process in self._hosts.items():
            doomed = process.posts_left is not None
            soon = any(kill.host == name and kill.at_s <= self.now_s + KEPT_BEFORE_S for kill in self._waiting)
            if doomed or soon:  # what nobody will read need not be written
                process.keep(self.now_s)

    def _turn(self, name: str) -> None:
        process = self._hosts[name]
        stages = process.stages
        try:
            if stages.robot is not None:
                stages.robot.cycle()
            for _ in range(ROUNDS):
                if not stages.work():
                    break
        except Killed:
            pass
        self._deliver(name)
        if process.posts_left is not None and process.posts_left < 0:
            del self._hosts[name]
            self._back_s[name] += self.now_s

    def _deliver(self, name: str) -> None:
        sent, self._sent[:] = list(self._sent), []
        for entry in sent:
            self.log.append(entry)
            self.standing[entry.key] = merged(self.standing.get(entry.key), entry)
            for other, process in self._hosts.items():
                if other != name:
                    process.board.accept(entry)
