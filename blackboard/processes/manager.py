"""The process manager: what of a mission runs on which machine, ordered from the executors there and told on the board.

It orders whatever an executor says that it does not hold: one that comes late, one that had let go, one that was started anew.
What executors report stands as `status/process/<host>`, so that rules see it.
"""

import contextlib
import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from blackboard.board import Board
from blackboard.errors import LinkError
from blackboard.kinds import PROCESS
from blackboard.link.session import Answer, Arrived, Session
from blackboard.messages.processes import ProcessStatus
from blackboard.placement import HostPlan
from blackboard.processes.protocol import (
    AGENTS,
    KEEPER,
    AgentReport,
    HostOrder,
    ManagerBeat,
    Order,
    ProcessReport,
    decode,
    encode,
)

BEAT_S = 0.5
ORDER_AGAIN_S = 2.0
HEARD_S = 1.0  # the keeper's heartbeats come 5 times a second
GONE_S = 2.0  # for an executor to find the keeper again: attempts are at most half a second apart
SOURCE = "manager"
SILENCE = "Timeout"  # zenoh's word for no answer
Later = Callable[[Callable[[], None]], None]  # does something on the loop of who owns the board


@dataclass(frozen=True, kw_only=True)
class MissionOrders:
    """A mission as its manager orders it: the parts of each machine, by the machine's name."""

    mission: str
    robot: str
    machine: str  # the manager's own
    hosts: Mapping[str, tuple[HostOrder, ...]]
    keeper_folder: str | None = None  # where the manager's own executor runs the keeper too
    keeper_mission: str = ""

    def of(self, machine: str, manager: str) -> Order:
        """Return the order for one machine."""
        own = machine == self.machine
        return Order(
            manager=manager,
            hosts=self.hosts[machine],
            keeper_folder=self.keeper_folder if own else None,
            keeper_mission=self.keeper_mission if own else "",
        )


def orders_of(
    plans: Sequence[HostPlan],
    *,
    mission: str,
    robot: str,
    machine: str,
    seed: int,
    pace: float,
    settings: Sequence[str],
    keeper_folder: str | None = None,
    keeper_mission: str = "",
) -> MissionOrders:
    """Return what each machine is to run; hosts that name no machine run on the manager's."""
    hosts: dict[str, tuple[HostOrder, ...]] = {machine: ()}
    for plan in plans:
        on = plan.params.on or machine
        order = HostOrder(
            name=plan.name,
            robot=plan.of or robot,
            mission=mission,
            seed=seed,
            pace=pace,
            settings=tuple(settings),
            restart=plan.params.restart,
            restarts=plan.params.restarts,
            within_s=plan.params.within_s,
            hang_s=plan.params.hang_s,
            stop_s=plan.params.stop_s,
        )
        hosts[on] = (*hosts.get(on, ()), order)
    return MissionOrders(
        mission=mission,
        robot=robot,
        machine=machine,
        hosts=hosts,
        keeper_folder=keeper_folder,
        keeper_mission=keeper_mission,
    )


