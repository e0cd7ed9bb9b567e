"""A small mission whose hosts run in threads of the test, at its keeper."""

from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from blackboard.keeper.service import Keeper
from blackboard.link.host import Host, HostOptions
from blackboard.link.session import LinkParams
from blackboard.mission import load_mission

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
def mission_file(tmp_path: Path) -> Path:
    path = tmp_path / "mission.toml"
    path.write_text(MISSION)
    return path


@pytest.fixture
def host(keeper: Keeper, address: str, mission_file: Path) -> Iterator[Callable[[str], Any]]:
    """Return a function that starts one host of the mission in a thread; all are stopped at the end."""
    running: list[tuple[Host, Thread]] = []

    def start(name: str) -> Host:
        options = HostOptions(link=LinkParams(address=address), machine="here")
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
