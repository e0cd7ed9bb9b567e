"""One robot's board as the keeper holds it: taken in, written down, answered from, and brought back after a restart."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from blackboard.errors import MessageError
from blackboard.keeper.checking import Checked, Checker, Refusals, Refused, key_of, lanes_at
from blackboard.keeper.checkpoint import read_checkpoint, write_checkpoint
from blackboard.keeper.journal_file import JournalFile, journalled, read_journalled
from blackboard.keeper.journal_index import JournalIndex
from blackboard.keeper.params import KeeperParams
from blackboard.keeper.positions import LanePositions
from blackboard.keeper.refused_file import note_refused, read_refused
from blackboard.keeper.standing import Standing
from blackboard.link.envelope import Envelope, LostQuestion, Origin, attachment_of, read_origin
from blackboard.link.lanes import QUALITY
from blackboard.link.session import Arrived

_REPAIRED = frozenset(lane for lane, quality in QUALITY.items() if quality.repaired)


class Took(NamedTuple):
    """What became of a batch: how many are new and written, and what is to be told."""

    taken: int
    written: bool
    tell: list[str]


class KeptBoard:
    """Standing entries, positions and journal of one robot, in a folder of its own."""

    def __init__(self, folder: Path, checker: Checker, params: KeeperParams) -> None:
        self.folder = folder
        self.params = params
        self.journal = JournalFile(folder)
        self.standing = Standing(checker.vocabulary, params.tombstones)
        self.positions = LanePositions(params.boots)
        self.index = JournalIndex(params.findable_envelopes)
        self.refusals = Refusals()
        self.taken = 0
        self.duplicates = 0
        self.strange_lines = 0
        self._checker = checker
        self._checkpoint_bytes = 0
        self._restore()

    # Taking in

    def take(self, arrived: Iterable[Arrived], now_s: float = 0.0) -> Took:
        """Check, write down and take in what came, in order; `now_s` is whatever clock the beats go by."""
        good: list[Checked] = []
        bad: list[tuple[Origin, str, str]] = []
        fresh: set[Origin] = set()
        heard: set[tuple[str, str]] = set()
        tell: list[str] = []
        check, positions = self._checker.check, self.positions
        for message in arrived:
            key = message.key
            try:
                try:
                    origin = read_origin(message.attachment)
                except MessageError as error:
                    raise Refused("attachment", f"{key}: {error}", None) from None
                if origin in fresh or positions.holds(origin):
                    self.duplicates += 1
                    heard.add((origin.host, origin.boot))  # who sends again has not heard the beat
                    continue
                good.append(check(key, message.payload, origin))
                fresh.add(origin)
            except Refused as refused:
                self._refuse(refused, key, bad, tell)
        took = self._write(good, bad, tell)
        heard.update((origin.host, origin.boot) for origin, *_ in (*good, *bad))
        for host, boot in heard:
            self.positions.hear(host, boot, now_s)
        return took

    def take_late(self, robot: str, place: str, envelopes: Sequence[Envelope], now_s: float = 0.0) -> Took:
        """Take in what a poster hands in late for one place, where it may post; what belongs elsewhere is refused."""
        arrived = []
        tell: list[str] = []
        for origin, payload in envelopes:
            try:
                key = key_of(payload)
            except MessageError:
                key = f"ski/{robot}/{place}"  # refused there, with the reason
            if key.split("/")[:4] != ["ski", robot, *place.split("/")]:
                said = self.refusals.note("place", f"{key} was handed in for ski/{robot}/{place}", origin.host)
                tell += [said] if said is not None else []
                continue
            arrived.append(Arrived(key, payload, attachment_of(origin)))
        took = self.take(arrived, now_s)
        return took._replace(tell=tell + took.tell)

    def _refuse(self, refused: Refused, key: str, bad: list[tuple[Origin, str, str]], tell: list[str]) -> None:
        origin = refused.origin
        said = self.refusals.note(refused.reason, str(refused), origin.host if origin is not None else "?")
        if said is not None:
            tell.append(said)
        if origin is not None and origin.lane in lanes_at(key) and refused.reason != "lane":
            bad.append((origin, refused.reason, str(refused)))

    def _write(self, good: list[Checked], bad: list[tuple[Origin, str, str]], tell: list[str]) -> Took:
        lines = [journalled(c.origin, c.payload) for c in good]
        offset = self.journal.size_bytes
        if good and not self.journal.append(b"".join(lines)):
            return Took(0, False, tell)
        for (origin, payload, entry), line in zip(good, lines, strict=True):
            self._add(origin)
            self.standing.take(origin, payload, entry)
            self.index.add(origin[:3], origin.number, offset)
            offset += len(line)
        if bad and note_refused(self.folder, bad):
            for origin, _, _ in bad:
                self._add(origin)
        self.taken += len(good)
        return Took(len(good), True, tell)

    def _add(self, origin: Origin) -> None:
        self.positions.at(origin.host, origin.boot, origin.lane).add(origin.number)

    # Answering

    def lost(self, question: LostQuestion) -> list[Envelope]:
        """Return what a reader missed and is still held; commands are never handed on late."""
        if question.lane not in _REPAIRED:
            return []
        lane = (question.host, question.boot, question.lane)
        found: list[Envelope] = []
        size = 0
        for number, offset in self.index.between(lane, question.first, question.last):
            envelope = read_journalled(self.journal.line_at(offset))
            if envelope is not None and envelope.origin == (*lane, number):
                size += len(envelope.payload)
                if size > self.params.answer_bytes and found:
                    break
                found.append(envelope)
        return found

    def board(self) -> list[Envelope]:
        """Return what a late joiner needs: what stands and what was retracted."""
        return self.standing.entries() + self.standing.tombstones()

    # Keeping

    @property
    def checkpoint_due(self) -> bool:
        """Say whether a restart would have to read much."""
        return self.journal.size_bytes - self._checkpoint_bytes >= self.params.checkpoint_bytes

    def checkpoint(self) -> None:
        """Write down what is known; where that is not possible the journal still has everything."""
        size = self.journal.size_bytes
        if size != self._checkpoint_bytes:
            with suppress(OSError):
                write_checkpoint(self.folder, size, self.journal.tail_of(size), self.positions, self.board())
                self._checkpoint_bytes = size

    def close(self) -> None:
        """Write a checkpoint and close the journal."""
        self.checkpoint()
        self.journal.close()

    def _restore(self) -> None:
        start = 0
        found = read_checkpoint(self.folder)
        if found is not None:
            header, envelopes = found
            fits = header.journal_bytes <= self.journal.size_bytes
            if fits and self.journal.tail_of(header.journal_bytes) == header.journal_tail:
                start = self._checkpoint_bytes = header.journal_bytes
                for envelope in envelopes:
                    self._stand(envelope)
                for mark in header.positions:
                    position = self.positions.at(mark.host, mark.boot, mark.lane)
                    position.up_to, position.beyond = mark.up_to, list(mark.beyond)
        for offset, line in self.journal.lines(
            min(start, max(0, self.journal.size_bytes - self.params.read_back_bytes))
        ):
            read = read_journalled(line)
            if read is None:
                self.strange_lines += 1
                continue
            self.index.add(read.origin[:3], read.origin.number, offset)
            if offset >= start:
                self._add(read.origin)
                self._stand(read)
        for origin in read_refused(self.folder):
            self._add(origin)

    def _stand(self, envelope: Envelope) -> None:
        """Let what was written down stand again; what this vocabulary does not know stays in the journal only."""
        try:
            checked = self._checker.check(key_of(envelope.payload), envelope.payload, envelope.origin)
        except (Refused, MessageError):
            self.strange_lines += 1
            return
        self.standing.take(checked.origin, checked.payload, checked.entry)
