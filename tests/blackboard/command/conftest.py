"""A keeper at work, and a board with a robot on it."""

import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from blackboard.keeper.service import Keeper
from blackboard.link.host import Host, HostOptions
from blackboard.link.session import LinkParams
from blackboard.mission import load_mission
from blackboard.vocabulary import Vocabulary

MISSION = """
[mission]
duration_s = 1000

[robot]
use = "sim.simulated:SimulatedRobot"

[[knowledge_source]]
use = "knowledge_sources.odometry_pose:OdometryPose"

[[behaviour]]
use = "behaviours.target_nav:TargetNav"

[coordinator]
use = "behaviours.superposition:Superposition"
"""


@pytest.fixture
def free_address() -> str:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{free.getsockname()[1]}"


@pytest.fixture
def keeper(tmp_path: Path, free_address: str) -> Iterator[Keeper]:
    at_work = Keeper(LinkParams(address=free_address), tmp_path / "boards", Vocabulary())
    thread = Thread(target=at_work.run)
    try:
        at_work.open()
        thread.start()
        yield at_work
    finally:
        at_work.stop()
        if thread.is_alive():
            thread.join()
        at_work.close()


@pytest.fixture
def mission_file(tmp_path: Path) -> Path:
    path = tmp_path / "mission.toml"
    path.write_text(MISSION)
    return path


@pytest.fixture
def host(keeper: Keeper, free_address: str, mission_file: Path) -> Iterator[Callable[[str], Any]]:
    """Return a function that starts one host of the mission in a thread; all are stopped at the end."""
    running: list[tuple[Host, Thread]] = []

    def start(name: str) -> Host:
        options = HostOptions(link=LinkParams(address=free_address), machine="here")
        one = Host(load_mission(mission_file), name, options)
        thread = Thread(target=one.run)
        thread.start()
        running.append((one, thread))
        return one

    try:
        yield start
    finally:
        for one, _ in running:
            one.stop()
        for _, thread in running:
            thread.join()
