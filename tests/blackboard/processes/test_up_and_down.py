"""`ski up`, `ps` and `down` as people use them: real processes, killed one after the other, and nothing left at the end."""

import json
import os
import queue
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from blackboard.journal import read_journal
from blackboard.link.session import LinkParams, Session, open_session
from blackboard.mission import shipped_missions
from blackboard.processes.identity import end_all, is_alive
from blackboard.processes.protocol import AgentReport, ProcessReport, decode
from blackboard.processes.state_folder import Record, StateFolder

LONG_S = 60.0
HOSTS = '\n[hosts.body]\nruns = ["robot", "behaviours"]\n'


class Place:
    """A port and a state folder of its own."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.folder = folder
        self.address = f"tcp/127.0.0.1:{self.port}"
        self.state = StateFolder(self.address, folder / "state")
        self.mission = folder / "wander.toml"
        self.mission.write_text(shipped_missions()["wander-lab"].read_text() + HOSTS)

    def ski(self, verb: str, *arguments: str) -> "subprocess.CompletedProcess[str]":
        command = [sys.executable, "-m", "blackboard.command.main", verb, *arguments, "--connect", self.address]
        environment = {**os.environ, "SKI_STATE": str(self.folder / "state")}
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=LONG_S, check=False)

    def up(self, *arguments: str) -> "subprocess.CompletedProcess[str]":
        return self.ski("up", str(self.mission), "--out", str(self.folder / "out"), *arguments)

    def pid(self, name: str) -> int:
        record = self.state.record(name)
        assert record is not None
        return record.who.pid

    def port_is_free(self) -> bool:
        with socket.socket() as attempt:
            attempt.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                attempt.bind(("127.0.0.1", self.port))
            except OSError:
                return False
            return True


class Reports:
    """What the executor reports."""

    def __init__(self, session: Session) -> None:
        self._come: queue.SimpleQueue[AgentReport] = queue.SimpleQueue()
        session.subscribe("ski/@agents/*/report", lambda arrived: self._come.put(decode(arrived.payload, AgentReport)))

    def until(self, holds: Callable[[dict[str, ProcessReport]], bool]) -> AgentReport:
        while True:
            report = self._come.get(timeout=LONG_S)
            if holds({process.name: process for process in report.processes}):
                return report


@pytest.fixture
def place(tmp_path: Path) -> Iterator[Place]:
    place = Place(tmp_path)
    try:
        yield place
    finally:
        end_all([record.who for record in place.state.records()], 1.0)


def all_run(processes: dict[str, ProcessReport]) -> bool:
    return set(processes) == {"keeper", "body", "knowledge_sources"} and all(
        process.state == "running" for process in processes.values()
    )


def test_a_mission_runs_to_its_end_and_leaves_its_results_only(place: Place) -> None:
    done = place.up("--duration", "6", "--pace", "4", "--json", "--name", "desk")
    assert done.returncode == 0, done.stderr
    table = json.loads(done.stdout)
    assert max(line.stamp_s for line in read_journal(place.folder / "out")) > 5.0
    assert (table["collisions"], table["robot"]) == (0, "k2a")
    assert "body on desk: running" in done.stderr
    assert "k2a moves" in done.stderr
    assert {path.name for path in (place.folder / "out").iterdir()} >= {"board.jsonl", "overview.png", "trajectory.tum"}
    assert not (place.folder / "out" / "board").exists()
    hosts = {line.origin[0] for line in read_journal(place.folder / "out") if line.origin is not None}
    assert hosts >= {"body", "knowledge_sources", "manager"}
    assert place.state.records(alive=False) == []
    assert not (place.state.path / "hosts").exists()
    assert place.port_is_free()


def test_who_is_killed_comes_back_and_down_ends_all_with_the_manager_dead(place: Place) -> None:
    up = place.up("--detach")
    assert up.returncode == 0, up.stderr
    assert "k2a moves" in up.stderr
    seen: list[Record] = []
    with open_session(LinkParams(address=place.address)) as session:
        reports = Reports(session)
        reports.until(all_run)
        for name in ("body", "knowledge_sources", "keeper"):
            seen += place.state.records()
            os.kill(place.pid(name), signal.SIGKILL)
            report = reports.until(lambda held, name=name: all_run(held) and held[name].restarts == 1)  # type: ignore[misc]
        seen += place.state.records()
        os.kill(place.pid("agent"), signal.SIGKILL)
        again = reports.until(all_run)
        while again.boot == report.boot:
            again = reports.until(all_run)
    rows = {row["process"]: row for row in json.loads(place.ski("ps", "--json").stdout)}
    assert set(rows) == {"keeper", f"agent of {again.machine}", "manager", "body", "knowledge_sources"}
    assert rows["body"]["state"] == "running"
    twice = place.up("--force")
    assert f"{place.mission} is up already at {place.address}; end it with `ski down`" in twice.stderr
    seen += place.state.records()
    os.kill(place.pid("manager"), signal.SIGKILL)
    down = place.ski("down")
    assert down.returncode == 0, down.stderr
    assert not any(is_alive(record.who) for record in seen)
    assert place.state.records(alive=False) == []
    assert place.port_is_free()
    nothing = place.ski("down")
    assert (nothing.returncode, nothing.stderr) == (0, f"ski: nothing is up at {place.address} on this machine\n")


def test_what_cannot_be_is_one_line(place: Place) -> None:
    missing = place.ski("up", "explore-lap", "--detach")
    assert missing.returncode == 2
    assert missing.stderr.startswith("ski: there is no mission 'explore-lap'; did you mean 'explore-lab'?")
    slow = place.up("--pace", "0")
    assert (slow.returncode, slow.stderr) == (2, "ski: --pace 0: must be in [0.01, 100]\n")
    wrong = place.up("--set", "body.no=1")
    assert wrong.returncode == 2
    assert wrong.stderr.count("\n") == 1
    assert "the mission has no component 'body'" in wrong.stderr
    assert not (place.folder / "out").exists()
    assert place.port_is_free()
    assert place.state.records(alive=False) == []


def test_what_listens_there_and_is_no_keeper_is_told(place: Place) -> None:
    with socket.create_server(("127.0.0.1", place.port)):
        told = place.up()
    assert told.returncode == 2
    assert told.stderr.count("\n") == 1


def test_a_keeper_that_is_there_already_is_joined_and_stays(place: Place) -> None:
    command = [sys.executable, "-m", "blackboard.command.main", "board", "serve", "--connect", place.address]
    command += ["--out", str(place.folder / "kept"), "--leashed"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as keeper:
        try:
            assert keeper.stdout is not None
            assert b"listening" in keeper.stdout.readline()
            up = place.up("--detach")
            assert up.returncode == 0, up.stderr
            down = place.ski("down")
            assert down.returncode == 0, down.stderr
            assert (place.folder / "out" / "overview.png").is_file()
            assert keeper.poll() is None
            again = place.up("--force")
            assert again.returncode == 2
            assert "still has the board of an earlier 'k2a'; start it with `ski board serve --fresh`" in again.stderr
        finally:
            keeper.kill()
