"""The commands that `docs/watching.md` prints work as they stand there, but for the port."""

import json
import re
import shlex
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from blackboard.command.main import main
from blackboard.link.address import DEFAULT_ADDRESS

TEXT = (Path(__file__).resolve().parents[3] / "docs" / "watching.md").read_text()
PRINTED = [line for block in re.findall(r"```sh\n(.*?)```", TEXT, flags=re.DOTALL) for line in block.splitlines()]
ZENOH = [line for line in PRINTED if line.startswith("zenoh ")]
POSTS = [line for line in PRINTED if line.startswith("ski post motivations/")]
PATIENCE_S = 30.0


def first_line(command: str, environment: dict[str, str]) -> str:
    """Return the first line that a command prints; fail where none comes."""
    process = subprocess.Popen(shlex.split(command), env=environment, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    lines: list[str] = []
    reader = Thread(target=lambda out: lines.append(out.readline()), args=(process.stdout,))
    reader.start()
    reader.join(PATIENCE_S)
    process.kill()
    process.wait()
    reader.join()
    process.stdout.close()
    return lines[0]


def test_there_are_commands_to_try() -> None:
    assert len(ZENOH) == 5
    assert len(POSTS) == 2
    assert {re.search(r"(subscribe|get -s|liveliness get)", line)[1] for line in ZENOH} == {  # type: ignore[index]
        "subscribe", "get -s", "liveliness get",
    }  # fmt: skip
    assert all(line.startswith(f"zenoh --mode client --connect {DEFAULT_ADDRESS} ") for line in ZENOH)


def test_zenohs_own_tools(
    host: Callable[[str], Any],
    address: str,
    plugged_in: dict[str, str],
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name in ("robot", "behaviours", "knowledge_sources"):
        host(name)
    end_s = time.monotonic() + PATIENCE_S
    while main(["get", "hypotheses/feature/map_from_odom", "--connect", address]) and time.monotonic() < end_s:
        pass  # the hosts are joining
    capsys.readouterr()
    for command in ZENOH:
        said = first_line(command.replace(DEFAULT_ADDRESS, address), plugged_in)
        assert "ski/" in said, command
        assert len(said) < 400 or "json" in command, command
    assert main(["graph", "--connect", address, "--json"]) == 0
    graph = json.loads(capsys.readouterr().out)
    assert graph["members"]["odometry_pose"]["host"] == "knowledge_sources"
    assert graph["kinds"]["observations/feature/odom_from_robot"]["posted_by"] == ["odometry_pose"]


def test_posting(
    host: Callable[[str], Any], address: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SKI_CONNECT", address)
    host("robot")
    host("behaviours")
    end_s = time.monotonic() + PATIENCE_S
    while main(["get", "status/behaviour/target_nav"]) and time.monotonic() < end_s:
        pass  # the hosts are joining
    for command in POSTS:
        assert main(shlex.split(command)[1:]) == 0, command
    capsys.readouterr()
    end_s = time.monotonic() + PATIENCE_S
    said = ""
    while "acknowledged 1" not in said and time.monotonic() < end_s:
        main(["get", "status/behaviour/target_nav"])
        said = capsys.readouterr().out
    assert "acknowledged 1" in said  # it took the motivation up
