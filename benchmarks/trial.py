"""One run of a mission in its processes, to its own end, with things done to it on the way; and what became of it."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from deployment import JournalTail, Processes
from journal_scores import Outcome, outcome_of
from ledger import Account

from blackboard.link import addresses
from blackboard.link.session import LinkParams, Session, open_session
from blackboard.mission import Mission, find_mission, load_mission, parse_settings

TRIAL = "trial"  # by which name it has keys, where they are asked for
LOOK_S = 0.05
SETTLE_S = 1.0  # after the end: what the last posts set off is posted too
Act = tuple[float, Callable[[], None]]  # mission seconds after the robot's first reading, and what is done then


@dataclass(frozen=True)
class Report:
    """What became of a run in its processes."""

    outcome: Outcome
    account: Account
    seconds: float  # from the first process's start to the mission's end
    statuses: dict[str, int]  # exit statuses, in the end


def mission_of(processes: Processes) -> Mission:
    """Return the mission that the processes run."""
    deployment = processes.deployment
    return load_mission(find_mission(deployment.mission), parse_settings(list(deployment.settings)))


def note_beats(session: Session, processes: Processes) -> None:
    """Let the ledger hear what the hosts say of themselves."""
    ledger = processes.ledger
    session.subscribe(
        addresses.host_beat(processes.deployment.robot, "*"), lambda a: ledger.note_beat(a.key, a.payload)
    )


def run_to_end(processes: Processes, acts: Sequence[Act] = (), *, limit_s: float) -> Report:
    """Start all processes, do what is to be done, wait for the mission's end (for `limit_s` mission seconds at most), end them."""
    deployment = processes.deployment
    started_s = time.monotonic()
    processes.start_all()
    with open_session(LinkParams(address=deployment.address, keys=deployment.keys.get(TRIAL))) as session:
        note_beats(session, processes)
        seconds = _until_over(processes, sorted(acts, key=lambda act: act[0]), limit_s) - started_s
        time.sleep(SETTLE_S)
        statuses = processes.stop_all()
    for host in deployment.hosts:
        processes.note(host)
    account = processes.ledger.account(deployment.journal, [deployment.outbox(host) for host in deployment.hosts])
    return Report(outcome_of(deployment.journal, mission_of(processes), deployment.seed), account, seconds, statuses)


def _until_over(processes: Processes, acts: Sequence[Act], limit_s: float) -> float:
    """Return when the mission was over by the monotonic clock, or when its time was."""
    deployment = processes.deployment
    tail = JournalTail(deployment.journal)
    reading = b"/observations/signal/odometry"
    status = f"ski/{deployment.robot}/status/mission".encode()
    begun_s: float | None = None
    left = list(acts)
    while True:
        over = processes.over
        for line in tail.lines():
            if begun_s is None and reading in line[:100]:
                begun_s = time.monotonic()
            over = over or (status in line[:100] and b'"state":"underway"' not in line)
        now_s = time.monotonic()
        passed_s = (now_s - begun_s) * deployment.pace if begun_s is not None else 0.0
        if over or passed_s > limit_s:
            return now_s
        while left and begun_s is not None and left[0][0] <= passed_s:
            left.pop(0)[1]()
        time.sleep(LOOK_S)
