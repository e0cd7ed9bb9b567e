"""All that the keeper does for one robot: its board, its hosts, the proof, and the beat that tells how far it has come."""

from collections.abc import Callable, Iterable
from pathlib import Path

import msgspec

from blackboard.entry import Entry
from blackboard.journal import line_of
from blackboard.keeper.checking import Checker
from blackboard.keeper.expectation import Expectation
from blackboard.keeper.hosts import HostWatch
from blackboard.keeper.kept_board import KeptBoard, Took
from blackboard.keeper.params import KeeperParams
from blackboard.keeper.status import BoardStatus, HostLine, LaneStatus
from blackboard.kinds import HOST
from blackboard.link.envelope import Envelope, KeeperBeat, Origin, Snapshot, attachment_of, join_snapshot, read_entry
from blackboard.link.envelope import read_payload as read_line
from blackboard.link.lanes import lane_of
from blackboard.link.session import Arrived
from blackboard.messages.hosts import HostBeat, HostStatus

KEEPER = "keeper"  # its name as a host and as a source
_LANE = lane_of(HOST)


class RobotDesk:
    """One robot's share. `now_s` everywhere is the keeper's own even clock; `boot` names this start of the keeper."""

    def __init__(
        self,
        robot: str,
        folder: Path,
        checker: Checker,
        params: KeeperParams,
        clock_s: Callable[[], float | None],
        boot: str,
        now_s: float,
    ) -> None:
        self.robot = robot
        self.params = params
        self._clock_s = clock_s
        self.kept = KeptBoard(folder, checker, params)
        self.hosts = HostWatch(params.hung_s, params.starting_s)
        self.expectation = Expectation()
        self.expectation.due_at_once(self.kept.positions)
        self.kept.positions.hear_newest(params.told_boots, now_s)  # after a restart nobody knows what was acknowledged
        self._checker = checker
        self._boot = boot
        self._number = 0
        self._unposted: dict[str, HostStatus] = {}
        self._since_beat = 0
        self._beaten_s = float("-inf")
        self._looked_s = now_s
        self._checked_s = now_s
        self._trouble = ""
        for _, envelope in self.kept.standing.matching(f"ski/{robot}/{HOST.path}/*"):
            status = read_entry(checker.vocabulary, read_line(None, envelope.payload))[1]
            if status.value.state in ("alive", "hung"):
                self.hosts.restore(str(status.id), status.value, now_s)

    # What comes

    def take(self, arrived: Iterable[Arrived], now_s: float) -> list[str]:
        """Take in entries; return what is to be told."""
        return self._note(self.kept.take(arrived, now_s))

    def take_late(self, place: str, envelopes: list[Envelope], now_s: float) -> list[str]:
        """Take in what a poster hands in late; return what is to be told."""
        return self._note(self.kept.take_late(self.robot, place, envelopes, now_s))

    def host_beat(self, host: str, beat: HostBeat, now_s: float) -> None:
        """Take note of a host's beat."""
        self.hosts.beat(host, beat, now_s)
        self.expectation.say(host, beat.boot, beat.lanes)

    # What goes out

    def posts(self, now_s: float) -> list[tuple[Arrived, Origin]]:
        """Post what has changed about the hosts; return it to be sent, journalled as it is."""
        self._unposted.update(self.hosts.changes(now_s))
        sent = []
        for host, status in list(self._unposted.items()):
            message, origin = self._status_entry(host, status)
            took = self.kept.take([message], now_s)
            if not took.written:
                break  # it is tried again
            del self._unposted[host]
            if took.taken:
                self._number = origin.number
                sent.append((message, origin))
        return sent

    def beat_due(self, now_s: float) -> bool:
        """Say whether it is time for a beat."""
        return self._since_beat >= self.params.beat_envelopes or now_s - self._beaten_s >= self.params.beat_s

    def beat(self, now_s: float) -> bytes:
        """Return what to tell everybody: how far this board is written down without a gap."""
        self._since_beat, self._beaten_s = 0, now_s
        return self.told(now_s)

    def told(self, now_s: float) -> bytes:
        """Return the same as an answer to one who hands in what was lost."""
        return msgspec.json.encode(
            KeeperBeat(boot=self._boot, lanes=self.kept.positions.told(now_s - self.params.told_s))
        )

    def snapshot(self) -> bytes:
        """Return the whole board for a late joiner."""
        header = Snapshot(boot=self._boot, now_s=self._clock_s(), lanes=self.kept.positions.told())
        return join_snapshot(header, self.kept.board())

    def tend(self, now_s: float) -> None:
        """Do what is due from time to time."""
        if now_s - self._looked_s >= 1.0:
            self._looked_s = now_s
            self.expectation.look(self.kept.positions)
        if self.kept.checkpoint_due or now_s - self._checked_s >= self.params.checkpoint_s:
            self._checked_s = now_s
            self.kept.checkpoint()

    def status(self) -> BoardStatus:
        """Return how this board is doing."""
        counts = self.expectation.counts(self.kept.positions)
        kept = self.kept
        return BoardStatus(
            robot=self.robot,
            now_s=self._clock_s(),
            standing=len(kept.standing),
            taken=kept.taken,
            duplicates=kept.duplicates,
            refused=dict(kept.refusals.by_reason),
            refusals=dict(kept.refusals.examples),
            strange_lines=kept.strange_lines,
            journal=str(kept.journal.path),
            journal_bytes=kept.journal.size_bytes,
            trouble=kept.journal.trouble,
            lanes=[msgspec.convert(c, LaneStatus, from_attributes=True) for c in counts],
            hosts=[
                HostLine(
                    host=host,
                    state=s.state,
                    boot=s.boot,
                    machine=s.machine,
                    offset_s=s.offset_s,
                    detail=s.detail,
                )
                for host, s in sorted(self.hosts.statuses().items())
            ],
        )

    def _note(self, took: Took) -> list[str]:
        self._since_beat += took.taken
        trouble = self.kept.journal.trouble
        if trouble == self._trouble:
            return took.tell
        self._trouble = trouble
        path = self.kept.journal.path
        if trouble:
            return [*took.tell, f"{path}: cannot be written ({trouble}); nothing is acknowledged until it can"]
        return [*took.tell, f"{path}: is written again"]

    def _status_entry(self, host: str, status: HostStatus) -> tuple[Arrived, Origin]:
        key = f"ski/{self.robot}/{HOST.path}/{host}"
        before = next((envelope for _, envelope in self.kept.standing.matching(key)), None)
        revision, stamp_s = 1, max(0.0, self._clock_s() or 0.0)
        if before is not None:
            line = read_line(None, before.payload)
            revision, stamp_s = line.revision + 1, max(stamp_s, line.stamp_s)
        entry = Entry(
            key=key,
            id=host,
            revision=revision,
            event="posted" if before is None else "revised",
            stamp_s=stamp_s,
            source=KEEPER,
            value=status,
        )
        origin = Origin(KEEPER, self._boot, _LANE, self._number + 1)
        payload = line_of(entry, msgspec.json.encode(status))
        return Arrived(key, payload, attachment_of(origin)), origin
