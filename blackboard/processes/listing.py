"""One row for each process of what is up, from what the keeper, the executors and the state folder know of it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from blackboard.keeper.status import KeeperStatus
from blackboard.processes.identity import cpu_s
from blackboard.processes.protocol import KEEPER, AgentReport, ProcessReport
from blackboard.processes.state_folder import AGENT, MANAGER, Record


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A process. What nobody knows is None, or empty. `missing`: entries that it posted and the keeper has not got."""

    process: str
    machine: str = ""
    state: str = ""
    robot: str = ""
    pid: int | None = None
    restarts: int | None = None
    cpu_s: float | None = None
    age_s: float | None = None
    beat_age_s: float | None = None
    offset_s: float | None = None
    missing: int | None = None
    detail: str = ""


def rows_of(
    keeper: KeeperStatus | None, agents: Sequence[AgentReport], records: Sequence[Record], machine: str
) -> list[Row]:
    """Return the rows: keeper, manager and executors first, then hosts by robot and name."""
    pids = {record.name: record.who.pid for record in records}
    found: dict[tuple[str, str], Row] = {}
    if keeper is not None:
        found["", KEEPER] = Row(
            process=KEEPER,
            machine=keeper.machine,
            state="running",
            pid=keeper.pid,
            age_s=keeper.uptime_s,
            offset_s=0.0,
            missing=keeper.missing,
            detail="; ".join(board.trouble for board in keeper.boards if board.trouble),
        )
        found |= dict(_hosts(keeper))
    for agent in agents:
        told = "" if agent.manager else "waits for a manager" + (f", since {agent.why}" if agent.why else "")
        name = f"{AGENT} of {agent.machine}"
        found["", name] = Row(process=name, machine=agent.machine, state="running", pid=agent.pid, detail=told)
        for process in agent.processes:
            key = ("" if process.name == KEEPER else process.robot, process.name)
            found[key] = _joined(found.get(key), process)
    if MANAGER in pids:
        at = next((key for key in found if key[1] == MANAGER), ("", MANAGER))
        row = found.pop(at, Row(process=MANAGER, machine=machine, state="running"))
        found["", MANAGER] = replace(row, pid=pids[MANAGER])
    if not agents:  # nobody to ask: what stands on disk
        for record in records:
            if not any(name == record.name for _, name in found):
                found["", record.name] = Row(process=record.name, machine=machine, state="running", pid=record.who.pid)
    ours = {row.pid for row in found.values()} & (set(pids.values()) | {a.pid for a in agents if a.machine == machine})
    timed = [
        replace(r, cpu_s=cpu_s(r.pid)) if r.cpu_s is None and r.pid in ours and r.pid else r for r in found.values()
    ]
    return sorted(timed, key=lambda row: (row.robot, _rank(row.process), row.process))


def _hosts(keeper: KeeperStatus) -> Iterable[tuple[tuple[str, str], Row]]:
    for board in keeper.boards:
        missing: dict[str, int] = {}
        for lane in board.lanes:
            missing[lane.host] = missing.get(lane.host, 0) + lane.missing
        for host in board.hosts:
            yield (
                (board.robot, host.host),
                Row(
                    process=host.host,
                    robot=board.robot,
                    machine=host.machine,
                    state=host.state,
                    offset_s=host.offset_s,
                    missing=missing.get(host.host, 0),
                    detail=host.detail,
                ),
            )


def _joined(row: Row | None, process: ProcessReport) -> Row:
    """Return what the keeper knows of a process with what its executor knows."""
    row = row or Row(process=process.name, robot=process.robot if process.name != KEEPER else "")
    ended = process.state not in ("starting", "running", "stopping")
    return replace(
        row,
        machine=process.machine,
        state=process.state if ended or row.state in ("", "alive", "dead", "stopped") else row.state,
        pid=process.pid or None,
        restarts=process.restarts,
        cpu_s=process.cpu_s,
        age_s=process.age_s if process.pid else None,
        beat_age_s=process.silent_s,
        detail="; ".join(part for part in (row.detail, process.last_line) if part),
    )


def _rank(name: str) -> int:
    return {KEEPER: 0, MANAGER: 1}.get(name, 2)
