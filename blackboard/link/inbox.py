"""What arrives, put in order: each lane of each boot of each host without gap and without repetition.

A gap is noticed by the number of what came, or by the keeper's beat; it is asked for, and what came after it waits until it is
closed. Lanes of which only the newest is of use never wait.
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field

from blackboard.link.envelope import Envelope, LostQuestion, Positions
from blackboard.link.lanes import LANES, QUALITY, Lane

Stream = tuple[str, str, Lane]  # host, boot, lane
MAX_EARLY = 5000  # envelopes of a stream that wait for a gap before them; what comes then is asked for again
MAX_ASKED = 5000  # of one question: some megabytes
HOLD_S = (
    10.0  # what waits for longer waits for what nobody will ever hand in: its poster is gone, and its outbox with it
)


@dataclass
class _Position:
    """How far a stream has come: all up to `number` was delivered."""

    number: int = 0
    told: int = 0  # the keeper holds all up to here
    early: dict[int, Envelope] = field(default_factory=dict)
    asked: bool = False  # an answer is on its way
    held_s: float | None = None  # since when something waits for what not even the keeper has


class Inbox:
    """Orders envelopes. `newest` are lanes of which this reader wants the newest only, beside those that never are repaired."""

    def __init__(self, host: str, lanes: Collection[Lane] = LANES, newest: Collection[Lane] = ()) -> None:
        self._host = host
        self._lanes = frozenset(lanes)
        self._unordered = frozenset(lane for lane in LANES if lane in newest or not QUALITY[lane].repaired)
        self._streams: dict[Stream, _Position] = {}
        self.skipped = 0  # envelopes that could not be had

    def start(self, positions: Positions) -> list[Envelope]:
        """Begin where a snapshot ends: what it holds is not asked for. Return what came early and can be delivered now."""
        delivered: list[Envelope] = []
        for stream, number in _flat(positions):
            position = self._streams.setdefault(stream, _Position())
            position.number = max(position.number, number)
            position.told = max(position.told, number)
            position.early = {n: e for n, e in position.early.items() if n > position.number}
            delivered += _follow(position)
        return delivered

    def take(self, envelope: Envelope) -> list[Envelope]:
        """Return what can be delivered now that this one has come, in order."""
        host, boot, lane, number = envelope.origin
        if host == self._host or lane not in self._lanes:
            return []
        position = self._streams.setdefault((host, boot, lane), _Position())
        if number <= position.number:
            return []
        if lane in self._unordered:
            position.number = number
            return [envelope]
        if number != position.number + 1:
            if len(position.early) < MAX_EARLY:
                position.early[number] = envelope
            return []
        position.number = number
        return [envelope, *_follow(position)]

    def gaps(self) -> list[LostQuestion]:
        """Return what to ask the keeper for now: one question for each stream that lacks something the keeper may hold."""
        questions = []
        for (host, boot, lane), position in self._streams.items():
            if lane in self._unordered or position.asked or host == self._host:
                continue
            last = min(position.early) - 1 if position.early else position.told
            last = min(last, position.told) if position.early else last
            last = min(last, position.number + MAX_ASKED)
            if last > position.number:
                position.asked = True
                questions.append(LostQuestion(host=host, boot=boot, lane=lane, first=position.number + 1, last=last))
        return questions

    def overdue(self, now_s: float) -> list[Envelope]:
        """Return what has waited too long for what not even the keeper has, which is skipped; by any clock that runs evenly."""
        delivered: list[Envelope] = []
        for position in self._streams.values():
            if not position.early or position.asked or position.told > position.number:
                position.held_s = None
            elif position.held_s is None:
                position.held_s = now_s
            elif now_s - position.held_s > HOLD_S:
                position.held_s = None
                first = min(position.early)
                self.skipped += first - 1 - position.number
                position.number = first - 1
                delivered += _follow(position)
        return delivered

    def told(self, positions: Positions) -> None:
        """Take note of how far the keeper holds each lane."""
        for stream, number in _flat(positions):
            if stream[2] in self._lanes and stream[0] != self._host:
                position = self._streams.setdefault(stream, _Position())
                position.told = max(position.told, number)

    def answered(self, question: LostQuestion, envelopes: Iterable[Envelope]) -> list[Envelope]:
        """Return what can be delivered after the keeper's answer; what the answer lacks is not to be had and is skipped."""
        position = self._streams[(question.host, question.boot, question.lane)]
        position.asked = False
        for envelope in envelopes:
            number = envelope.origin.number
            if envelope.origin[:3] == (question.host, question.boot, question.lane) and number > position.number:
                position.early[number] = envelope
        delivered: list[Envelope] = []
        while position.number < question.last:
            delivered += _follow(position)
            if position.number >= question.last:
                break
            self.skipped += 1
            position.number += 1
        return delivered + _follow(position)

    def unanswered(self, question: LostQuestion) -> None:
        """The keeper did not answer: ask again later."""
        self._streams[(question.host, question.boot, question.lane)].asked = False


def _follow(position: _Position) -> list[Envelope]:
    follow = []
    while (envelope := position.early.pop(position.number + 1, None)) is not None:
        position.number += 1
        follow.append(envelope)
    return follow


def _flat(positions: Positions) -> Iterable[tuple[Stream, int]]:
    for host, boots in positions.items():
        for boot, lanes in boots.items():
            for lane in LANES:
                if lane in lanes:
                    yield (host, boot, lane), lanes[lane]
