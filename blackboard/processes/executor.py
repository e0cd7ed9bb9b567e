"""The executor's processes: started, restarted by their policy, killed when they hang, stopped with a grace.

It has no threads and no clock of its own: its owner hands it the ends of children and the heartbeats as they come, and calls
`tick` several times a second. Silence counts only while heartbeats could come (the keeper's do): a keeper that restarts, or an
executor that was halted, makes nobody look hung.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import inf
from pathlib import Path

from blackboard.errors import OutputError
from blackboard.processes.child import Child, Ended, Started
from blackboard.processes.identity import Identity, cpu_s
from blackboard.processes.protocol import ProcessReport, State
from blackboard.processes.restarts import Restart, pause_s

LONGEST_TICK_S = 0.5  # a longer one is this process's own silence and nobody else's
LONGEST_START_S = 60.0  # from its start to the first heartbeat: a cold machine imports for seconds


@dataclass(frozen=True, kw_only=True)
class ProcessPlan:
    """A process to run: its command, and when it is started again. `hang_s` None: nobody expects heartbeats of it. `source`:
    heartbeats of others come by it, so that its own silence always counts, once it has been heard.
    """

    name: str
    command: tuple[str, ...]
    robot: str = ""
    restart: Restart = "on-failure"
    restarts: int = 5
    within_s: float = 60.0
    hang_s: float | None = None
    stop_s: float = 5.0
    source: bool = False


@dataclass
class _Held:
    plan: ProcessPlan
    state: State = "starting"
    child: Started | None = None
    pending: bool = False  # being started: the child will come by `launched`
    started_s: float = 0.0
    ends_s: list[float] = field(default_factory=list)
    restarts: int = 0
    heard: bool = False
    silent_s: float = 0.0
    start_s: float | None = None  # when it is to be started again
    kill_s: float | None = None
    code: int | None = None
    last_line: str = ""
    dropped: bool = False


Launch = Callable[[ProcessPlan, Path, Callable[[Ended], None]], Started | None]  # None: it comes by `launched`


def start_anew(plan: ProcessPlan, log: Path, ended: Callable[[Ended], None]) -> Started:
    """Start a process from nothing."""
    return Child(plan.name, plan.command, log, ended)


class Executor:
    """The processes of one executor. `ended` hears, on other threads, of every end: it must only put it on a queue."""

    def __init__(
        self, machine: str, logs: Path, ended: Callable[[Ended], None], launch: "Launch | None" = None
    ) -> None:
        self.machine = machine
        self._logs = logs
        self._ended = ended
        self._launch = launch or start_anew
        self._held: dict[str, _Held] = {}
        self._ticked_s: float | None = None

    def start(self, plan: ProcessPlan, now_s: float) -> None:
        """Start a process unless it is there already; one that is to be another is stopped first."""
        held = self._held.get(plan.name)
        if held is None:
            self._held[plan.name] = held = _Held(plan)
            self._spawn(held, now_s)
        elif held.plan != plan or held.dropped:
            held.plan, held.dropped = plan, False
            held.ends_s.clear()
            held.start_s = now_s
            self._ask_to_end(held, now_s)

    def stop(self, names: Iterable[str], now_s: float) -> None:
        """Stop processes: they are asked to end, and killed after their grace."""
        for name in names:
            held = self._held.get(name)
            if held is None:
                continue
            held.start_s, held.dropped = None, True
            if held.child is None and not held.pending:
                del self._held[name]
            else:
                self._ask_to_end(held, now_s)

    def launched(self, plan: ProcessPlan, child: Started | None, error: str, now_s: float) -> None:
        """Take a process that was being started; None: it could not be, for some reason."""
        held = self._held.get(plan.name)
        if held is None or not held.pending:
            if child is not None:
                child.kill()
            return
        held.pending, held.child, held.started_s = False, child, now_s
        if child is None:
            held.state, held.last_line = "failed", error
            if held.dropped:
                del self._held[plan.name]
        elif held.dropped or held.plan != plan:
            self._ask_to_end(held, now_s)

    def hear(self, name: str, pid: int | None = None) -> bool:
        """Take note of a heartbeat, of whatever process bears the name where no number came with it; say whether that changed
        its state.
        """
        held = self._held.get(name)
        if held is None or held.child is None or pid not in (None, held.child.pid):
            return False
        held.heard, held.silent_s = True, 0.0
        if held.state != "starting":
            return False
        held.state = "running"
        return True

    def take_end(self, ended: Ended, now_s: float) -> None:
        """Take note of an end, and decide what becomes of the process."""
        held = self._held.get(ended.name)
        if held is None or held.child is None or held.child.pid != ended.pid:
            return
        wanted = held.state == "stopping"
        held.child, held.kill_s = None, None
        held.code, held.last_line = ended.code, ended.last_line
        if held.dropped:
            held.state = "stopped"
            del self._held[ended.name]
        elif wanted:
            held.state = "waiting"
        else:
            plan = held.plan
            held.ends_s = [*(end_s for end_s in held.ends_s if now_s - end_s < plan.within_s), now_s]
            failed = ended.code != 0 or held.state == "hung"
            pause = pause_s(plan.restart, failed, held.ends_s, now_s, plan.restarts, plan.within_s)
            held.state = "waiting" if pause is not None else ("failed" if failed else "done")
            held.start_s = now_s + pause if pause is not None else None
        self._start_due(held, now_s)

    def tick(self, now_s: float, beats_come: bool) -> bool:
        """Start what is due, kill what hangs or will not end; say whether anything changed."""
        passed_s = min(LONGEST_TICK_S, now_s - self._ticked_s) if self._ticked_s is not None else 0.0
        self._ticked_s = now_s
        changed = False
        for held in list(self._held.values()):
            changed |= self._start_due(held, now_s)
            if held.child is None:
                continue
            if held.kill_s is not None and now_s >= held.kill_s:
                held.child.kill()
                held.kill_s = None
            if beats_come or held.plan.source:
                held.silent_s += passed_s
            if held.state in ("starting", "running") and held.silent_s > _patience_s(held):
                held.state = "hung"
                held.child.kill()
                changed = True
        return changed

    def reports(self, now_s: float) -> tuple[ProcessReport, ...]:
        """Return how all of them fare."""
        return tuple(self._report(held, now_s) for held in self._held.values())

    def identities(self) -> dict[str, Identity]:
        """Return who runs, by name."""
        return {name: held.child.identity for name, held in self._held.items() if held.child is not None}

    @property
    def names(self) -> list[str]:
        """The processes that it holds, running or not."""
        return list(self._held)

    def kill_all(self) -> None:
        """End everything at once."""
        for held in self._held.values():
            held.dropped = True
            if held.child is not None:
                held.child.kill()
                held.child.join(5.0)

    def _start_due(self, held: _Held, now_s: float) -> bool:
        if held.start_s is None or held.child is not None or held.pending or now_s < held.start_s:
            return False
        held.restarts += 1
        self._spawn(held, now_s)
        return True

    def _spawn(self, held: _Held, now_s: float) -> None:
        held.started_s, held.start_s, held.kill_s = now_s, None, None
        held.heard, held.silent_s = False, 0.0
        held.state = "starting" if held.plan.hang_s is not None and not held.plan.source else "running"
        try:
            held.child = self._launch(held.plan, self._logs / f"{held.plan.name}.log", self._ended)
            held.pending = held.child is None
        except OutputError as error:
            held.state, held.last_line = "failed", str(error)

    def _ask_to_end(self, held: _Held, now_s: float) -> None:
        if held.child is not None and held.state != "stopping":
            held.state = "stopping"
            held.kill_s = now_s + held.plan.stop_s
            held.child.terminate()

    def _report(self, held: _Held, now_s: float) -> ProcessReport:
        pid = held.child.pid if held.child is not None else 0
        return ProcessReport(
            name=held.plan.name,
            state=held.state,
            machine=self.machine,
            robot=held.plan.robot,
            pid=pid,
            restarts=held.restarts,
            age_s=now_s - held.started_s if pid else 0.0,
            cpu_s=cpu_s(pid) if pid else None,
            silent_s=held.silent_s if held.heard else None,
            code=held.code if held.code is None or held.code >= 0 else None,
            signal=-held.code if held.code is not None and held.code < 0 else None,
            last_line=held.last_line,
        )


def _patience_s(held: _Held) -> float:
    """Return how long it may be silent."""
    if held.plan.hang_s is None or (held.plan.source and not held.heard):
        return inf
    return held.plan.hang_s if held.heard else max(held.plan.hang_s, LONGEST_START_S)
