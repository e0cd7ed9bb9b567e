"""How the keeper and all it holds are doing: what `ski board status` shows."""

from collections.abc import Iterator

import msgspec

from blackboard.link.lanes import Lane


class LaneStatus(msgspec.Struct, frozen=True, kw_only=True):
    """One lane of one boot of a host: envelopes that it sent as far as is known, those held, those overdue."""

    host: str
    boot: str
    lane: Lane
    posted: int
    held: int
    missing: int


class HostLine(msgspec.Struct, frozen=True, kw_only=True):
    """One host."""

    host: str
    state: str
    boot: str
    machine: str = ""
    offset_s: float = 0.0
    detail: str = ""


class BoardStatus(msgspec.Struct, frozen=True, kw_only=True):
    """One robot's board. `refused` counts by reason; `trouble` says why nothing is acknowledged."""

    robot: str
    now_s: float | None
    standing: int
    taken: int
    duplicates: int
    refused: dict[str, int]
    refusals: dict[str, str]  # the newest of each reason
    strange_lines: int  # of the journal, that could not be brought back
    journal: str
    journal_bytes: int
    trouble: str
    lanes: list[LaneStatus]
    hosts: list[HostLine]

    @property
    def missing(self) -> int:
        """How many envelopes should be there and are not."""
        return sum(lane.missing for lane in self.lanes)


class KeeperStatus(msgspec.Struct, frozen=True, kw_only=True):
    """The keeper's own."""

    boot: str
    version: str
    pid: int
    machine: str
    address: str
    folder: str
    uptime_s: float
    clients: int  # hosts that are linked
    overflowed: int  # dropped on arrival, since too much was waiting; they come again
    refused: dict[str, int]  # what belongs to no board
    rejected: dict[str, int]  # by access control: what somebody may not do
    boards: list[BoardStatus]

    @property
    def missing(self) -> int:
        """How many envelopes should be there and are not."""
        return sum(board.missing for board in self.boards)

    @property
    def troubled(self) -> list[str]:
        """The robots whose journals cannot be written."""
        return [board.robot for board in self.boards if board.trouble]


def told(status: KeeperStatus) -> Iterator[str]:
    """Yield a status as lines of text."""
    yield (
        f"keeper {status.boot} (process {status.pid} on {status.machine}, ski {status.version}) at {status.address}, "
        f"up {_duration(status.uptime_s)}, {status.clients} hosts linked"
    )
    yield f"journals in {status.folder}"
    if status.overflowed:
        yield f"{status.overflowed} envelopes came faster than they could be taken; their posters hand them in again"
    yield from _counted("refused", status.refused, {})
    yield from _counted("rejected by access control", status.rejected, {})
    for board in status.boards:
        yield ""
        clock = "clock not begun" if board.now_s is None else f"clock {board.now_s:.1f} s"
        yield f"board of {board.robot}: {board.standing} entries stand, {board.taken} taken, {clock}"
        yield f"  journal {board.journal} ({board.journal_bytes / 1e6:.1f} MB)"
        if board.trouble:
            yield f"  NOT WRITTEN: {board.trouble}; nothing is acknowledged until the journal can be written again"
        if board.strange_lines:
            yield f"  {board.strange_lines} lines of the journal could not be brought back (another mission's kinds?)"
        yield from (f"  {line}" for line in _counted("refused", board.refused, board.refusals))
        for host in board.hosts:
            offset = f", clock {host.offset_s:+.3f} s" if abs(host.offset_s) >= 0.001 else ""
            detail = f": {host.detail}" if host.detail else ""
            yield f"  host {host.host} {host.state} (boot {host.boot}{offset}){detail}"
        yield from _table(board.lanes)
    yield ""
    if status.troubled:
        yield f"what comes now cannot be written down: {', '.join(status.troubled)}"
    yield "nothing is missing" if not status.missing else f"{status.missing} envelopes are MISSING"


def _table(lanes: list[LaneStatus]) -> Iterator[str]:
    rows = [["host", "boot", "lane", "posted", "held", "missing"]]
    rows += [[x.host, x.boot, x.lane, str(x.posted), str(x.held), str(x.missing)] for x in lanes]
    widths = [max(len(row[i]) for row in rows) for i in range(6)]
    for row in rows if lanes else []:
        words = [f"{word:{width}}" for word, width in zip(row[:3], widths[:3], strict=True)]
        numbers = [f"{word:>{width}}" for word, width in zip(row[3:], widths[3:], strict=True)]
        yield "  " + "  ".join(words + numbers)


def _counted(what: str, counts: dict[str, int], examples: dict[str, str]) -> Iterator[str]:
    for reason, count in sorted(counts.items()):
        example = f", such as {examples[reason]}" if reason in examples else ""
        yield f"{what}: {count} ({reason}{example})"


def _duration(seconds: float) -> str:
    minutes, hours = int(seconds // 60), int(seconds // 3600)
    return f"{seconds:.0f} s" if not minutes else f"{minutes} min" if not hours else f"{hours} h {minutes % 60} min"
