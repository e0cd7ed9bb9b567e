"""zenoh-cli itself, as a person would call it, with our decoder plugged in."""

import json
import queue
import socket
import subprocess
import threading
import time
from collections.abc import Iterator

import pytest

from blackboard.link.session import LinkParams, Question, Session, open_router

KEY = "ski/k2a/observations/signal/battery"
ENTRY = json.dumps(
    {
        "key": KEY,
        "revision": 3,
        "event": "revised",
        "stamp_s": 2.0,
        "source": "robot",
        "value": {"charge_fraction": 0.5},
    }
).encode()
SAID = f"{KEY} r3 at 2.00 s by robot: charge_fraction 0.5"


@pytest.fixture
def router() -> Iterator[tuple[Session, str]]:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    with open_router(LinkParams(address=address)) as session:
        yield session, address


def command(address: str, *arguments: str) -> list[str]:
    return ["zenoh", "--mode", "client", "--connect", address, *arguments]


def test_get(router: tuple[Session, str], plugged_in: dict[str, str]) -> None:
    session, address = router
    asked: queue.Queue[Question] = queue.Queue()
    session.serve("ski/k2a/**", asked.put)
    arguments = ["get", "-s", "ski/k2a/**", "--decoder", "ski", "--line", "{key} {value}"]
    process = subprocess.Popen(command(address, *arguments), env=plugged_in, stdout=subprocess.PIPE, text=True)
    try:
        question = asked.get(timeout=30)
        question.reply(KEY, ENTRY)
        question.reply("ski/k2a/status/mission", b"\x00\x1b[2J")
        question.finish()
        out, _ = process.communicate(timeout=30)
    finally:
        process.kill()
        process.wait()
    assert sorted(out.splitlines()) == [SAID, "ski/k2a/status/mission 5 bytes that are no JSON"]


def test_subscribe(router: tuple[Session, str], plugged_in: dict[str, str]) -> None:
    session, address = router
    arguments = ["subscribe", "-k", "ski/**", "--decoder", "ski", "--line", "{key} {value}"]
    process = subprocess.Popen(command(address, *arguments), env=plugged_in, stdout=subprocess.PIPE, text=True)
    said: queue.Queue[str] = queue.Queue()
    assert process.stdout is not None
    reader = threading.Thread(target=lambda out: [said.put(line) for line in out], args=(process.stdout,))
    reader.start()
    try:
        until = time.monotonic() + 30
        while time.monotonic() < until:  # nobody says when the subscriber is ready
            session.put(KEY, ENTRY, b"host boot signal 1", lane="signal")
            try:
                assert said.get(timeout=0.1) == SAID + "\n"
                break
            except queue.Empty:
                continue
        else:
            pytest.fail("zenoh-cli printed nothing")
    finally:
        process.kill()
        process.wait()
        reader.join()
        process.stdout.close()