class Manager:
    """Runs on somebody's loop: call `tend` several times a second. Sinks hand what comes to that loop by `later`."""

    def __init__(
        self,
        session: Session,
        orders: MissionOrders,
        boards: Sequence[Board],
        later: Later,
        *,
        name: str = "",
        keeper_heard_s: Callable[[], float] = time.monotonic,
    ) -> None:
        """Begin to manage; `keeper_heard_s` tells when the keeper was last heard, by the monotonic clock."""
        self.name = name or f"{os.getpid()}-{time.time_ns():x}"
        self._session = session
        self._orders = orders
        self._boards = boards  # of every robot of the mission: each is told of all processes
        self._later = later
        self.agents: dict[str, AgentReport] = {}
        self.refusals: dict[str, str] = {}  # why a machine does not do as ordered
        self._wanted = {host.name for hosts in orders.hosts.values() for host in hosts}
        self._asked_s: dict[str, float] = {}
        self._keeper_heard_s = keeper_heard_s
        self._open_since_s = float("inf")  # the keeper has been heard without a break
        self._missed: dict[str, tuple[str, float]] = {}  # machine: the executor's boot whose token ended, and when
        self._beat_s = float("-inf")
        self._ending = False
        session.subscribe(f"{AGENTS}/*/report", lambda arrived: later(lambda: self._take(arrived)))
        session.watch(f"{AGENTS}/*/alive/*", lambda key, alive: later(lambda: self._see(key, alive)))

    def tend(self, now_s: float) -> None:
        """Tell the executors that their manager is there, and see who of them is not; by the monotonic clock."""
        if now_s - self._beat_s >= BEAT_S:
            self._beat_s = now_s
            beat = ManagerBeat(
                manager=self.name,
                mission=self._orders.mission,
                robot=self._orders.robot,
                machine=self._orders.machine,
                pid=os.getpid(),
            )
            self._session.put(f"ski/@manager/{self.name}/beat", encode(beat), lane="command")
        self._look_for_missed(now_s)

    @property
    def processes(self) -> list[ProcessReport]:
        """How the mission's processes fare, the keeper's too where an executor runs it."""
        found = [
            p
            for report in self.agents.values()
            if report.manager == self.name or self._ending
            for p in report.processes
        ]
        return [p for p in found if p.name in self._wanted or p.name == KEEPER]

    @property
    def missing(self) -> list[str]:
        """The machines that are to run something and were not heard of yet."""
        return [machine for machine, hosts in self._orders.hosts.items() if hosts and machine not in self.agents]

    @property
    def missed(self) -> list[str]:
        """The machines whose executors have not been there lately: they, or the keeper between, are gone."""
        return list(self._missed)

    def end(self, *, elsewhere: bool = False) -> None:
        """Have executors stop what they run for this mission: all, or all on other machines than the manager's own."""
        self._ending = True
        for machine in self.agents:
            if not (elsewhere and machine == self._orders.machine):
                self._order(machine, Order(manager=self.name))

    def ended(self, *, elsewhere: bool = False) -> bool:
        """Say whether no executor runs anything for this mission any more: none at all, or none on other machines."""
        own = self._orders.machine
        return self._ending and not any(p for p in self.processes if not (elsewhere and p.machine == own))

    def _take(self, arrived: Arrived) -> None:
        with contextlib.suppress(LinkError):
            self._note(decode(arrived.payload, AgentReport))

    def _note(self, report: AgentReport) -> None:
        if report.machine not in self._orders.hosts:
            return
        self.agents[report.machine] = report
        if report.manager == self.name:
            self.refusals.pop(report.machine, None)
        if not self._ending and self._differs(report):
            self._order(report.machine, self._orders.of(report.machine, self.name))
        told = {process.name: _status(process) for process in report.processes}
        for host in self._orders.hosts[report.machine]:
            if host.name in told:
                self._tell(host.name, told[host.name])
            elif self._boards[0].newest(PROCESS, host.name) is not None:
                self._tell(host.name, ProcessStatus(state="stopped", machine=report.machine, last_line=report.why))

    def _differs(self, report: AgentReport) -> bool:
        wanted = {host.name for host in self._orders.hosts[report.machine]}
        return report.manager != self.name or not wanted <= {process.name for process in report.processes}

    def _see(self, key: str, alive: bool) -> None:
        """Take note of an executor that comes or goes."""
        machine, boot = key.split("/")[2], key.split("/")[4]
        if machine not in self._orders.hosts:
            return
        if alive:
            self._asked_s.pop(machine, None)
            self._missed.pop(machine, None)
        else:
            self._missed[machine] = (boot, time.monotonic())

    def _look_for_missed(self, now_s: float) -> None:
        """Take executors for gone whose tokens stay away: they end with the keeper too, and come back with it."""
        if now_s - self._keeper_heard_s() > HEARD_S:
            self._open_since_s = float("inf")
            return
        self._open_since_s = min(self._open_since_s, now_s)
        for machine, (boot, missed_s) in list(self._missed.items()):
            if now_s - max(missed_s, self._open_since_s) < GONE_S:
                continue
            del self._missed[machine]
            last = self.agents.get(machine)
            if last is not None and last.boot == boot:
                del self.agents[machine]
                for process in last.processes:
                    if process.name in self._wanted:
                        lost = ProcessStatus(state="lost", machine=machine, last_line="its executor is gone")
                        self._tell(process.name, lost)

    def _order(self, machine: str, order: Order) -> None:
        now_s = time.monotonic()
        if now_s - self._asked_s.get(machine, float("-inf")) < ORDER_AGAIN_S and not self._ending:
            return
        self._asked_s[machine] = now_s

        def answered(answers: Sequence[Answer]) -> None:
            for answer in answers:
                if answer.error == SILENCE:
                    continue  # it is being killed, or very busy: it is asked again when it is heard
                if answer.error:
                    self.refusals[machine] = answer.error
                else:
                    with contextlib.suppress(LinkError):
                        self._note(decode(answer.payload, AgentReport))

        key = f"{AGENTS}/{machine}/order"
        self._session.ask_later(
            key, encode(order), lambda answers: self._later(lambda: answered(answers)), ORDER_AGAIN_S
        )

    def _tell(self, name: str, status: ProcessStatus) -> None:
        for board in self._boards:
            standing = board.newest(PROCESS, name)
            if standing is None or standing.value != status:
                board.post(PROCESS, status, id=name, source=SOURCE)


def _status(process: ProcessReport) -> ProcessStatus:
    return ProcessStatus(
        state=process.state,
        machine=process.machine,
        pid=process.pid,
        restarts=process.restarts,
        exit_code=process.code,
        exit_signal=process.signal,
        last_line=process.last_line,
    )
