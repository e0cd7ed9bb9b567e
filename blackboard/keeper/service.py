"""The keeper at work: one loop over what zenoh's threads leave, for all robots."""

import os
import platform
import secrets
import time
from collections import defaultdict
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from threading import Lock
from typing import NamedTuple

import msgspec

from blackboard.errors import BoardError, LinkError, MessageError, SkiError
from blackboard.folder_lock import FolderLock
from blackboard.keeper.board_folder import robots_in, set_aside
from blackboard.keeper.checking import Checker, Refusals, Refused
from blackboard.keeper.clock import KeptClock
from blackboard.keeper.intake import Intake
from blackboard.keeper.params import KeeperParams
from blackboard.keeper.robot_desk import KEEPER, RobotDesk
from blackboard.keeper.status import KeeperStatus
from blackboard.key_expressions import is_chunk
from blackboard.kinds import PANELS
from blackboard.link.addresses import KEEPER_STATUS, keeper
from blackboard.link.clock import ClockAnswer
from blackboard.link.envelope import (
    LostQuestion,
    Snapshot,
    attachment_of,
    join_batch,
    join_snapshot,
    read_origin,
    robot_of,
    split_batch,
)
from blackboard.link.session import Arrived, LinkParams, Question, Session, open_router
from blackboard.messages.hosts import HostBeat
from blackboard.vocabulary import Vocabulary

