"""Executors over a real link: what they are ordered they run, what dies they start again, and what nobody holds they let go."""

import os
import signal
import subprocess
import sys
from typing import Any

import pytest

from blackboard.errors import LinkError
from blackboard.processes.agent import Agent, AgentParams
from blackboard.processes.ground import agent_at, agents_at
from blackboard.processes.identity import gone_within, identity_of
from blackboard.processes.protocol import AgentReport, HostOrder, Order, ProcessReport
from blackboard.processes.state_folder import Record, StateFolder

LONG_S = 20.0


def order(*hosts: str, manager: str = "m", hang_s: float = 5.0) -> Order:
    parts = (HostOrder(name=host, robot="k2a", mission="explore-lab", hang_s=hang_s) for host in hosts)
    return Order(manager=manager, hosts=tuple(parts))


def process(report: AgentReport, name: str) -> ProcessReport:
    return next(p for p in report.processes if p.name == name)


def test_what_is_ordered_runs_until_it_is_no_longer(meeting: Any, start_agent: Any) -> None:
    start_agent()
    report = meeting.order(order("map", "rules"))
    assert (report.manager, [p.name for p in report.processes]) == ("m", ["map", "rules"])
    ran = [identity_of(p.pid) for p in report.processes]
    meeting.order(order("map"))
    assert [p.name for p in meeting.until(lambda r: len(r.processes) == 1).processes] == ["map"]
    meeting.order(order())
    free = meeting.until(lambda r: not r.processes)
    assert (free.manager, free.why) == ("", "its manager let it go")
    assert all(who is not None and gone_within(who, LONG_S) for who in ran)


def test_what_is_killed_is_started_again(meeting: Any, start_agent: Any) -> None:
    start_agent()
    first = process(meeting.order(order("map")), "map").pid
    os.kill(first, signal.SIGKILL)
    again = process(meeting.until(lambda r: bool(r.processes) and process(r, "map").restarts == 1), "map")
    assert (again.state, again.signal) == ("starting", signal.SIGKILL)
    assert again.pid != first


def test_what_hangs_is_killed_and_started_again(meeting: Any, start_agent: Any) -> None:
    start_agent()
    pid = process(meeting.order(order("map", hang_s=1.0)), "map").pid
    meeting.until(lambda r: process(r, "map").state == "running", lambda: meeting.beat("m", "map", pid))
    again = process(meeting.until(lambda r: process(r, "map").restarts == 1, lambda: meeting.beat("m")), "map")
    assert (again.state, again.signal) == ("starting", signal.SIGKILL)


def test_nothing_hangs_while_the_keeper_is_silent_too(meeting: Any, start_agent: Any) -> None:
    start_agent()
    pid = process(meeting.order(order("map", hang_s=1.0)), "map").pid
    meeting.until(lambda r: process(r, "map").state == "running", lambda: meeting.beat("m", "map", pid))
    later = meeting.until(lambda r: process(r, "map").age_s > 3.0)
    assert (process(later, "map").pid, process(later, "map").restarts) == (pid, 0)


def test_a_manager_that_is_gone_loses_it_and_another_may_have_it(meeting: Any, start_agent: Any) -> None:
    start_agent(lease_s=1.0)
    who = identity_of(process(meeting.order(order("map")), "map").pid)
    held = meeting.until(lambda r: process(r, "map").age_s > 2.0, lambda: meeting.beat("m"))
    assert held.manager == "m"
    gone = meeting.until(lambda r: not r.processes, lambda: meeting.beat("somebody else"))
    assert (gone.manager, gone.why) == ("", "the manager was silent for 1 s")
    assert who is not None
    assert gone_within(who, LONG_S)
    assert meeting.order(order("map", manager="next")).manager == "next"


def test_a_keeper_that_is_gone_for_long_loses_it_too(meeting: Any, start_agent: Any) -> None:
    start_agent(cut_s=1.0)
    meeting.order(order("map"))
    gone = meeting.until(lambda r: not r.processes)
    assert gone.why.startswith("the keeper was silent for")


def test_two_managers_do_not_pull_at_it(meeting: Any, start_agent: Any) -> None:
    start_agent()
    meeting.order(order("map"))
    with pytest.raises(AssertionError, match="desk is held by another manager; end its mission with `ski down`"):
        meeting.order(order("rules", manager="other"))
    assert [p.name for p in meeting.until(lambda r: True).processes] == ["map"]


@pytest.mark.parametrize("payload", [b"{", b'{"manager": ""}', b'{"manager": "m", "command": "rm"}', b"x" * 1_000_001])
def test_what_is_no_order_is_answered_and_nothing_happens(meeting: Any, start_agent: Any, payload: bytes) -> None:
    start_agent()
    (answer,) = meeting.session.ask("ski/@agents/desk/order", payload, timeout_s=LONG_S)
    assert "Order" in answer.error or "limit" in answer.error
    assert meeting.until(lambda r: True).processes == ()


def test_it_ends_what_it_runs_when_it_ends_and_leaves_no_trace(meeting: Any, start_agent: Any) -> None:
    running = start_agent()
    who = identity_of(process(meeting.order(order("map")), "map").pid)
    assert sorted(record.name for record in running.state.records()) == ["agent", "map"]
    running.end()
    assert who is not None
    assert gone_within(who, LONG_S)
    assert running.state.records(alive=False) == []


def test_what_an_executor_that_was_killed_left_is_ended(meeting: Any, start_agent: Any, tmp_path: Any) -> None:
    child = subprocess.Popen([sys.executable, "-c", "import sys; sys.stdin.read()"], stdin=subprocess.PIPE)
    try:
        who = identity_of(child.pid)
        assert who is not None
        StateFolder(meeting.link.address, tmp_path / "desk").write(Record(name="map", who=who))
        start_agent()
        child.communicate(timeout=LONG_S)
        assert child.returncode == -signal.SIGTERM
    finally:
        child.kill()


def test_there_is_one_executor_for_an_address(meeting: Any, start_agent: Any) -> None:
    running = start_agent()
    second = Agent(AgentParams(machine="desk", link=meeting.link, state=running.state), "1")
    running.state.write(record_of_somebody_else(running))
    with pytest.raises(LinkError, match="an agent runs here already"):
        second.run()


def record_of_somebody_else(running: Any) -> Any:
    """Return the record of an agent that is another process than this one: the one that started the tests."""
    who = identity_of(os.getppid())
    assert who is not None
    return Record(name="agent", who=who)


def test_all_executors_are_found_by_name(meeting: Any, start_agent: Any) -> None:
    assert agents_at(meeting.session) == []
    start_agent("shed")
    start_agent("desk")
    meeting.order(order("map"), "shed")
    found = agents_at(meeting.session)
    assert [(report.machine, report.manager) for report in found] == [("desk", ""), ("shed", "m")]
    assert agent_at(meeting.session, "attic") == []
