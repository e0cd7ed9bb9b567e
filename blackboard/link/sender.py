"""What a process posts goes out: numbered, kept until it is acknowledged, and handed in again where it was lost on the way.

Each post is sent at once under its key. Where many wait for their acknowledgement, more goes to the keeper in batches, and readers
ask the keeper for it: a burst costs nobody else anything.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from blackboard.entry import Entry
from blackboard.journal import line_of
from blackboard.kinds import Kind
from blackboard.link import addresses
from blackboard.link.envelope import Envelope, Origin, attachment_of, join_batch
from blackboard.link.lanes import LANES, Lane, lane_of
from blackboard.link.outbox import Outbox
from blackboard.link.session import Answer, Session

WINDOW = 2000  # envelopes of a lane sent at once without an acknowledgement; more goes to the keeper in batches
LATE_AFTER_S = 0.5  # two and a half of the keeper's beats: what is not acknowledged by then was dropped on the way
LATE_BYTES = 1_000_000  # of one batch
LATE_ANSWER_S = 5.0
NOT_TAKEN = 10  # batches in a row without an answer from a keeper that is there

Answers = Sequence[Answer]


class Sender:
    """Sends the posts of one boot of one host. All of it runs on the process's own loop.

    `queue` puts a call on that loop; `told` is given what the keeper answers, which acknowledges like its beat.
    """

    def __init__(
        self,
        session: Session,
        robot: str,
        host: str,
        boot: str,
        state: Path | None,
        queue: Callable[[Callable[[], None]], None],
        told: Callable[[bytes], None],
    ) -> None:
        self.numbers: dict[Lane, int] = dict.fromkeys(LANES, 0)  # of the last envelope of each lane
        self._session = session
        self._robot = robot
        self._host = host
        self._boot = boot
        self._queue = queue
        self._told = told
        self._outbox = Outbox(state / "outbox" if state is not None else None)
        self._acknowledged: dict[Lane, int] = dict.fromkeys(LANES, 0)
        self._sent_s: dict[Lane, float] = dict.fromkeys(LANES, 0.0)  # when the oldest unacknowledged may have been lost
        self._unsent: dict[Lane, int] = dict.fromkeys(LANES, 0)  # the last number that was not sent at once
        self._handed: dict[Lane, int] = dict.fromkeys(LANES, 0)  # handed in up to here, acknowledged or not
        self._not_taken = 0  # batches handed in that a keeper which is there did not answer, one for a beat of its
        self._not_taken_s = float("-inf")
        self.keeper_heard_s = float("-inf")  # by the monotonic clock
        self._underway = 0  # batches whose answer has not come
        self._lanes: dict[str, Lane] = {}

    def send(self, kind: Kind[Any], entry: Entry[Any], raw: bytes) -> None:
        """Send a post, given with its value's JSON."""
        lane = self._lanes.get(kind.path)
        if lane is None:
            lane = self._lanes[kind.path] = lane_of(kind)
        number = self.numbers[lane] = self.numbers[lane] + 1
        origin = Origin(self._host, self._boot, lane, number)
        payload = line_of(entry, raw)
        if not self._outbox.waiting(lane):
            self._sent_s[lane] = time.monotonic()
        self._outbox.add(Envelope(origin, payload))
        if number - self._acknowledged[lane] <= WINDOW or lane in ("command", "signal"):
            self._session.put(entry.key, payload, attachment_of(origin), lane)
        else:
            self._unsent[lane] = number
            self.hand_in()

    def hand_in_left(self, end_s: float) -> None:
        """Hand in what an earlier boot left, waiting for the keeper until then; raise LinkError where it does not take it."""
        left: dict[str, list[Envelope]] = {}
        for envelope in self._outbox.left:
            left.setdefault(_place_of(envelope.payload), []).append(envelope)
        for place, envelopes in left.items():
            key = addresses.late(self._robot, place)
            for batch in _batches(envelopes):
                self._session.must_answer(key, join_batch(batch), end_s)
        self._outbox.acknowledge_left()

    def acknowledged(self, lanes: Mapping[str, int]) -> None:
        """The keeper holds these lanes up to these numbers."""
        self.keeper_heard_s = now_s = time.monotonic()
        for lane in LANES:
            number = lanes.get(lane, 0)
            if number > self._acknowledged[lane]:
                self._acknowledged[lane] = min(number, self.numbers[lane])
                self._outbox.acknowledge(lane, number)
                self._sent_s[lane] = now_s

    def close(self) -> None:
        """Let go of the outbox; what is not acknowledged stays on disk for the next boot."""
        self._outbox.close()

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

    def __len__(self) -> int:
        """How many envelopes the keeper has not acknowledged."""
        return len(self._outbox)

    def _overdue(self, lane: Lane, now_s: float) -> bool:
        """Say whether what is not acknowledged of a lane must have been lost on the way."""
        return bool(self._outbox.waiting(lane)) and now_s - self._sent_s[lane] > LATE_AFTER_S

    def hand_in(self) -> None:
        """Hand what was not sent, or was lost on the way, to the keeper: a batch for each place of the first lane that has some.

        Not before what was handed in last has been answered.
        """
        if self._underway:
            return
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
                self._underway += 1
                key = addresses.late(self._robot, place)
                self._session.ask_later(key, join_batch(batch), self._later, LATE_ANSWER_S)
            if batches:
                return

    def _handed_in(self, answers: Sequence[Answer]) -> None:
        self._underway -= 1
        for answer in answers:
            if not answer.error:
                self._told(answer.payload)
        if any(not answer.error for answer in answers):
            self._not_taken = 0
        elif self.keeper_heard_s > self._not_taken_s:  # heard of since the last one: it has not just died
            self._not_taken_s = self.keeper_heard_s
            self._not_taken += 1
        if any(self._handed[lane] < self._unsent[lane] for lane in LANES):
            self.hand_in()

    def _later(self, answers: Answers) -> None:
        self._queue(lambda: self._handed_in(answers))


def _batches(envelopes: Sequence[Envelope]) -> Iterator[list[Envelope]]:
    batch, size = list[Envelope](), 0
    for envelope in envelopes:
        batch.append(envelope)
        size += len(envelope.payload)
        if size >= LATE_BYTES:
            yield batch
            batch, size = [], 0
    if batch:
        yield batch


def _place_of(payload: bytes) -> str:
    """Return the place of an entry's payload, whose key stands first in it."""
    return addresses.place_of(payload.split(b'"', 4)[3].decode("ascii", "replace"))
