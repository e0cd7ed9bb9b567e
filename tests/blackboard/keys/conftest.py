"""A router with keys in a process of its own, which tells what arrived and what it rejected, and answers as a keeper would."""

import datetime
import json
import queue
import shutil
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from blackboard.keys import folder
from blackboard.link.configuration import client_configuration

PATIENCE_S = 20.0  # only what never happens takes so long
CONNECT_MS = 1000
ROUTER = """
import json, queue, sys, threading
from pathlib import Path
import zenoh
from blackboard.keys.rejections import Rejections
from blackboard.keys.roles import READABLE
from blackboard.link.configuration import router_configuration

lock = threading.Lock()

def say(*words):
    with lock:
        print(json.dumps(words), flush=True)

questions = queue.Queue()
configuration = router_configuration(sys.argv[1], Path(sys.argv[2]))
with Rejections(tell=lambda r, often: say("rejected", r.kind, r.member, r.detail)) as rejections:
    with zenoh.open(zenoh.Config.from_json5(json.dumps(configuration))) as session:
        def arrived(sample):
            payload = sample.payload.to_bytes()
            say("arrived", str(sample.key_expr), payload[:20].decode() if len(payload) < 100 else str(len(payload)))
        declared = [session.declare_subscriber(expression, arrived) for expression in READABLE]
        declared.append(session.liveliness().declare_subscriber(
            "ski/*/@hosts/**", lambda sample: say("alive", str(sample.key_expr), str(sample.kind))))
        for expression in ("ski/**", "ski/*/@keeper/**", "ski/*/@late/**"):
            declared.append(session.declare_queryable(expression, questions.put))
        threading.Thread(target=lambda: (sys.stdin.read(), questions.put(None)), daemon=True).start()
        say("ready")
        while (question := questions.get()) is not None:
            say("asked", str(question.key_expr))
            question.reply(str(question.key_expr), b"the keeper's word")
            question.drop()
say("counts", rejections.counts(), rejections.by_member())
"""


class RouterWithKeys:
    """The router's process, and what it told."""

    def __init__(self, keys: Path) -> None:
        self.keys = keys
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"127.0.0.1:{free.getsockname()[1]}"
        self.told: list[list[Any]] = []
        self._numbers = count()
        self._queue: queue.Queue[list[Any]] = queue.Queue()
        self.process = subprocess.Popen(
            [sys.executable, "-c", ROUTER, self.address, str(keys)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()
        try:
            self.wait("ready")
        except BaseException:
            self.kill()
            raise

    def _listen(self) -> None:
        for line in self.process.stdout:
            self._queue.put(json.loads(line))
        self._queue.put(["ended"])

    def wait(self, *words: Any) -> list[Any]:
        """Return the next thing told that begins with `words`; fails where it is never told."""
        while True:
            try:
                told = self._queue.get(timeout=PATIENCE_S)
            except queue.Empty:
                pytest.fail(f"the keeper never said {words}; it said {self.told[-20:]}")
            self.told.append(told)
            if told[: len(words)] == list(words):
                return told
            if told == ["ended"]:
                pytest.fail(f"the keeper ended before it said {words}; it said {self.told[-20:]}")

    def said(self, *words: Any) -> bool:
        """Say whether something was told so far that begins with `words`."""
        return any(told[: len(words)] == list(words) for told in self.told)

    def configuration(self, name: str) -> dict[str, Any]:
        """Return a member's configuration."""
        configuration = client_configuration(self.address, self.keys / "members" / name)
        configuration["connect"]["timeout_ms"] = CONNECT_MS
        return configuration

    def open(self, name: str, configuration: dict[str, Any] | None = None) -> Any:
        """Open a member's session."""
        import zenoh

        text = json.dumps(self.configuration(name) if configuration is None else configuration)
        return zenoh.open(zenoh.Config.from_json5(text))

    def payload(self) -> str:
        """Return a payload that was never sent before."""
        return f"payload {next(self._numbers)}"

    def put(self, name: str, key: str) -> None:
        """Post as a member who may, and wait until it has arrived."""
        with self.open(name) as session:
            payload = self.payload()
            session.put(key, payload)
            self.wait("arrived", key, payload)

    def try_put(self, name: str, key: str, session: Any) -> None:
        """Post as a member who may not: it is rejected, and nothing has arrived until then."""
        payload = self.payload()
        session.put(key, payload)
        self.wait("rejected", "post", name, key)
        assert not self.said("arrived", key, payload)

    def close(self) -> list[Any]:
        """End the router's process as it ends by itself; return its last counts."""
        self.process.stdin.close()
        counts = self.wait("counts")
        assert self.process.wait(PATIENCE_S) == 0
        return counts[1:]

    def kill(self) -> None:
        """End the router's process, whatever it does."""
        self.process.kill()
        self.process.wait()
        self._listener.join()
        self.process.stdout.close()
        self.process.stdin.close()


@pytest.fixture(scope="session")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of keys with members of every role; `gone` was revoked, `before` has the keys that mapper had once."""
    path = tmp_path_factory.mktemp("keys") / "keys"
    now = datetime.datetime.now(datetime.UTC)
    folder.create(path, ["robot.lan"], now)
    folder.add(path, ["viewer"], "eve", now)
    folder.add(path, ["planner"], "planner", now)
    folder.add(path, ["operator"], "olga", now)
    folder.add(path, ["robot"], "k2a", now, robots=["k2a"], hosts=["robot", "behaviours"])
    folder.add(path, ["knowledge"], "mapper", now)
    folder.add(path, ["agent"], "barn", now)
    folder.add(path, ["robot"], "gone", now, robots=["gone"])
    folder.revoke(path, "gone")
    shutil.copytree(path / "members" / "mapper", path / "members" / "before")
    folder.renew(path, "mapper", now)
    return path


@pytest.fixture
def start_router() -> Iterator[Any]:
    """Start routers, each for a folder of keys."""
    started: list[RouterWithKeys] = []

    def start(keys: Path) -> RouterWithKeys:
        started.append(RouterWithKeys(keys))
        return started[-1]

    try:
        yield start
    finally:
        for router in started:
            router.kill()


@pytest.fixture(scope="session")
def router(keys: Path) -> Iterator[RouterWithKeys]:
    """A router for all tests; what it told goes on from test to test."""
    router = RouterWithKeys(keys)
    try:
        yield router
    finally:
        router.kill()
