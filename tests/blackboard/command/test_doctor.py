"""`ski doctor` at setups that lack something, one thing at a time."""

import json
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from blackboard.command.main import main
from blackboard.keeper.service import Keeper
from blackboard.link.addresses import KEEPER_STATUS
from blackboard.link.session import LinkParams, open_router, open_session

Doctor = Callable[..., list[dict[str, str]]]
PATIENCE_S = 30.0


@pytest.fixture
def doctor(address: str, capsys: pytest.CaptureFixture[str]) -> Doctor:
    """Return a function that asks the doctor and gives the findings."""

    def ask(*arguments: str, address: str = address) -> list[dict[str, str]]:
        status = main(["doctor", *arguments, "--json", "--for", "0.6", "--connect", address])
        found: list[dict[str, str]] = json.loads(capsys.readouterr().out)
        assert status == (1 if found else 0)
        return found

    return ask


@pytest.fixture
def until(doctor: Doctor) -> Doctor:
    """Return a function that asks the doctor until what he finds is about just these, or time is up."""

    def ask(*abouts: str, mission: str) -> list[dict[str, str]]:
        end_s = time.monotonic() + PATIENCE_S
        while True:
            found = doctor(mission)
            if sorted(one["about"] for one in found) == sorted(abouts) or time.monotonic() > end_s:
                return found

    return ask


@pytest.fixture
def silent_server() -> Iterator[str]:
    """Something that listens, takes connections, and says nothing."""
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        server.settimeout(PATIENCE_S)
        taken: list[socket.socket] = []

        def take() -> None:
            try:
                while True:
                    taken.append(server.accept()[0])
            except OSError:
                return

        thread = Thread(target=take)
        thread.start()
        yield f"tcp/127.0.0.1:{server.getsockname()[1]}"
        server.shutdown(socket.SHUT_RDWR)
        thread.join()
        for one in taken:
            one.close()


def test_nothing_runs(doctor: Doctor, address: str, capsys: pytest.CaptureFixture[str]) -> None:
    (found,) = doctor()
    assert found["about"] == "nothing running"
    assert found["what"] == f"nothing listens at {address} (Connection refused)"
    assert main(["doctor", "--connect", address]) == 1
    what, do = capsys.readouterr().out.splitlines()
    assert (what, do.strip()) == (found["what"], found["do"])


def test_something_else_listens_there(doctor: Doctor, silent_server: str) -> None:
    (found,) = doctor(address=silent_server)
    assert (found["about"], silent_server in found["what"]) == ("wrong port", True)


def test_a_router_without_a_keeper(doctor: Doctor, address: str) -> None:
    with open_router(LinkParams(address=address)):
        (found,) = doctor()
    assert found["about"] == "no keeper"


def test_a_keeper_alone_and_one_that_refused_something(keeper: Keeper, doctor: Doctor, address: str) -> None:
    assert [one["about"] for one in doctor()] == ["no hosts"]
    with open_session(LinkParams(address=address)) as session:
        session.put("ski/k2a/status/robot", b'{"key": "\x1b[2J"}', b"robot boot knowledge 1")
        while b'"form":' not in session.ask(KEEPER_STATUS)[0].payload:
            pass  # it has come once the keeper's answer says so
    alone, refused = sorted(doctor(), key=lambda one: one["about"])
    assert (alone["about"], refused["about"]) == ("no hosts", "rejected writer")
    assert refused["what"].isprintable()


def test_hosts_that_are_missing_there_and_twice(
    host: Callable[[str], Any], until: Doctor, mission_file: Path, capsys: pytest.CaptureFixture[str], address: str
) -> None:
    mission = str(mission_file)
    host("robot")
    found = until("host missing", "host missing", mission=mission)
    assert [one["what"] for one in found] == [
        "nobody runs target_nav, which host behaviours should",
        "nobody runs odometry_pose, which host knowledge_sources should",
    ]
    host("behaviours")
    sources = host("knowledge_sources")
    assert until(mission=mission) == []
    assert main(["doctor", "--connect", address]) == 0
    assert capsys.readouterr().out == (
        f"Nothing is wrong: the keeper at {address} and 3 hosts (behaviours, knowledge_sources, robot).\n"
    )
    host("behaviours")
    (found_twice,) = until("two of one", mission=mission)
    assert found_twice["what"] == "2 processes are linked as host behaviours"
    sources.stop()
    left = until("two of one", "host missing", mission=mission)
    assert "nobody runs odometry_pose, which host knowledge_sources should" in [one["what"] for one in left]


def test_faults_of_the_caller_are_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "no-such-mission"]) == 2
    assert "there is no mission 'no-such-mission'" in capsys.readouterr().err
    assert main(["doctor", "--connect", "nonsense/"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
