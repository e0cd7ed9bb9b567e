"""Oversees a mission whose parts run as processes, from its first order to its last: `ski up` without its face.

One loop, on a replica of the board: it keeps the manager's promises to the executors, and takes note of what people want to know.
"""

import contextlib
import os
import platform
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from queue import Empty, SimpleQueue

from blackboard.assembly import Assembly
from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.errors import LinkError
from blackboard.kinds import DRIVE, MISSION
from blackboard.link.lanes import Lane
from blackboard.link.replica import Item, Replica
from blackboard.link.session import LinkParams, Session, open_session
from blackboard.messages.motion import Drive
from blackboard.processes.ground import keeper_status
from blackboard.processes.local_agent import LocalAgent
from blackboard.processes.manager import Manager, MissionOrders

BEAT_S = 0.2
END_S = 40.0  # for every executor to stop what it runs
LANES: tuple[Lane, ...] = ("command", "knowledge", "control")  # readings and maps are not looked at here


class Overseer:
    """A mission under way. Use `running` around it; `step` goes once round the loop."""

    def __init__(
        self,
        link: LinkParams,
        assembly: Assembly,
        orders: MissionOrders,
        name: str,
        version: str,
        others: Sequence[Assembly] = (),
    ) -> None:
        """`assembly` is that of the mission's robot, the first of several; `others` are those of the rest."""
        self.link = link
        self.assembly = assembly
        self.others = others
        self.orders = orders
        self.name = name
        self.began_s = time.monotonic()
        self.moved_s: float | None = None  # monotonic, when the robot was first driven
        self.local: LocalAgent | None = None
        self.journals: dict[str, Path] = {}  # of a keeper that was there before, by robot, where it is on this machine
        self._version = version
        self._beaten_s = float("-inf")

    @contextlib.contextmanager
    def running(self) -> Iterator[None]:
        """Join the board and order everything; at the end everything is stopped."""
        with contextlib.ExitStack() as closing:
            session = closing.enter_context(open_session(self.link))
            queue: SimpleQueue[Item] = SimpleQueue()
            replicas = []
            for assembly in (self.assembly, *self.others):
                robot = assembly.robot.description.name
                replicas.append(Replica(session, assembly.vocabulary, robot, "manager", lanes=LANES, queue=queue))
                closing.callback(replicas[-1].close)
            self._join(session, replicas)
            try:
                yield
            finally:
                self._end()

    def step(self, wait_s: float = 0.1) -> None:
        """Wait for something to happen, at most so long, and do what is due. Raises LinkError where the agent cannot run."""
        now_s = time.monotonic()
        if now_s - self._beaten_s >= BEAT_S:
            self._beaten_s = now_s
            self._beat()
            for replica in self._replicas:
                replica.tend()
            if self.local is not None and not self._ending:
                self.local.tend(now_s)
        self.manager.tend(now_s)
        with contextlib.suppress(Empty):
            item = self.replica.queue.get(timeout=wait_s)
            while True:
                self.replica.handle(item)
                item = self.replica.queue.get_nowait()
        for replica in self._replicas:
            replica.board.now_s = max(replica.board.now_s, replica.now_s())

    @property
    def elapsed_s(self) -> float:
        """How long the mission has been going on, on its own clock; 0 before its robot has begun it."""
        return self.replica.now_s() - self.assembly.robot.start_s if self.replica.clock.running else 0.0

    @property
    def over(self) -> bool:
        """Say whether the mission has come to its end by its own word, for every robot."""
        standing = [replica.board.newest(MISSION) for replica in self._replicas]
        return all(status is not None and status.value.state != "underway" for status in standing)

    @property
    def boards(self) -> dict[str, Board]:
        """The boards, by robot."""
        return {replica.board.robot: replica.board for replica in self._replicas}

    def _join(self, session: Session, replicas: list[Replica]) -> None:
        self._replicas, self.replica = replicas, replicas[0]
        replica = self.replica
        self._session = session
        self._ending = False
        replica.board.subscribe(replica.board.key(DRIVE), self._note_drive)
        for each in replicas:
            each.join()
        boards = list(self.boards.values())
        self.manager = Manager(
            session,
            self.orders,
            boards,
            replica.queue.put,
            name=self.name,
            keeper_heard_s=lambda: replica.keeper_heard_s,
        )

    def _beat(self, *, leaving: bool = False) -> None:
        for replica in self._replicas:
            replica.beat(("manager",), self.orders.machine, self._version, leaving=leaving)

    def _end(self) -> None:
        """Stop what runs elsewhere first: the keeper goes with what runs here, and has to hear their last words."""
        self._ending = True
        until_s = time.monotonic() + END_S
        for elsewhere in (True, False):
            self.manager.end(elsewhere=elsewhere)
            while not (self.manager.ended(elsewhere=elsewhere) or self._all_gone) and time.monotonic() < until_s:
                self.step()
        self._beat(leaving=True)
        if self.orders.keeper_folder is None:
            with contextlib.suppress(LinkError):  # it may be gone by now
                self._find_journals()

    @property
    def _all_gone(self) -> bool:
        return self.local is not None and self.local.ended

    def _find_journals(self) -> None:
        status = keeper_status(self._session, self.link.address)
        if status.machine == platform.node():
            self.journals = {b.robot: Path(b.journal) for b in status.boards if b.robot in self.boards}

    def _note_drive(self, entry: Entry[Drive]) -> None:
        if self.moved_s is None and (entry.value.forward_mps or entry.value.turn_radps):
            self.moved_s = time.monotonic()


def manager_name() -> str:
    """Return a name for a manager that no other has."""
    return f"{os.getpid()}-{time.time_ns():x}"
