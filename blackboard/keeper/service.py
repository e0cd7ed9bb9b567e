"""The keeper at work: one loop over what zenoh's threads leave, for all robots."""

import os
import platform
import secrets
import time
from collections import defaultdict
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import msgspec

from blackboard.folder_lock import FolderLock
from blackboard.keeper.answers import Answers, answer_clock, answered
from blackboard.keeper.board_folder import set_aside
from blackboard.keeper.checking import Checker
from blackboard.keeper.clocks import Clocks
from blackboard.keeper.desks import Desks, Tell
from blackboard.keeper.intake import Intake
from blackboard.keeper.params import KeeperParams
from blackboard.keeper.robot_desk import KEEPER, RobotDesk
from blackboard.keeper.status import KeeperStatus
from blackboard.link.addresses import KEEPER_STATUS, keeper
from blackboard.link.session import Arrived, LinkParams, Question, Session, open_router
from blackboard.messages.hosts import HostBeat
from blackboard.vocabulary import Vocabulary


class Linked(NamedTuple):
    """A liveliness token that came or ended."""

    key: str
    alive: bool


class Beaten(NamedTuple):
    """A host's beat."""

    key: str
    payload: bytes


Item = Arrived | Question | Linked | Beaten


class Keeper:
    """Keeps the boards of all robots. `open`, `run` until somebody calls `stop`, `close`."""

    def __init__(
        self,
        link: LinkParams,
        folder: Path,
        vocabulary: Vocabulary,
        *,
        params: KeeperParams | None = None,
        fresh: bool = False,
        tell: Tell = lambda line: None,
        rejected: Callable[[], Mapping[str, int]] = dict,
    ) -> None:
        """Take the folder and bring back what stands in it, or set that aside. Raises OutputError where that cannot be."""
        self.params = params or KeeperParams()
        self.link = link
        self.folder = folder
        self.boot = secrets.token_hex(4)
        self._tell = tell
        self._rejected = rejected
        self._lock = FolderLock(folder, "keeper", "--out")
        self._started_s = time.monotonic()
        self._intake: Intake[Item] = Intake(self.params.queue_envelopes, self.params.queue_bytes)
        self._stopping = False
        self._closed = False
        self._session: Session | None = None
        if fresh:
            set_aside(folder)
        self._clocks = Clocks(folder)
        checker = Checker(vocabulary, self.params.entry_bytes)
        self._desks = Desks(folder, checker, self.params, self._clocks, self.boot, tell)
        self._answers = Answers(self._desks, self.boot, tell)

    @property
    def brought_back(self) -> dict[str, int]:
        """How many entries stand of each robot."""
        return {desk.robot: len(desk.kept.standing) for desk in self._desks}

    def open(self) -> None:
        """Listen, and take part. Raises LinkError where the address cannot be listened on."""
        session = self._session = open_router(self.link)
        own = f"{KEEPER} {self.boot} ".encode()
        put = self._intake.put

        def take(arrived: Arrived) -> None:
            if not arrived.attachment.startswith(own):
                put(arrived, len(arrived.payload))

        def ask(question: Question) -> None:
            put(question, len(question.payload))

        session.subscribe("ski/**", take)
        session.subscribe("ski/*/@hosts/*/beat", lambda a: put(Beaten(a.key, a.payload), len(a.payload)))
        session.watch("ski/*/@hosts/*/alive/*", lambda key, alive: put(Linked(key, alive)))
        for what in ("clock", "begin"):
            session.serve(f"ski/*/@keeper/{what}", lambda question: answer_clock(self._clocks, question))
        for what in ("snapshot", "lost"):
            session.serve(f"ski/*/@keeper/{what}", ask)
        session.serve("ski/*/@late/*/*", ask)
        session.serve(KEEPER_STATUS, ask)
        session.serve("ski/**", ask)

    def run(self) -> None:
        """Work until stopped."""
        while not self._stopping:
            items = self._intake.drain(self.params.beat_s / 4)
            if items:
                time.sleep(self.params.gather_s)
                items += self._intake.drain(0.0)
            self.step(items, time.monotonic())

    def stop(self) -> None:
        """End soon; may be called from any thread or a signal's handler."""
        self._stopping = True

    def close(self) -> None:
        """Stop listening, take in what has come, write checkpoints, let go of the folder. A second time does nothing."""
        if self._closed:
            return
        self._closed = True
        if self._session is not None:
            self._session.close()
            self._session = None
        self.step(self._intake.drain(0.0), time.monotonic())
        for desk in self._desks:
            desk.kept.close()
        self._lock.release()

    def step(self, items: list[Item], now_s: float) -> None:
        """Handle what has come, entries first, and do what is due."""
        entries: defaultdict[str, list[Arrived]] = defaultdict(list)
        questions: list[Question] = []
        for item in items:
            if isinstance(item, Arrived):
                entries[item.key.split("/", 2)[1]].append(item)
            elif isinstance(item, Question):
                questions.append(item)
            elif isinstance(item, Linked):
                self._linked(item, now_s)
            elif isinstance(item, Beaten):
                self._beaten(item, now_s)
        for robot, arrived in entries.items():
            desk = self._desks.opened_for(robot, arrived)
            if desk is not None:
                for line in desk.take(arrived, now_s):
                    self._tell(line)
        for question in questions:
            self._answer(question, now_s)
        for desk in self._desks:
            self._tend(desk, now_s)

    def status(self) -> KeeperStatus:
        """Return how all is doing."""
        boards = [desk.status() for desk in self._desks]
        return KeeperStatus(
            boot=self.boot,
            version=version("sensory-knowledge-integrator"),
            pid=os.getpid(),
            machine=platform.node(),
            address=self.link.address,
            folder=str(self.folder),
            uptime_s=time.monotonic() - self._started_s,
            clients=sum(boot.linked for desk in self._desks for _, boot in desk.hosts.boots()),
            overflowed=self._intake.overflowed,
            refused=dict(self._desks.refusals.by_reason),
            rejected=dict(self._rejected()),
            boards=boards,
        )

    def _linked(self, linked: Linked, now_s: float) -> None:
        chunks = linked.key.split("/")
        desk = self._desks.opened_for_host(linked.key, chunks[-1])
        if desk is not None:
            desk.hosts.linked(chunks[3], chunks[-1], linked.alive, now_s)

    def _beaten(self, beaten: Beaten, now_s: float) -> None:
        try:
            beat = msgspec.json.decode(beaten.payload, type=HostBeat)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            self._desks.refuse("beat", f"{beaten.key}: {error}")
            return
        desk = self._desks.opened_for_host(beaten.key, beat.boot)
        if desk is not None:
            desk.host_beat(beaten.key.split("/")[3], beat, now_s)

    def _answer(self, question: Question, now_s: float) -> None:
        if question.key == KEEPER_STATUS:
            answered(question, lambda: question.reply(question.key, msgspec.json.encode(self.status())))
        else:
            self._answers.answer(question, now_s)

    def _tend(self, desk: RobotDesk, now_s: float) -> None:
        for message, origin in desk.posts(now_s):
            if self._session is not None:
                self._session.put(message.key, message.payload, message.attachment, origin.lane)
        if desk.beat_due(now_s) and self._session is not None:
            # in a lane of low priority, so that it does not overtake what it tells of
            self._session.put(keeper(desk.robot, "beat"), desk.beat(now_s), lane="control")
        desk.tend(now_s)
        self._clocks.keep(desk.robot)
