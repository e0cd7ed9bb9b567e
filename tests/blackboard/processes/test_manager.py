"""Managers: every executor does its part, whenever it comes; how processes fare stands on the board."""

import os
import queue
import signal
import time
from collections.abc import Callable
from typing import Any

import pytest

from blackboard.board import Board
from blackboard.kinds import PROCESS
from blackboard.link.session import open_session
from blackboard.placement import HostParams, HostPlan
from blackboard.processes.manager import Manager, orders_of
from blackboard.vocabulary import Vocabulary

PLANS = (
    HostPlan(name="robot", robot=True),
    HostPlan(name="map", sources=("eou_grid",), params=HostParams(on="shed", hang_s=7.0)),
)


class Loop:
    """What `ski up` is to its manager: one queue, one loop, a board."""

    def __init__(self, session: Any) -> None:
        self.board = Board(Vocabulary(), robot="k2a")
        self._queue: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        orders = orders_of(
            PLANS, mission="explore-lab", robot="k2a", machine="desk", seed=3, pace=2.0, settings=["a.b=1"]
        )
        self.heard_s: float | None = None  # when the keeper was heard; None: now
        self.manager = Manager(
            session,
            orders,
            [self.board],
            self._queue.put,
            keeper_heard_s=lambda: time.monotonic() if self.heard_s is None else self.heard_s,
        )

    def until(self, holds: Callable[[], Any]) -> None:
        for _ in range(100):
            self.manager.tend(time.monotonic())
            if holds():
                return
            try:
                self._queue.get(timeout=0.2)()
            except queue.Empty:
                continue
        raise AssertionError("what was waited for never came")

    def states(self) -> dict[str, str]:
        return {entry.id or "": entry.value.state for entry in self.board.entries(PROCESS)}


@pytest.fixture
def loop(meeting: Any) -> Any:
    with open_session(meeting.link) as session:
        yield Loop(session)


def test_what_each_machine_is_ordered() -> None:
    orders = orders_of(PLANS, mission="m", robot="k2a", machine="desk", seed=3, pace=2.0, settings=["a.b=1"])
    assert {machine: [host.name for host in hosts] for machine, hosts in orders.hosts.items()} == {
        "desk": ["robot"],
        "shed": ["map"],
    }
    (there,) = orders.hosts["shed"]
    assert (there.hang_s, there.seed, there.pace, there.settings) == (7.0, 3, 2.0, ("a.b=1",))


def test_executors_do_their_part_whenever_they_come(start_agent: Any, loop: Any) -> None:
    assert loop.manager.missing == ["desk", "shed"]
    start_agent("desk")
    loop.until(lambda: loop.states() == {"robot": "starting"})
    assert loop.manager.missing == ["shed"]
    start_agent("shed")
    loop.until(lambda: loop.states() == {"robot": "starting", "map": "starting"})
    assert {p.name: p.machine for p in loop.manager.processes} == {"robot": "desk", "map": "shed"}


def test_an_end_is_told_on_the_board(start_agent: Any, loop: Any) -> None:
    start_agent("desk")
    loop.until(lambda: loop.states())
    os.kill(loop.board.newest(PROCESS, "robot").value.pid, signal.SIGKILL)
    loop.until(lambda: loop.board.newest(PROCESS, "robot").value.restarts == 1)
    status = loop.board.newest(PROCESS, "robot").value
    assert (status.state, status.exit_signal, status.machine) == ("starting", signal.SIGKILL, "desk")


def test_an_executor_that_goes_takes_its_processes_and_one_that_comes_back_gets_them(
    start_agent: Any, loop: Any
) -> None:
    first = start_agent("desk")
    loop.until(lambda: loop.states() == {"robot": "starting"})
    first.end()
    loop.until(lambda: loop.states()["robot"] in ("lost", "stopped") and loop.manager.missing == ["desk", "shed"])
    start_agent("desk")
    loop.until(lambda: loop.states() == {"robot": "starting"})


def test_one_that_had_let_go_is_ordered_again(start_agent: Any, meeting: Any, loop: Any) -> None:
    start_agent("desk", lease_s=1.0)
    loop.until(lambda: loop.states())
    meeting.until(lambda r: not r.processes, meeting.beat)  # the manager says nothing meanwhile
    loop.until(lambda: [p.state for p in loop.manager.processes] == ["starting"])


def test_others_stop_before_the_managers_own(start_agent: Any, loop: Any) -> None:
    start_agent("desk")
    start_agent("shed")
    loop.until(lambda: len(loop.states()) == 2)
    loop.manager.end(elsewhere=True)
    loop.until(lambda: loop.manager.ended(elsewhere=True))
    assert [p.name for p in loop.manager.processes] == ["robot"]
    assert not loop.manager.ended()


def test_a_keeper_that_is_away_makes_nobody_look_lost(start_agent: Any, loop: Any) -> None:
    running = start_agent("desk")
    loop.until(lambda: loop.states() == {"robot": "starting"})
    loop.heard_s = float("-inf")
    running.end()
    loop.until(lambda: loop.manager.missed == ["desk"])
    later_s = time.monotonic() + 100.0
    loop.manager.tend(later_s)
    assert loop.manager.missing == ["shed"]
    for passed_s in (1.0, 1.5, 2.5):  # the keeper is back, and the executor would be soon
        loop.heard_s = later_s + passed_s
        loop.manager.tend(loop.heard_s)
        assert loop.manager.missing == ["shed"]
    loop.heard_s = later_s + 3.1
    loop.manager.tend(loop.heard_s)
    assert loop.manager.missing == ["desk", "shed"]


def test_at_the_end_everybody_stops(start_agent: Any, loop: Any) -> None:
    start_agent("desk")
    start_agent("shed")
    loop.until(lambda: len(loop.states()) == 2)
    loop.manager.end()
    loop.until(lambda: loop.manager.ended())


def test_why_a_machine_does_not_obey_is_known(start_agent: Any, meeting: Any, loop: Any) -> None:
    from blackboard.processes.protocol import HostOrder, Order

    start_agent("desk")
    meeting.order(Order(manager="another", hosts=(HostOrder(name="rules", robot="pioneer", mission="m"),)))
    loop.until(lambda: "held by another manager" in loop.manager.refusals.get("desk", ""))
    assert loop.states() == {}
