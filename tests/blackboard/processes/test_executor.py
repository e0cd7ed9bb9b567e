"""An executor's processes: real ones, on a clock that the tests hold."""

import os
import queue
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from blackboard.processes.child import Ended
from blackboard.processes.executor import Executor, ProcessPlan, start_anew
from blackboard.processes.identity import gone_within, identity_of
from blackboard.processes.protocol import ProcessReport
from blackboard.processes.restarts import Restart

LEASHED = "import sys; sys.stdin.read()"
DEAF = """
import signal, sys
signal.signal(signal.SIGTERM, signal.SIG_IGN)
open({pipe!r}, "w").write("deaf")
sys.stdin.read()
"""
HOLDER = """
import signal, subprocess, sys
child = subprocess.Popen([sys.executable, "-c", "import sys; sys.stdin.read()"], stdin=subprocess.PIPE)
open({pipe!r}, "w").write(str(child.pid))
signal.pause()
"""
FAILS = "import sys; print('to standard error', file=sys.stderr); print('no such thing', file=sys.stderr); sys.exit(3)"


class Owner:
    """Hands an executor the ends of its children, as an agent does."""

    def __init__(self, logs: Path) -> None:
        self.logs = logs
        self.ends: queue.SimpleQueue[Ended] = queue.SimpleQueue()
        self.executor = Executor("desk", logs, self.ends.put)
        self.now_s = 100.0

    def start(
        self, script: str, *, restart: Restart = "on-failure", restarts: int = 5, hang_s: float | None = 2.0
    ) -> None:
        plan = ProcessPlan(
            name="map", command=(sys.executable, "-c", script), restart=restart, restarts=restarts, hang_s=hang_s
        )
        self.executor.start(plan, self.now_s)

    def take_end(self) -> Ended:
        ended = self.ends.get(timeout=20)
        self.executor.take_end(ended, self.now_s)
        return ended

    def pass_s(self, seconds: float, *, beats_come: bool = True) -> None:
        for _ in range(round(seconds / 0.1)):
            self.now_s += 0.1
            self.executor.tick(self.now_s, beats_come)

    @property
    def report(self) -> ProcessReport:
        (report,) = self.executor.reports(self.now_s)
        return report


@pytest.fixture
def owner(tmp_path: Path) -> Iterator[Owner]:
    owner = Owner(tmp_path)
    try:
        yield owner
    finally:
        owner.executor.kill_all()


@pytest.fixture
def pipe(tmp_path: Path) -> Path:
    """What a child says that it is ready by: reading it waits until the child has written."""
    os.mkfifo(tmp_path / "pipe")
    return tmp_path / "pipe"


def test_one_that_is_heard_runs(owner: Owner) -> None:
    owner.start(LEASHED)
    assert owner.report.state == "starting"
    assert owner.executor.hear("map", owner.report.pid)
    assert not owner.executor.hear("map", owner.report.pid)
    owner.pass_s(3.0, beats_come=False)
    assert (owner.report.state, owner.report.restarts, owner.report.silent_s) == ("running", 0, 0.0)
    assert owner.report.age_s == pytest.approx(3.0)


def test_a_killed_one_is_started_again_at_once(owner: Owner) -> None:
    owner.start(LEASHED)
    first = owner.report.pid
    os.kill(first, signal.SIGKILL)
    assert owner.take_end().code == -signal.SIGKILL
    assert (owner.report.state, owner.report.restarts, owner.report.signal) == ("starting", 1, signal.SIGKILL)
    assert owner.report.pid not in (0, first)


def test_one_that_cannot_run_is_given_up_and_its_last_word_kept(owner: Owner) -> None:
    owner.start(FAILS, restarts=2)
    for _ in range(2):
        owner.take_end()
        owner.pass_s(1.0)
    owner.take_end()
    report = owner.report
    assert (report.state, report.restarts, report.code, report.last_line) == ("failed", 2, 3, "no such thing")
    owner.pass_s(100.0)
    assert owner.report.state == "failed"


def test_one_that_ends_well_has_done_its_work(owner: Owner) -> None:
    owner.start("pass")
    owner.take_end()
    assert (owner.report.state, owner.report.code, owner.report.pid) == ("done", 0, 0)


def test_a_hung_one_is_killed_and_started_again(owner: Owner) -> None:
    owner.start(LEASHED)
    owner.executor.hear("map", owner.report.pid)
    owner.pass_s(1.9)
    assert owner.report.state == "running"
    owner.pass_s(0.3)
    assert owner.report.state == "hung"
    assert owner.take_end().code == -signal.SIGKILL
    assert (owner.report.state, owner.report.restarts) == ("starting", 1)


def test_nobody_hangs_while_no_heartbeat_could_come(owner: Owner) -> None:
    owner.start(LEASHED)
    owner.executor.hear("map", owner.report.pid)
    owner.pass_s(30.0, beats_come=False)
    owner.now_s += 60.0  # this process itself was halted
    owner.executor.tick(owner.now_s, beats_come=True)
    assert owner.report.state == "running"


