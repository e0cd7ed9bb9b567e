"""One process's replica of a board: what is posted here goes to the others, what they post comes in, and nothing is lost.

zenoh's threads put what comes on one queue; the process's own loop takes it from there and hands it to `handle`. Everything on the
board happens on that loop, so components cannot tell.
"""

import os
import secrets
import time
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import msgspec

from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.errors import BoardError, MessageError
from blackboard.history import HistoryParams
from blackboard.journal import JournalLine
from blackboard.link import addresses
from blackboard.link.clock import MEASURE_EVERY_S, ClockAnswer, ClockQuestion, MissionClock
from blackboard.link.envelope import (
    Envelope,
    KeeperBeat,
    LostQuestion,
    Snapshot,
    read_entry,
    read_origin,
    read_payload,
    read_told,
    split_batch,
    split_snapshot,
)
from blackboard.link.inbox import Inbox
from blackboard.link.lanes import LANES, Lane, lane_of, lane_of_place
from blackboard.link.sender import Sender
from blackboard.link.session import Answer, Arrived, Session
from blackboard.messages.hosts import HostBeat
from blackboard.vocabulary import Vocabulary

JOIN_S = 10.0  # a keeper that restarts is back long before

Item = Callable[[], None]  # what came, ready to be handled on the loop


class Replica:
    """A board with its link. Call `join` once, then `handle` what the queue gives, and `tend` several times a second."""

    def __init__(
        self,
        session: Session,
        vocabulary: Vocabulary,
        robot: str,
        host: str,
        *,
        state: Path | None = None,
        history: HistoryParams | None = None,
        lanes: Collection[Lane] = LANES,
        newest: Collection[Lane] = (),
        queue: "SimpleQueue[Item] | None" = None,
    ) -> None:
        """Make a replica for process `host`; `state` is the folder of its outbox, `lanes` what it wants to hear at all.

        Replicas of several boards in one process share a `queue`, so that one loop can wait for all of them.
        """
        self.board = Board(vocabulary, robot=robot, history=history)
        self.clock = MissionClock()
        self.queue: SimpleQueue[Item] = queue if queue is not None else SimpleQueue()
        self.host = host
        self.boot = secrets.token_hex(4)
        self.refused: dict[str, int] = {}  # what came and was unfit, by reason
        self._session = session
        self._robot = robot
        self._inbox = Inbox(host, lanes, newest)
        self._sender = Sender(session, robot, host, self.boot, state, self.queue.put, self._take_beat)
        self.board.outgoing = self._sender.send
        self._measured_s = float("-inf")

    # Joining

    def join(self, *, begin_s: float | None = None, pace: float = 1.0, timeout_s: float = JOIN_S) -> None:
        """Hand in what an earlier boot left, hear everybody, take the standing board, set the clock.

        The robot's host begins the clock at `begin_s`. Raises LinkError where no keeper answers within `timeout_s`.
        """
        end_s = time.monotonic() + timeout_s
        self._sender.hand_in_left(end_s)
        self._session.subscribe(addresses.keeper(self._robot, "beat"), self._sink(self._keeper_beat))
        self._session.subscribe(addresses.entries(self._robot), self._sink(self._arrived))
        text = self._session.must_answer(addresses.keeper(self._robot, "snapshot"), b"", end_s)
        self._load(text, tell=False)
        what = "clock" if begin_s is None else "begin"
        question = msgspec.json.encode(ClockQuestion(begin=begin_s, pace=pace))
        for _ in range(3):
            asked_s = time.monotonic()
            payload = self._session.must_answer(addresses.keeper(self._robot, what), question, end_s)
            self.clock.measured(asked_s, time.monotonic(), time.time(), read_told(payload, ClockAnswer))
        self._session.announce(addresses.host_alive(self._robot, self.host, self.boot))

    def now_s(self) -> float:
        """Return the mission's clock; the last known where it has not begun."""
        return self.clock.at(time.monotonic()) if self.clock.running else self.board.now_s

    def handle(self, item: Item) -> None:
        """Do what the queue gave: entries that came stand on the board afterwards."""
        item()

    def tend(self) -> None:
        """Ask for what is missing, hand in what was lost on the way, measure the clock."""
        now_s = time.monotonic()
        for question in self._inbox.gaps():
            self._ask_lost(question)
        for envelope in self._inbox.overdue(now_s):
            self._deliver(envelope)
        self._sender.hand_in()
        if not self.clock.running or now_s - self._measured_s >= MEASURE_EVERY_S:
            self._measured_s = now_s
            self._measure()

    def beat(self, components: Sequence[str], machine: str, version: str, *, leaving: bool = False) -> None:
        """Tell that this process's loop goes round, and how far it has posted."""
        running = self.clock.running
        beat = HostBeat(
            boot=self.boot,
            pid=os.getpid(),
            machine=machine,
            version=version,
            components=tuple(components),
            lanes={lane: number for lane, number in self._sender.numbers.items() if number},
            offset_s=self.clock.best.wall_offset_s if running else 0.0,
            round_trip_s=self.clock.best.round_trip_s if running else 0.0,
            missed=self._inbox.skipped,
            leaving=leaving,
        )
        self._session.put(addresses.host_beat(self._robot, self.host), msgspec.json.encode(beat), lane="command")

    @property
    def trouble(self) -> str:
        """What a person must do something about; empty where all is well."""
        return self._sender.trouble

    @property
    def keeper_heard_s(self) -> float:
        """When the keeper was last heard, by the monotonic clock."""
        return self._sender.keeper_heard_s

    @property
    def unacknowledged(self) -> int:
        """How many envelopes the keeper has not acknowledged."""
        return len(self._sender)

    def close(self) -> None:
        """Let go of the outbox; what is not acknowledged stays on disk for the next boot."""
        self.board.outgoing = None
        self._sender.close()

    # What comes: sinks on zenoh's threads only queue

    def _sink(self, take: Callable[[Arrived], None]) -> Callable[[Arrived], None]:
        put = self.queue.put
        return lambda arrived: put(lambda: take(arrived))

    def _later(self, take: Callable[[Sequence[Answer]], None]) -> Callable[[Sequence[Answer]], None]:
        put = self.queue.put
        return lambda answers: put(lambda: take(answers))

    def _arrived(self, arrived: Arrived) -> None:
        try:
            origin = read_origin(arrived.attachment)
        except MessageError as error:
            self._refuse("attachment", error)
            return
        # Key and lane before anything waits or counts: what one may post under a key must not end up under another, nor take
        # a number from those who post in that lane.
        try:
            line = read_payload(arrived.key, arrived.payload)
            self._see_that_it_fits(arrived.key, origin.lane)
        except MessageError as error:
            self._refuse("message", error)
            return
        for envelope in self._inbox.take(Envelope(origin, arrived.payload)):
            self._deliver(envelope, line if envelope.payload is arrived.payload else None)

    def _see_that_it_fits(self, key: str, lane: Lane) -> None:
        try:
            own = lane_of(self.board.vocabulary.parse_key(key)[1])
        except BoardError:
            own = lane_of_place(addresses.place_of(key))
        if lane != own:
            raise MessageError(f"{key}: belongs to lane {own}, came in lane {lane}")

    def _deliver(self, envelope: Envelope, line: JournalLine | None = None) -> None:
        entry = self._read(envelope, line)
        if entry is not None:
            self.board.accept(entry)

    def _read(self, envelope: Envelope, line: JournalLine | None) -> Entry[Any] | None:
        """Return an envelope's entry, its `line` read already or not; count what is unfit and pass over it."""
        try:
            if line is None:
                line = read_payload(None, envelope.payload)
            return read_entry(self.board.vocabulary, line)[1]
        except MessageError as error:
            self._refuse("message", error)
        except BoardError as error:
            self._refuse("key", error)
        return None

    def _refuse(self, reason: str, error: Exception) -> None:
        self.refused[reason] = self.refused.get(reason, 0) + 1

    def _keeper_beat(self, arrived: Arrived) -> None:
        self._take_beat(arrived.payload)
        for question in self._inbox.gaps():
            self._ask_lost(question)

    def _take_beat(self, text: bytes) -> None:
        """Take note of how far the keeper holds every lane."""
        try:
            beat = msgspec.json.decode(text, type=KeeperBeat)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            self._refuse("beat", error)
            return
        self._sender.acknowledged(beat.lanes.get(self.host, {}).get(self.boot, {}))
        self._inbox.told(beat.lanes)

    def _ask_lost(self, question: LostQuestion) -> None:
        def answered(answers: Sequence[Answer]) -> None:
            held = [a for a in answers if not a.error]
            if not held:
                self._inbox.unanswered(question)
                return
            try:
                envelopes = split_batch(held[0].payload)
            except MessageError as error:
                self._refuse("batch", error)
                self._inbox.unanswered(question)
                return
            skipped = self._inbox.skipped
            for envelope in self._inbox.answered(question, envelopes):
                self._deliver(envelope)
            if self._inbox.skipped > skipped:
                self._take_snapshot()

        key = addresses.keeper(self._robot, "lost")
        self._session.ask_later(key, msgspec.json.encode(question), self._later(answered))

    def _take_snapshot(self) -> None:
        """What was missed is not to be had: at least what stands must be right."""

        def answered(answers: Sequence[Answer]) -> None:
            for answer in answers:
                if not answer.error:
                    self._load(answer.payload, tell=True)

        self._session.ask_later(addresses.keeper(self._robot, "snapshot"), b"", self._later(answered))

    def _load(self, text: bytes, *, tell: bool) -> Snapshot:
        header, envelopes = split_snapshot(text)
        entries = [entry for e in envelopes if (entry := self._read(e, None)) is not None]
        if tell:
            for entry in entries:
                self.board.accept(entry)
        else:
            self.board.load(entries)
        for envelope in self._inbox.start(header.lanes):
            self._deliver(envelope)
        return header

    def _measure(self) -> None:
        asked_s = time.monotonic()
        came: list[tuple[float, float]] = []

        def sink(answers: Sequence[Answer]) -> None:
            came.append((time.monotonic(), time.time()))
            self.queue.put(lambda: take(answers))

        def take(answers: Sequence[Answer]) -> None:
            for answer in answers:
                if not answer.error:
                    try:
                        clock = read_told(answer.payload, ClockAnswer)
                    except MessageError as error:
                        self._refuse("clock", error)
                        continue
                    self.clock.measured(asked_s, came[0][0], came[0][1], clock)

        self._session.ask_later(addresses.keeper(self._robot, "clock"), b"{}", sink)
