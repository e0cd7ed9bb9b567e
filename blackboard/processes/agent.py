"""The executor daemon of a machine: runs what its manager orders, watches it, and lets go of it when the manager is gone.

One loop takes everything from one queue: ends of children, heartbeats, orders. Until the keeper answers it tries again; what it
runs meanwhile it runs. The processes that it has started end with it, however it ends: each is on a leash.
"""

import contextlib
import os
import queue
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from blackboard.errors import LinkError
from blackboard.link.session import Arrived, LinkParams, Question, Session, open_session
from blackboard.messages.hosts import HostBeat
from blackboard.processes.child import Ended, Started
from blackboard.processes.commands import host_arguments, host_plan, keeper_plan
from blackboard.processes.executor import Executor, ProcessPlan, start_anew
from blackboard.processes.identity import Identity, end_all, identity_of
from blackboard.processes.launcher import Launched, Launcher
from blackboard.processes.leash import Leash, LeashParams, let_go, passed
from blackboard.processes.protocol import (
    AGENTS,
    KEEPER,
    MANAGER_BEATS,
    AgentReport,
    HostOrder,
    ManagerBeat,
    Order,
    decode,
    encode,
)
from blackboard.processes.state_folder import AGENT, MANAGER, Record, StateFolder

TICK_S = 0.1
REPORT_S = 1.0
Plans = Callable[[HostOrder, Path], ProcessPlan]  # the folder is for what must outlive a kill of the host


@dataclass(frozen=True, kw_only=True)
class AgentParams:
    """Where an executor listens for orders, and what it does without them. `passing`: it came with its manager and goes with it."""

    machine: str
    link: LinkParams
    state: StateFolder
    leash: LeashParams = field(default_factory=LeashParams)
    passing: bool = False
    nursery: socket.socket | None = None  # leads to a nursery that has the first mission loaded