def test_a_keeper_that_hangs_is_killed_though_no_heartbeat_comes(owner: Owner) -> None:
    plan = ProcessPlan(name="keeper", command=(sys.executable, "-c", LEASHED), hang_s=20.0, source=True)
    owner.executor.start(plan, owner.now_s)
    assert owner.report.state == "running"
    owner.pass_s(100.0, beats_come=False)  # nobody has joined yet, so it has said nothing
    assert owner.report.state == "running"
    owner.executor.hear("keeper")
    owner.pass_s(19.0, beats_come=False)
    assert owner.report.state == "running"
    owner.pass_s(2.0, beats_come=False)
    assert owner.report.state == "hung"


def test_a_heartbeat_of_an_earlier_life_does_not_count(owner: Owner) -> None:
    owner.start(LEASHED)
    assert not owner.executor.hear("map", owner.report.pid + 1)
    assert not owner.executor.hear("rules", owner.report.pid)
    assert owner.report.state == "starting"


def test_stopped_it_is_forgotten(owner: Owner) -> None:
    owner.start(LEASHED)
    owner.executor.stop(["map"], owner.now_s)
    assert owner.report.state == "stopping"
    owner.take_end()
    assert owner.executor.names == []


def test_who_does_not_hear_that_it_is_to_end_is_killed_after_its_grace(owner: Owner, pipe: Path) -> None:
    owner.start(DEAF.format(pipe=str(pipe)))
    assert pipe.read_text() == "deaf"
    owner.executor.stop(["map"], owner.now_s)
    owner.pass_s(4.8)
    assert owner.report.state == "stopping"
    owner.pass_s(0.4)
    assert owner.take_end().code == -signal.SIGKILL
    assert owner.executor.names == []


def test_the_same_plan_twice_does_nothing_and_another_takes_its_place(owner: Owner) -> None:
    owner.start(LEASHED)
    first = owner.report.pid
    owner.start(LEASHED)
    assert (owner.report.state, owner.report.pid) == ("starting", first)
    owner.start(LEASHED, hang_s=None)
    assert owner.report.state == "stopping"
    owner.take_end()
    assert owner.report.state == "running"
    assert owner.report.pid != first


def test_started_again_while_it_stops(owner: Owner) -> None:
    owner.start(LEASHED)
    owner.executor.stop(["map"], owner.now_s)
    owner.start(LEASHED)
    owner.take_end()
    assert (owner.report.state, owner.report.restarts) == ("starting", 1)


def test_a_command_that_is_none_is_a_failure(owner: Owner) -> None:
    owner.executor.start(ProcessPlan(name="map", command=("/no/such/program",)), owner.now_s)
    assert owner.report.state == "failed"
    assert owner.report.last_line == "map cannot be started: No such file or directory: /no/such/program"


def test_the_leash_parts_with_its_holder(owner: Owner, pipe: Path) -> None:
    """A child must not outlive an executor that is killed: its standard input ends."""
    owner.start(HOLDER.format(pipe=str(pipe)))
    grandchild = identity_of(int(pipe.read_text()))
    assert grandchild is not None
    os.kill(owner.report.pid, signal.SIGKILL)
    assert gone_within(grandchild, 20.0)


class Late:
    """An owner whose processes are started elsewhere and come later."""

    def __init__(self, logs: Path) -> None:
        self.ends: queue.SimpleQueue[Ended] = queue.SimpleQueue()
        self.asked: list[tuple[ProcessPlan, Path, Callable[[Ended], None]]] = []
        self.executor = Executor("desk", logs, self.ends.put, lambda *asked: self.asked.append(asked))  # type: ignore[func-returns-value]

    def come(self) -> int:
        plan, log, ended = self.asked.pop(0)
        child = start_anew(plan, log, ended)
        self.executor.launched(plan, child, "", 100.0)
        return child.pid

    def states(self) -> dict[str, str]:
        return {report.name: report.state for report in self.executor.reports(100.0)}


@pytest.fixture
def late(tmp_path: Path) -> Iterator[Late]:
    late = Late(tmp_path)
    try:
        yield late
    finally:
        late.executor.kill_all()


PLAN = ProcessPlan(name="map", command=(sys.executable, "-c", LEASHED), hang_s=2.0)


def test_one_that_is_being_started_is_waited_for(late: Late) -> None:
    late.executor.start(PLAN, 100.0)
    late.executor.tick(101.0, beats_come=True)
    assert late.states() == {"map": "starting"}
    assert len(late.asked) == 1
    pid = late.come()
    assert late.executor.hear("map", pid)
    assert late.states() == {"map": "running"}


def test_stopped_before_it_has_come_it_is_ended_when_it_comes(late: Late) -> None:
    late.executor.start(PLAN, 100.0)
    late.executor.stop(["map"], 100.0)
    assert late.executor.names == ["map"]
    late.come()
    assert late.states() == {"map": "stopping"}
    late.executor.take_end(late.ends.get(timeout=20), 100.0)
    assert late.executor.names == []


def test_another_plan_before_it_has_come_takes_its_place(late: Late) -> None:
    late.executor.start(PLAN, 100.0)
    other = ProcessPlan(name="map", command=PLAN.command)
    late.executor.start(other, 100.0)
    late.come()
    late.executor.take_end(late.ends.get(timeout=20), 100.0)
    assert [plan for plan, _, _ in late.asked] == [other]


def test_one_that_could_not_be_started_has_failed(late: Late) -> None:
    late.executor.start(PLAN, 100.0)
    late.executor.launched(PLAN, None, "no more processes", 100.0)
    (report,) = late.executor.reports(100.0)
    assert (report.state, report.last_line, report.pid) == ("failed", "no more processes", 0)
