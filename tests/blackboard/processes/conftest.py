"""A router to meet at, and executors whose hosts are small processes that wait for their end."""

import queue
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest

from blackboard.link.session import Arrived, LinkParams, Session, open_router
from blackboard.messages.hosts import HostBeat
from blackboard.processes.agent import Agent, AgentParams
from blackboard.processes.executor import ProcessPlan
from blackboard.processes.leash import LeashParams
from blackboard.processes.protocol import AgentReport, HostOrder, ManagerBeat, Order, decode, encode
from blackboard.processes.state_folder import StateFolder

LONG_S = 20.0
WAITS = "import sys; sys.stdin.read()"


def waiting_host(order: HostOrder, state: Path) -> ProcessPlan:
    return ProcessPlan(
        name=order.name,
        robot=order.robot,
        command=(sys.executable, "-c", WAITS),
        hang_s=order.hang_s,
        stop_s=order.stop_s,
    )


class Meeting:
    """A router in this process: what agents report there, and heartbeats of a keeper and managers that tests give."""

    def __init__(self, link: LinkParams, session: Session) -> None:
        self.link = link
        self.session = session
        self.reports: queue.SimpleQueue[AgentReport] = queue.SimpleQueue()
        session.subscribe("ski/@agents/*/report", self._note)

    def _note(self, arrived: Arrived) -> None:
        self.reports.put(decode(arrived.payload, AgentReport))

    def beat(self, manager: str = "", host: str = "", pid: int = 0) -> None:
        """Let the keeper's heart beat once, and that of a manager or a host if one is named."""
        self.session.put("ski/k2a/@keeper/beat", b"{}")
        if manager:
            beat = ManagerBeat(manager=manager, mission="m", robot="k2a", machine="here", pid=1)
            self.session.put(f"ski/@manager/{manager}/beat", encode(beat))
        if host:
            alive = HostBeat(boot="b", pid=pid, machine="", version="", components=(), lanes={})
            self.session.put(f"ski/k2a/@hosts/{host}/beat", msgspec.json.encode(alive))

    def order(self, order: Order, machine: str = "desk") -> AgentReport:
        """Order; return the answer, or raise with its error."""
        (answer,) = self.session.ask(f"ski/@agents/{machine}/order", encode(order), timeout_s=LONG_S)
        if answer.error:
            raise AssertionError(answer.error)
        return decode(answer.payload, AgentReport)

    def until(self, holds: Callable[[AgentReport], bool], beating: Callable[[], None] = lambda: None) -> AgentReport:
        """Return the first report that something holds of, hearts beating meanwhile; fail where none comes for very long."""
        for _ in range(round(LONG_S / 0.2)):
            beating()
            try:
                report = self.reports.get(timeout=0.2)
            except queue.Empty:
                continue
            if holds(report):
                return report
        raise AssertionError("what was waited for never came")


@pytest.fixture
def meeting() -> Iterator[Meeting]:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    link = LinkParams(address=f"tcp/127.0.0.1:{port}")
    with open_router(link) as session:
        yield Meeting(link, session)


class RunningAgent:
    """An agent on a thread of its own."""

    def __init__(self, meeting: Meeting, state: StateFolder, machine: str, leash: LeashParams) -> None:
        self.agent = Agent(AgentParams(machine=machine, link=meeting.link, state=state, leash=leash), "1", waiting_host)
        self.state = state
        self._thread = threading.Thread(target=self.agent.run)
        self._thread.start()

    def end(self) -> None:
        self.agent.end()
        self._thread.join(LONG_S)
        assert not self._thread.is_alive()


@pytest.fixture
def start_agent(meeting: Meeting, tmp_path: Path) -> Iterator[Callable[..., RunningAgent]]:
    running: list[RunningAgent] = []

    def start(machine: str = "desk", lease_s: float = 10.0, cut_s: float = 30.0) -> RunningAgent:
        state = StateFolder(meeting.link.address, tmp_path / machine)
        running.append(RunningAgent(meeting, state, machine, LeashParams(lease_s=lease_s, cut_s=cut_s)))
        meeting.until(lambda report: report.machine == machine)
        return running[-1]

    try:
        yield start
    finally:
        for agent in running:
            agent.end()
