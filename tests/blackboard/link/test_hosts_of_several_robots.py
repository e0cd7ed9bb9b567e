"""Hosts of a mission with several robots: one process for their world, the rest of each in processes of its own."""

import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import Any

import msgspec
import pytest

from blackboard.assembly import assemble
from blackboard.board import Board
from blackboard.errors import MissionError
from blackboard.keeper.service import Keeper
from blackboard.kinds import CYCLE, VELOCITY
from blackboard.kinds import MISSION as MISSION_STATUS
from blackboard.link.host import Host, HostOptions
from blackboard.link.session import Arrived, LinkParams, Session, open_session
from blackboard.link.stages import Stages
from blackboard.members import members
from blackboard.messages.motion import MissionStatus
from blackboard.mission import Mission, load_mission
from blackboard.placement import HostPlan
from blackboard.vocabulary import Vocabulary

LONG_S = 20.0  # only where something never happens
MISSION = """
[[robot]]
name = "east"
use = "sim.simulated:SimulatedRobot"
world = "hall.toml"
start_x_m = 0.0
start_y_m = 0.0

[[robot]]
name = "west"
use = "sim.simulated:SimulatedRobot"
world = "hall.toml"
start_x_m = 3.0
start_y_m = 0.0

[[behaviour]]
use = "ahead.py:Ahead"

[coordinator]
use = "behaviours.superposition:Superposition"
"""
HALL = "[floor]\noutline = [[-9, -9], [9, -9], [9, 9], [-9, 9], [-9, -9]]\n"
AHEAD = """
from blackboard.component import Behaviour
from blackboard.messages.motion import Response


class Ahead(Behaviour):
    def respond(self, board):
        return Response(forward=1.0)
"""


@pytest.fixture
def mission(tmp_path: Path) -> Mission:
    for name, text in (("pair.toml", MISSION), ("hall.toml", HALL), ("ahead.py", AHEAD)):
        (tmp_path / name).write_text(text)
    return load_mission(tmp_path / "pair.toml")


@pytest.fixture
def link(tmp_path: Path) -> Iterator[LinkParams]:
    """A keeper at work, and how to reach it."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        link = LinkParams(address=f"tcp/127.0.0.1:{free.getsockname()[1]}")
    keeper = Keeper(link, tmp_path / "boards", Vocabulary())
    try:
        keeper.open()
        at_work = Thread(target=keeper.run)
        at_work.start()
        yield link
        keeper.stop()
        at_work.join()
    finally:
        keeper.close()


@pytest.fixture
def session(link: LinkParams) -> Iterator[Session]:
    with open_session(link) as session:
        yield session


@pytest.fixture
def start(mission: Mission, link: LinkParams, tmp_path: Path) -> Iterator[Callable[[str], Host]]:
    """Start a host of the mission by its name; all are stopped in the end."""
    running: list[tuple[Host, Thread]] = []

    def start(name: str) -> Host:
        host = Host(mission, name, HostOptions(link=link, pace=4.0, state=tmp_path / "state" / name))
        running.append((host, Thread(target=host.run)))
        running[-1][1].start()
        return host

    yield start
    for host, at_work in running:
        host.stop()
        at_work.join()


def listen(session: Session, expression: str) -> "SimpleQueue[tuple[str, Any]]":
    """Return where what comes under a key expression stands from now on: key and value."""
    heard: SimpleQueue[tuple[str, Any]] = SimpleQueue()

    def note(arrived: Arrived) -> None:
        heard.put((arrived.key, msgspec.json.decode(arrived.payload)["value"]))

    session.subscribe(expression, note)
    return heard


def test_two_robots_in_one_process_see_each_other_and_each_obeys_its_own_board(
    session: Session, start: Callable[[str], Host]
) -> None:
    sonar = listen(session, "ski/east/observations/signal/sonar_scan")
    told = listen(session, "ski/*/status/robot_summary")
    start("robot")
    first = sonar.get(timeout=LONG_S)[1]["ranges_m"]
    while not first[0]:  # an echo is missed now and then
        first = sonar.get(timeout=LONG_S)[1]["ranges_m"]
    assert first[0] == pytest.approx(3.0 - 2 * 0.3, abs=0.1)
    start("west.behaviours")
    ahead_m = first[0]
    while ahead_m < 4.0:  # the other drives away; with nobody to command it this one stands
        ahead_m = sonar.get(timeout=LONG_S)[1]["ranges_m"][0] or 0.0
    way_m: dict[str, float] = {}
    while "east" not in way_m or way_m.get("west", 0.0) < 1.0:
        key, value = told.get(timeout=LONG_S)
        way_m[key.split("/")[1]] = msgspec.json.decode(value["figures"])["distance_m"]
    assert way_m["east"] == 0.0


def test_a_robot_without_its_behaviours_stands_and_the_other_goes_on(
    session: Session, start: Callable[[str], Host]
) -> None:
    drives = {name: listen(session, f"ski/{name}/commands/drive") for name in ("east", "west")}
    hosts = {name: start(name) for name in ("robot", "east.behaviours", "west.behaviours")}

    def until(name: str, goes: bool) -> None:
        while (drives[name].get(timeout=LONG_S)[1]["forward_mps"] > 0.0) != goes:
            pass

    until("east", True)
    until("west", True)
    hosts["west.behaviours"].stop()
    until("west", False)
    while not drives["east"].empty():
        drives["east"].get()
    until("east", True)


def test_a_host_that_is_none_is_named(mission: Mission, link: LinkParams) -> None:
    with pytest.raises(MissionError, match=r"there is no host 'behaviours'; there are robot, east\.behaviours"):
        Host(mission, "behaviours", HostOptions(link=link))


@pytest.mark.parametrize(("robots", "goes_on"), [(2, True), (1, False)])
def test_one_of_several_robots_that_is_at_its_end_keeps_out_of_the_others_way(
    mission: Mission, tmp_path: Path, robots: int, goes_on: bool
) -> None:
    if robots == 1:
        (tmp_path / "one.toml").write_text(MISSION.partition("\n\n")[0] + "\n\n" + MISSION[MISSION.index("[[beh") :])
        mission = load_mission(tmp_path / "one.toml")
    assembly = assemble(members(mission)[0])
    board = Board(assembly.vocabulary, robot="east")
    stages = Stages(board, assembly, HostPlan(name="all", robot=True, behaviours=True))
    board.post(MISSION_STATUS, MissionStatus(state="done"), source="rules")
    assert stages.robot is not None
    for _ in range(3):
        stages.robot.cycle()
        stages.work()
    assert (board.newest(CYCLE) is not None) == goes_on
    assert (board.newest(VELOCITY) is not None) == goes_on
