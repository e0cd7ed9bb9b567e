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
from blackboard.errors import BoardError, LinkError, MessageError
from blackboard.history import HistoryParams
from blackboard.journal import JournalLine, line_of
from blackboard.kinds import Kind
from blackboard.link import addresses
from blackboard.link.clock import MEASURE_EVERY_S, ClockAnswer, ClockQuestion, MissionClock
from blackboard.link.envelope import (
    Envelope,
    KeeperBeat,
    LostQuestion,
    Origin,
    Snapshot,
    attachment_of,
    join_batch,
    read_entry,
    read_origin,
    read_payload,
    read_told,
    split_batch,
    split_snapshot,
)
from blackboard.link.inbox import Inbox
from blackboard.link.lanes import LANES, Lane, lane_of, lane_of_place
from blackboard.link.outbox import Outbox
from blackboard.link.session import Answer, Arrived, Session
from blackboard.messages.hosts import HostBeat
from blackboard.vocabulary import Vocabulary

WINDOW = 2000  # envelopes of a lane sent at once without an acknowledgement; more goes to the keeper in batches
LATE_AFTER_S = 0.5  # two and a half of the keeper's beats: what is not acknowledged by then was dropped on the way
LATE_BYTES = 1_000_000  # of one batch
LATE_ANSWER_S = 5.0
NOT_TAKEN = 10  # batches in a row without an answer from a keeper that is there
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
        self.board.outgoing = self._send
        self.clock = MissionClock()
        self.queue: SimpleQueue[Item] = queue if queue is not None else SimpleQueue()
        self.host = host
        self.boot = secrets.token_hex(4)
        self.refused: dict[str, int] = {}  # what came and was unfit, by reason
        self._session = session
        self._robot = robot
        self._inbox = Inbox(host, lanes, newest)
        self._outbox = Outbox(state / "outbox" if state is not None else None)
        self._numbers: dict[Lane, int] = dict.fromkeys(LANES, 0)
        self._acknowledged: dict[Lane, int] = dict.fromkeys(LANES, 0)
        self._sent_s: dict[Lane, float] = dict.fromkeys(LANES, 0.0)  # when the oldest unacknowledged may have been lost
        self._unsent: dict[Lane, int] = dict.fromkeys(LANES, 0)  # the last number that was not sent at once
        self._handed: dict[Lane, int] = dict.fromkeys(LANES, 0)  # handed in up to here, acknowledged or not
        self._not_taken = 0  # batches handed in that a keeper which is there did not answer, one for a beat of its
        self._not_taken_s = float("-inf")
        self._late_underway = 0  # batches whose answer has not come
        self._lanes: dict[str, Lane] = {}
        self._measured_s = float("-inf")
        self.keeper_heard_s = float("-inf")  # by the monotonic clock

    # Joining

    def join(self, *, begin_s: float | None = None, pace: float = 1.0, timeout_s: float = JOIN_S) -> None:
        """Hand in what an earlier boot left, hear everybody, take the standing board, set the clock.

        The robot's host begins the clock at `begin_s`. Raises LinkError where no keeper answers within `timeout_s`.
        """
        end_s = time.monotonic() + timeout_s
        self._hand_in_left(end_s)
        self._session.subscribe(addresses.keeper(self._robot, "beat"), self._sink(self._keeper_beat))
        self._session.subscribe(addresses.entries(self._robot), self._sink(self._arrived))
        text = self._must_answer(addresses.keeper(self._robot, "snapshot"), b"", end_s)
        self._load(text, tell=False)
        what = "clock" if begin_s is None else "begin"
        question = msgspec.json.encode(ClockQuestion(begin=begin_s, pace=pace))
        for _ in range(3):
            asked_s = time.monotonic()
            payload = self._must_answer(addresses.keeper(self._robot, what), question, end_s)
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
        if not self._late_underway:
            self._hand_in()
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
            lanes={lane: number for lane, number in self._numbers.items() if number},
            offset_s=self.clock.best.wall_offset_s if running else 0.0,
            round_trip_s=self.clock.best.round_trip_s if running else 0.0,
            missed=self._inbox.skipped,
            leaving=leaving,
        )
        self._session.put(addresses.host_beat(self._robot, self.host), msgspec.json.encode(beat), lane="command")

    @property
    def trouble(self) -> str:
        """What a person must do something about; empty where all is well."""
        if self._outbox.trouble:
            return f"what is posted is kept in memory only, its disk takes nothing ({self._outbox.trouble}); free some space"
        if self._outbox.dropped:
            return "the keeper takes too little of what is posted: the oldest is lost"
        if self._not_taken >= NOT_TAKEN:
            return "the keeper is there and does not take what is posted; may this member's role post it? See `ski board status`"
        return ""

    @property
    def unacknowledged(self) -> int:
        """How many envelopes the keeper has not acknowledged."""
        return len(self._outbox)

    def close(self) -> None:
        """Let go of the outbox; what is not acknowledged stays on disk for the next boot."""
        self.board.outgoing = None
        self._outbox.close()

    # Sending

    def _send(self, kind: Kind[Any], entry: Entry[Any], raw: bytes) -> None:
        lane = self._lanes.get(kind.path)
        if lane is None:
            lane = self._lanes[kind.path] = lane_of(kind)
        number = self._numbers[lane] = self._numbers[lane] + 1
        origin = Origin(self.host, self.boot, lane, number)
        payload = line_of(entry, raw)
        if not self._outbox.waiting(lane):
            self._sent_s[lane] = time.monotonic()
        self._outbox.add(Envelope(origin, payload))
        if number - self._acknowledged[lane] <= WINDOW or lane in ("command", "signal"):
            self._session.put(entry.key, payload, attachment_of(origin), lane)
        else:
            self._unsent[lane] = number
            if not self._late_underway:
                self._hand_in()

    def _overdue(self, lane: Lane, now_s: float) -> bool:
        """Say whether what is not acknowledged of a lane must have been lost on the way."""
        return bool(self._outbox.waiting(lane)) and now_s - self._sent_s[lane] > LATE_AFTER_S

    def _hand_in(self) -> None:
        """Hand what was not sent, or was lost on the way, to the keeper: a batch for each place of the first lane that has some."""
        now_s = time.monotonic()
        for lane in LANES:
            if self._overdue(lane, now_s):
                self._sent_s[lane] = now_s
                self._handed[lane] = self._acknowledged[lane]
            elif self._handed[lane] >= self._unsent[lane]:
                continue
            batches: dict[str, list[Envelope]] = {}
            size = 0
            for envelope in self._outbox.after(lane, self._handed[lane]):
                batches.setdefault(_place_of(envelope.payload), []).append(envelope)
                self._handed[lane] = envelope.origin.number
                size += len(envelope.payload)
                if size >= LATE_BYTES:
                    break
            for place, batch in batches.items():
                self._late_underway += 1
                key = addresses.late(self._robot, place)
                self._session.ask_later(key, join_batch(batch), self._later(self._handed_in), LATE_ANSWER_S)
            if batches:
                return

    def _handed_in(self, answers: Sequence[Answer]) -> None:
        self._late_underway -= 1
        for answer in answers:
            if not answer.error:
                self._take_beat(answer.payload)
        if any(not answer.error for answer in answers):
            self._not_taken = 0
        elif self.keeper_heard_s > self._not_taken_s:  # heard of since the last one: it has not just died
            self._not_taken_s = self.keeper_heard_s
            self._not_taken += 1
        if not self._late_underway and any(self._handed[lane] < self._unsent[lane] for lane in LANES):
            self._hand_in()

    def _hand_in_left(self, end_s: float) -> None:
        left: dict[str, list[Envelope]] = {}
        for envelope in self._outbox.left:
            left.setdefault(_place_of(envelope.payload), []).append(envelope)
        for place, envelopes in left.items():
            batch, size = list[Envelope](), 0
            for envelope in envelopes:
                batch.append(envelope)
                size += len(envelope.payload)
                if size >= LATE_BYTES:
                    self._must_answer(addresses.late(self._robot, place), join_batch(batch), end_s)
                    batch, size = [], 0
            if batch:
                self._must_answer(addresses.late(self._robot, place), join_batch(batch), end_s)
        self._outbox.acknowledge_left()

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
        self.keeper_heard_s = now_s = time.monotonic()
        for lane, number in beat.lanes.get(self.host, {}).get(self.boot, {}).items():
            if lane in LANES and number > self._acknowledged[lane]:
                self._acknowledged[lane] = min(number, self._numbers[lane])
                self._outbox.acknowledge(lane, number)
                self._sent_s[lane] = now_s
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

    def _must_answer(self, key: str, payload: bytes, end_s: float) -> bytes:
        while True:
            for answer in self._session.ask(key, payload, timeout_s=max(0.1, min(2.0, end_s - time.monotonic()))):
                if not answer.error:
                    return answer.payload
                raise LinkError(f"the keeper refused {key}: {answer.error}")
            if time.monotonic() >= end_s:
                raise LinkError(f"no keeper answers for the board of '{self._robot}'; start one with `ski board serve`")


def _place_of(payload: bytes) -> str:
    """Return the place of an entry's payload, whose key stands first in it."""
    return addresses.place_of(payload.split(b'"', 4)[3].decode("ascii", "replace"))
