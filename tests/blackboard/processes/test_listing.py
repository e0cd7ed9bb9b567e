"""Rows of `ski ps`: what keeper, executors and state folder know of a process, in one."""

import os

from blackboard.keeper.status import BoardStatus, HostLine, KeeperStatus, LaneStatus
from blackboard.processes.identity import Identity
from blackboard.processes.listing import rows_of
from blackboard.processes.protocol import AgentReport, ProcessReport
from blackboard.processes.state_folder import Record

BOARD = BoardStatus(
    robot="k2a",
    now_s=12.0,
    standing=5,
    taken=9,
    duplicates=0,
    refused={},
    refusals={},
    strange_lines=0,
    journal="board.jsonl",
    journal_bytes=100,
    trouble="",
    lanes=[
        LaneStatus(host="map", boot="b", lane="knowledge", posted=9, held=7, missing=2),
        LaneStatus(host="map", boot="b", lane="large", posted=9, held=8, missing=1),
    ],
    hosts=[
        HostLine(host="map", state="hung", boot="b", machine="shed", offset_s=0.25),
        HostLine(host="robot", state="alive", boot="c", machine="desk"),
        HostLine(host="manager", state="alive", boot="d", machine="desk"),
    ],
)
KEEPER = KeeperStatus(
    boot="k",
    version="1",
    pid=10,
    machine="desk",
    address="tcp/127.0.0.1:7447",
    folder="runs/board",
    uptime_s=60.0,
    clients=3,
    overflowed=0,
    refused={},
    rejected={},
    boards=[BOARD],
)
SHED = AgentReport(
    machine="shed",
    boot="s",
    pid=20,
    version="1",
    manager="m",
    processes=(
        ProcessReport(
            name="map", robot="k2a", state="running", machine="shed", pid=21, restarts=2, silent_s=3.0, cpu_s=1.5
        ),
    ),
)


def test_what_everybody_knows_is_joined() -> None:
    rows = {row.process: row for row in rows_of(KEEPER, [SHED], [], "desk")}
    assert list(rows) == ["keeper", "agent of shed", "manager", "map", "robot"]
    there = rows["map"]
    assert (there.machine, there.state, there.pid, there.restarts) == ("shed", "hung", 21, 2)
    assert (there.beat_age_s, there.offset_s, there.missing, there.cpu_s) == (3.0, 0.25, 3, 1.5)
    assert (rows["robot"].state, rows["robot"].pid, rows["robot"].missing) == ("alive", None, 0)
    assert (rows["keeper"].pid, rows["keeper"].missing, rows["keeper"].age_s) == (10, 3, 60.0)


def test_an_executor_says_more_of_what_has_ended() -> None:
    failed = ProcessReport(name="map", robot="k2a", state="failed", machine="shed", last_line="no such thing")
    rows = rows_of(
        KEEPER, [AgentReport(machine="shed", boot="s", pid=1, version="1", manager="m", processes=(failed,))], [], "x"
    )
    there = next(row for row in rows if row.process == "map")
    assert (there.state, there.pid, there.age_s, there.detail) == ("failed", None, None, "no such thing")


def test_one_that_waits_says_so() -> None:
    free = AgentReport(machine="shed", boot="s", pid=20, version="1", why="the manager was silent for 10 s")
    (row,) = rows_of(None, [free], [], "desk")
    assert row.detail == "waits for a manager, since the manager was silent for 10 s"


def test_without_a_keeper_there_is_what_stands_on_disk() -> None:
    me = Identity(os.getpid(), "now")
    rows = rows_of(None, (), [Record(name="robot", who=me), Record(name="manager", who=me)], "desk")
    assert [(row.process, row.machine, row.pid) for row in rows] == [
        ("manager", "desk", os.getpid()),
        ("robot", "desk", os.getpid()),
    ]
    assert (rows[1].cpu_s or 0.0) > 0.0