class Agent:
    """An executor with its link. `run` returns when `end` was called, or when a passing one is let go."""

    def __init__(self, params: AgentParams, version: str, plans: Plans | None = None) -> None:
        self._params = params
        self._version = version
        self.boot = f"{os.getpid()}-{time.time_ns():x}"
        self._events: queue.SimpleQueue[object] = queue.SimpleQueue()
        self._executor = Executor(params.machine, params.state.logs, self._events.put, self._launch)
        self._launcher = Launcher(params.state.logs / "nursery.log", self._events.put, params.nursery)
        self._plans = plans or (lambda order, state: host_plan(order, params.link, params.machine, state))
        self._leash = Leash()
        self._session: Session | None = None
        self._ending = False
        self._keeper_goes = False
        self._changed = True
        self._reported_s = -REPORT_S
        self._why = ""
        self._written: dict[str, Identity] = {}
        self._mission = ""

    def end(self) -> None:
        """Ask the loop to stop everything and return; may be called from a signal handler or another thread."""
        self._events.put(None)

    def order(self, order: Order) -> None:
        """Give it an order that need not come over the link; from another thread."""
        self._events.put(order)

    def run(self) -> None:
        """Run until the end. Raises LinkError where another one runs for the same address."""
        left = [r for r in self._params.state.records() if r.name != MANAGER and r.who.pid != os.getpid()]
        if any(record.name == AGENT for record in left):
            raise LinkError(f"an agent runs here already for {self._params.link.address}; end it with `ski down`")
        end_all(
            [record.who for record in left], 0.0
        )  # of an executor that was killed: their leash may not have told them yet
        self._write_down()
        threading.Thread(target=self._connect, name="connect", daemon=True).start()
        try:
            self._loop()
        finally:
            self._executor.kill_all()
            self._launcher.close()
            if self._session is not None:
                self._session.close()
            for name in (*self._written, AGENT):
                self._params.state.drop(name)

    def _loop(self) -> None:
        ticked_s = time.monotonic()
        while not (self._ending and not self._executor.names):
            with contextlib.suppress(queue.Empty):
                self._take(self._events.get(timeout=max(0.0, ticked_s + TICK_S - time.monotonic())))
                while True:
                    self._take(self._events.get_nowait())
            now_s = time.monotonic()
            if now_s - ticked_s >= TICK_S:
                self._leash = passed(self._leash, now_s - ticked_s)
                ticked_s = now_s
                self._changed |= self._executor.tick(now_s, self._leash.open)
                why = let_go(self._leash, self._params.leash)
                if why:
                    self._let_go(why)
            if self._keeper_goes and self._executor.names == [KEEPER]:
                self._executor.stop([KEEPER], now_s)
            if self._changed or now_s - self._reported_s >= REPORT_S:
                self._report(now_s)
        self._report(time.monotonic())

    def _take(self, event: object) -> None:
        match event:
            case None:
                self._ending = True
                self._let_go("it was asked to end")
            case Ended():
                self._executor.take_end(event, time.monotonic())
                self._changed = True
            case Launched():
                self._executor.launched(event.plan, event.child, event.error, time.monotonic())
                self._changed = True
            case Order():
                with contextlib.suppress(LinkError):  # only of one that is ending
                    self._obey(event)
            case Session():
                self._join(event)
            case Question():
                self._answer(event)
            case Arrived():
                self._hear(event)

    def _connect(self) -> None:
        """Open the link, however long that takes; a thread of its own, since opening blocks."""
        while not self._ending:
            try:
                self._events.put(open_session(self._params.link))
            except LinkError:
                time.sleep(0.1)
            else:
                return

    def _join(self, session: Session) -> None:
        self._session = session
        here = f"{AGENTS}/{self._params.machine}"
        session.subscribe(MANAGER_BEATS, self._events.put)
        session.subscribe("ski/*/@keeper/beat", self._events.put)
        session.subscribe("ski/*/@hosts/*/beat", self._events.put)
        session.serve(f"{here}/order", self._events.put)
        session.serve(f"{here}/state", self._events.put)
        session.announce(f"{here}/alive/{self.boot}")
        self._changed = True

    def _hear(self, arrived: Arrived) -> None:
        chunks = arrived.key.split("/")
        if chunks[2] == "@keeper":
            self._executor.hear(KEEPER)
            self._leash = Leash(manager=self._leash.manager, silent_s=self._leash.silent_s)
        elif chunks[2] == "@hosts":
            with contextlib.suppress(msgspec.DecodeError, UnicodeDecodeError, RecursionError):
                beat = msgspec.json.decode(arrived.payload, type=HostBeat)
                self._changed |= self._executor.hear(chunks[3], beat.pid)
        elif self._leash.manager:
            with contextlib.suppress(LinkError):
                if decode(arrived.payload, ManagerBeat).manager == self._leash.manager:
                    self._leash = Leash(manager=self._leash.manager, keeper_silent_s=self._leash.keeper_silent_s)

    def _answer(self, question: Question) -> None:
        """Do what an order says; a question without one only wants to know."""
        try:
            if question.payload and question.key.endswith("/order"):  # anybody may ask for the state
                self._obey(decode(question.payload, Order))
            question.reply(question.key, encode(self._now()))
        except LinkError as error:
            question.fail(str(error))
        finally:
            question.finish()

    def _obey(self, order: Order) -> None:
        if self._ending:
            raise LinkError(f"{self._params.machine} is ending")
        held_by = self._leash.manager
        if held_by not in ("", order.manager) and self._leash.silent_s < 2.0:
            raise LinkError(f"{self._params.machine} is held by another manager; end its mission with `ski down`")
        states = self._params.state.hosts_of(order.manager)
        if not held_by:
            self._launcher.forget()  # what was loaded for another mission, maybe of long ago
        plans = [self._plans(host, states / host.name) for host in order.hosts]
        self._why = ""
        self._keeper_goes = False
        self._leash = Leash(manager=order.manager, keeper_silent_s=self._leash.keeper_silent_s)
        if not plans and order.keeper_folder is None:
            self._let_go("its manager let it go")
            return
        now_s = time.monotonic()
        self._mission = order.hosts[0].mission if order.hosts else order.prepare
        if self._mission:
            self._launcher.prepare(self._mission)
        if order.keeper_folder is not None:
            plan = keeper_plan(self._params.link, Path(order.keeper_folder), order.keeper_mission)
            self._executor.start(plan, now_s)
            plans.append(plan)
        names = {plan.name for plan in plans}
        self._executor.stop([name for name in self._executor.names if name not in names | {KEEPER}], now_s)
        for plan in plans:
            self._executor.start(plan, now_s)
        self._write_down()
        self._changed = True

    def _launch(self, plan: ProcessPlan, log: Path, ended: Callable[[Ended], None]) -> Started | None:
        """Fork a host, which may have to wait until its mission is loaded; start anything else from nothing."""
        arguments = host_arguments(plan.command)
        if arguments is None:
            return start_anew(plan, log, ended)
        self._launcher.start(plan, arguments, log, ended)
        return None

    def _let_go(self, why: str) -> None:
        self._why = why
        self._leash = Leash(keeper_silent_s=self._leash.keeper_silent_s)
        self._executor.stop([name for name in self._executor.names if name != KEEPER], time.monotonic())
        self._keeper_goes = True
        self._ending |= self._params.passing
        self._changed = True

    def _now(self) -> AgentReport:
        return AgentReport(
            machine=self._params.machine,
            boot=self.boot,
            pid=os.getpid(),
            version=self._version,
            manager=self._leash.manager,
            why=self._why,
            processes=self._executor.reports(time.monotonic()),
        )

    def _report(self, now_s: float) -> None:
        if self._changed:
            self._write_down()
        self._changed, self._reported_s = False, now_s
        if self._session is not None:
            self._session.put(f"{AGENTS}/{self._params.machine}/report", encode(self._now()))

    def _write_down(self) -> None:
        """Keep the state folder true."""
        state, running = self._params.state, self._executor.identities()
        me = identity_of(os.getpid())
        if me is not None:
            running[AGENT] = me
        for name, who in running.items():
            if self._written.get(name) != who:
                state.write(Record(name=name, who=who, mission=self._mission, log=str(state.logs / f"{name}.log")))
        for name in self._written:
            if name not in running:
                state.drop(name)
        self._written = running