Tell = Callable[[str], None]


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
        self.refusals = Refusals()
        self._checker = Checker(vocabulary, self.params.entry_bytes)
        self._tell = tell
        self._rejected = rejected
        self._lock = FolderLock(folder, "keeper", "--out")
        self._started_s = time.monotonic()
        self._wall_minus_monotonic_s = time.time() - self._started_s
        self._clocks: dict[str, KeptClock] = {}
        self._clocks_lock = Lock()
        self._desks: dict[str, RobotDesk] = {}
        self._intake: Intake[Item] = Intake(self.params.queue_envelopes, self.params.queue_bytes)
        self._stopping = False
        self._closed = False
        self._session: Session | None = None
        if fresh:
            set_aside(folder)
        for robot in robots_in(folder):
            self._ask_clock(robot, b"")
            self._open_desk(robot)

    @property
    def brought_back(self) -> dict[str, int]:
        """How many entries stand of each robot."""
        return {robot: len(desk.kept.standing) for robot, desk in self._desks.items()}

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
            session.serve(f"ski/*/@keeper/{what}", self._answer_clock)
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
        for desk in self._desks.values():
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
            desk = self._desks.get(robot) or self._new_desk(robot, arrived)
            if desk is not None:
                self._say(desk.take(arrived, now_s))
        for question in questions:
            self._answer(question, now_s)
        for desk in self._desks.values():
            self._tend(desk, now_s)

    def status(self) -> KeeperStatus:
        """Return how all is doing."""
        boards = [desk.status() for desk in self._desks.values()]
        return KeeperStatus(
            boot=self.boot,
            version=version("sensory-knowledge-integrator"),
            pid=os.getpid(),
            machine=platform.node(),
            address=self.link.address,
            folder=str(self.folder),
            uptime_s=time.monotonic() - self._started_s,
            clients=sum(boot.linked for desk in self._desks.values() for _, boot in desk.hosts.boots()),
            overflowed=self._intake.overflowed,
            refused=dict(self.refusals.by_reason),
            rejected=dict(self._rejected()),
            boards=boards,
        )

    # Desks and clocks

    def _open_desk(self, robot: str) -> RobotDesk:
        desk = self._desks[robot] = RobotDesk(
            robot,
            self.folder / robot,
            self._checker,
            self.params,
            lambda: self._clock_s(robot),
            self.boot,
            time.monotonic(),
        )
        return desk

    def _new_desk(self, robot: str, arrived: list[Arrived]) -> RobotDesk | None:
        """Open the board of a robot that posts something fit for one; None, with the refusals counted, where nothing is."""
        for message in arrived:
            try:
                self._checker.check(message.key, message.payload, read_origin(message.attachment))
            except Refused as refused:
                self._refuse(refused.reason, str(refused))
                continue
            except MessageError as error:
                self._refuse("attachment", f"{message.key}: {error}")
                continue
            return self._desk(robot)
        return None

    def _desk(self, robot: str) -> RobotDesk | None:
        """Return a robot's desk, opened where there is none yet; None where there are too many robots."""
        desk = self._desks.get(robot)
        if desk is not None:
            return desk
        if not is_chunk(robot) or len(self._desks) >= self.params.robots:
            self._refuse("robots", f"'{robot}' would be one robot more than {self.params.robots}, or is no name")
            return None
        try:
            return self._open_desk(robot)
        except SkiError as error:
            self._refuse("folder", str(error))
            return None

    def _clock_s(self, robot: str) -> float | None:
        clock = self._clocks.get(robot)
        return clock.now_s if clock is not None else None

    def _wall_s(self) -> float:
        return time.monotonic() + self._wall_minus_monotonic_s  # a wall clock that is set meanwhile moves no mission

    # What comes

    def _linked(self, linked: Linked, now_s: float) -> None:
        chunks = linked.key.split("/")
        boot = chunks[-1]
        desk = self._desk_of_host(linked.key, boot)
        if desk is not None:
            desk.hosts.linked(chunks[3], boot, linked.alive, now_s)

    def _beaten(self, beaten: Beaten, now_s: float) -> None:
        try:
            beat = msgspec.json.decode(beaten.payload, type=HostBeat)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            self._refuse("beat", f"{beaten.key}: {error}")
            return
        desk = self._desk_of_host(beaten.key, beat.boot)
        if desk is not None:
            desk.host_beat(beaten.key.split("/")[3], beat, now_s)

    def _desk_of_host(self, key: str, boot: str) -> RobotDesk | None:
        """Return the desk that a host's beat or token is for; None, counted, where the key or the boot is malformed."""
        chunks = key.split("/")
        if len(chunks) < 5 or not is_chunk(chunks[3]) or not is_chunk(boot):
            self._refuse("host", f"{key}: host and boot must be names, not {boot[:80]!r}")
            return None
        desk = self._desk(chunks[1])
        if desk is not None and not desk.hosts.takes(chunks[3]):
            self._refuse("host", f"{key}: more hosts than anybody has")
            return None
        return desk

    def _refuse(self, reason: str, text: str) -> None:
        said = self.refusals.note(reason, text, "?")
        self._say([said] if said is not None else [])

    def _say(self, lines: list[str]) -> None:
        for line in lines:
            self._tell(line)

    # Answers

    def _answer_clock(self, question: Question) -> None:
        """Answer at once, on zenoh's thread: the way there and back is measured by it."""
        try:
            may_begin = question.key.endswith("/begin")  # which takes more rights than to ask
            answer = self._ask_clock(robot_of(question.key), question.payload, may_begin)
            question.reply(question.key, msgspec.json.encode(answer))
        except SkiError as error:
            with suppress(LinkError):
                question.fail(str(error))
        question.finish()

    def _ask_clock(self, robot: str, question: bytes, may_begin: bool = False) -> ClockAnswer:
        """Ask a robot's clock; one that begins is kept."""
        with self._clocks_lock:
            clock = self._clocks.get(robot) or KeptClock(self.folder / robot, self._wall_s)
            answer = clock.answer(question, may_begin)
            if answer.now_s is not None and robot not in self._clocks:
                self._clocks[robot] = clock
            return answer

    def _answer(self, question: Question, now_s: float) -> None:
        try:
            self._reply(question, now_s)
        except SkiError as error:
            with suppress(LinkError):  # who asked is gone
                question.fail(str(error))
        finally:
            question.finish()

    def _reply(self, question: Question, now_s: float) -> None:
        if question.key == KEEPER_STATUS:
            question.reply(question.key, msgspec.json.encode(self.status()))
            return
        chunks = question.key.split("/")
        if len(chunks) == 4 and chunks[2:] == ["@keeper", "snapshot"]:
            desk = self._desks.get(chunks[1])
            nothing = join_snapshot(Snapshot(boot=self.boot, now_s=None, lanes={}), [])
            question.reply(question.key, desk.snapshot() if desk is not None else nothing)
        elif len(chunks) == 4 and chunks[2:] == ["@keeper", "lost"]:
            self._reply_lost(question, chunks[1])
        elif len(chunks) == 5 and chunks[2] == "@late":
            self._reply_late(question, chunks[1], "/".join(chunks[3:]), now_s)
        else:
            for desk in self._desks.values():
                for key, envelope in desk.kept.standing.matching(question.key):
                    question.reply(key, envelope.payload, attachment_of(envelope.origin))

    def _reply_lost(self, question: Question, robot: str) -> None:
        try:
            asked = msgspec.json.decode(question.payload, type=LostQuestion)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            raise MessageError(f"{question.key}: not a question for lost envelopes ({error})") from None
        desk = self._desks.get(robot)
        question.reply(question.key, join_batch(desk.kept.lost(asked) if desk is not None else []))

    def _reply_late(self, question: Question, robot: str, place: str, now_s: float) -> None:
        panel = place.split("/")[0]
        if panel not in PANELS:
            raise BoardError(f"{question.key}: there is no panel '{panel}'")
        envelopes = split_batch(question.payload)
        desk = self._desk(robot)
        if desk is None:
            raise BoardError(f"{question.key}: no board for it")
        self._say(desk.take_late(place, envelopes, now_s))
        if desk.kept.journal.trouble:
            raise BoardError(f"{desk.kept.journal.path}: cannot be written ({desk.kept.journal.trouble})")
        question.reply(question.key, desk.told(now_s))

    def _tend(self, desk: RobotDesk, now_s: float) -> None:
        for message, origin in desk.posts(now_s):
            if self._session is not None:
                self._session.put(message.key, message.payload, message.attachment, origin.lane)
        if desk.beat_due(now_s) and self._session is not None:
            self._session.put(keeper(desk.robot, "beat"), desk.beat(now_s), lane="control")
        desk.tend(now_s)
        clock = self._clocks.get(desk.robot)
        if clock is not None:
            clock.keep()
