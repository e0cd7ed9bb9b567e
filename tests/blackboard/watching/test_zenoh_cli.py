"""zenoh-cli itself, as a person would call it, with our decoder plugged in."""

import json
import os
import queue
import shutil
import socket
import subprocess
import sys
import threading
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path

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
ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def router() -> Iterator[tuple[Session, str]]:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    with open_router(LinkParams(address=address)) as session:
        yield session, address


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    """Return an environment in which pyproject's entry points count, however old the installed package's are."""
    points = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]
    folder = tmp_path / "ski_points-0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: ski-points\nVersion: 0\n")
    lines = [f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in named.items()) for group, named in points.items()]
    (folder / "entry_points.txt").write_text("\n".join(lines))
    return {**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}", "MPLCONFIGDIR": str(tmp_path)}


def command(address: str, *arguments: str) -> list[str]:
    found = shutil.which("zenoh", path=str(Path(sys.executable).parent))
    if found is None:
        pytest.fail("zenoh-cli is not installed; install the package with its extra 'test'")
    return [found, "--mode", "client", "--connect", address, *arguments]


def test_get(router: tuple[Session, str], environment: dict[str, str]) -> None:
    session, address = router
    asked: queue.Queue[Question] = queue.Queue()
    session.serve("ski/k2a/**", asked.put)
    arguments = ["get", "-s", "ski/k2a/**", "--decoder", "ski", "--line", "{key} {value}"]
    process = subprocess.Popen(command(address, *arguments), env=environment, stdout=subprocess.PIPE, text=True)
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


def test_subscribe(router: tuple[Session, str], environment: dict[str, str]) -> None:
    session, address = router
    arguments = ["subscribe", "-k", "ski/**", "--decoder", "ski", "--line", "{key} {value}"]
    process = subprocess.Popen(command(address, *arguments), env=environment, stdout=subprocess.PIPE, text=True)
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
