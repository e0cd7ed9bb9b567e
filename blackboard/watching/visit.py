"""A person on a board: one who comes, says one thing, sees that the keeper has it, and goes.

A visit takes the board as it stands, so that whatever a component may not do (post what another owns, a stamp that runs back) is
refused here, before anything is sent.
"""

import secrets
import time
from typing import Any

import msgspec

from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.errors import BoardError, LinkError, MessageError
from blackboard.journal import line_of
from blackboard.kinds import Kind
from blackboard.link import addresses
from blackboard.link.envelope import (
    Envelope,
    KeeperBeat,
    Origin,
    attachment_of,
    join_batch,
    read_entry,
    read_payload,
    split_snapshot,
)
from blackboard.link.lanes import Lane, lane_of
from blackboard.link.session import Session
from blackboard.vocabulary import Vocabulary
from blackboard.watching.listening import Listener
from blackboard.watching.summary import printable

HOST = "visitor"
ACKNOWLEDGED_S = 1.0  # five of the keeper's beats; what is not acknowledged by then is handed in
SNAPSHOT_S = 10.0


class Visit:
    """One visit to a robot's board. `board` is what stands; what is posted there goes to the keeper by `send`."""

    def __init__(self, session: Session, vocabulary: Vocabulary, robot: str) -> None:
        """Take what stands. Raises LinkError where the keeper does not answer."""
        self._session = session
        self._robot = robot
        self._boot = secrets.token_hex(4)
        self._number = 0
        self._said: list[tuple[Lane, Entry[Any], bytes]] = []
        self._beats = Listener(session, addresses.keeper(robot, "beat"))
        self.board = Board(vocabulary, robot=robot)
        header, envelopes = split_snapshot(self._ask(addresses.keeper(robot, "snapshot"), b"", SNAPSHOT_S))
        entries = [entry for envelope in envelopes if (entry := _read(vocabulary, envelope)) is not None]
        self.board.load(entries)
        newest_s = max((entry.stamp_s for entry in entries), default=0.0)
        self.board.now_s = newest_s if header.now_s is None else header.now_s
        self.board.outgoing = self._note

    def send(self) -> list[bytes]:
        """Send what was said since the last time, and return it as it travels once the keeper has it.

        Raises LinkError where the keeper does not take it.
        """
        said, self._said = self._said, []
        for lane, entry, payload in said:
            self._number += 1
            origin = Origin(HOST, f"{self._boot}-{self._number}", lane, 1)  # a boot each: there is never a gap
            self._session.put(entry.key, payload, attachment_of(origin), lane)
            if not self._acknowledged(origin):
                self._hand_in(Envelope(origin, payload), entry)
            self._see_that_it_stands(entry)
        return [payload for _, _, payload in said]

    def _note(self, kind: Kind[Any], entry: Entry[Any], raw: bytes) -> None:
        payload = line_of(entry, raw)
        read_payload(entry.key, payload)  # what people say may be too long, for one
        self._said.append((lane_of(kind), entry, payload))

    def _acknowledged(self, origin: Origin) -> bool:
        for arrived in self._beats.until(time.monotonic() + ACKNOWLEDGED_S):
            if arrived is not None and _holds(arrived.payload, origin):
                return True
        return False

    def _hand_in(self, envelope: Envelope, entry: Entry[Any]) -> None:
        place = addresses.place_of(entry.key)
        answer = self._ask(addresses.late(self._robot, place), join_batch([envelope]), 5.0)
        if not _holds(answer, envelope.origin):
            raise LinkError(f"{entry.key}: the keeper has not taken it; `ski doctor` says why")

    def _see_that_it_stands(self, entry: Entry[Any]) -> None:
        """Raise LinkError where the keeper refused what was sent: it acknowledges that too."""
        stands = [a for a in self._session.ask(entry.key) if not a.error]
        revision = read_payload(entry.key, stands[0].payload).revision if stands else 0
        if entry.event != "retracted" and revision < entry.revision:
            raise LinkError(f"{entry.key}: the keeper refused it; `ski doctor` says why")

    def _ask(self, key: str, payload: bytes, timeout_s: float) -> bytes:
        answers = self._session.ask(key, payload, timeout_s=timeout_s)
        for answer in answers:
            if answer.error:
                raise LinkError(f"the keeper refused {key}: {printable(answer.error)}")
            return answer.payload
        raise LinkError(f"the keeper does not answer for the board of '{self._robot}', or these keys may not ask it")


def _read(vocabulary: Vocabulary, envelope: Envelope) -> Entry[Any] | None:
    """Return an envelope's entry; None for a kind that this vocabulary does not have."""
    try:
        return read_entry(vocabulary, read_payload(None, envelope.payload))[1]
    except (BoardError, MessageError):
        return None


def _holds(beat: bytes, origin: Origin) -> bool:
    try:
        lanes = msgspec.json.decode(beat, type=KeeperBeat).lanes
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return False
    return lanes.get(origin.host, {}).get(origin.boot, {}).get(origin.lane, 0) >= origin.number
