"""Processes that stand still for a while, and readers that do: the robot stands, the others go on, nothing is lost."""

import sys
from queue import SimpleQueue

import pytest
from deployment import CHECKOUT, Deployment, Processes, free_port
from trial import note_beats

from blackboard.kinds import DRIVE, HOST, ODOMETRY, VELOCITY
from blackboard.link.envelope import read_origin
from blackboard.link.session import LinkParams, open_session

pytestmark = pytest.mark.timeout(180)
WAIT_S = 60.0  # that long only where the thing never happens


@pytest.fixture
def processes(tmp_path):
    """Keeper, robot and behaviours at work."""
    address = f"tcp/127.0.0.1:{free_port()}"
    place = {"folder": tmp_path, "address": address}
    deployment = Deployment(**place, mission="wander-lab", hosts=("robot", "behaviours"), pace=4.0)
    with Processes(deployment) as at_work:
        at_work.start_all()
        yield at_work


@pytest.fixture
def hear(processes):
    """Return a function that waits for the next message of a kind that fits."""
    with open_session(LinkParams(address=processes.deployment.address)) as session:
        note_beats(session, processes)
        came = {}
        for kind in (DRIVE, HOST, ODOMETRY, VELOCITY):
            came[kind.path] = SimpleQueue()
            session.subscribe(f"ski/k2a/{kind.path}{'/*' if kind.collection else ''}", came[kind.path].put)

        def until(kind, fits=lambda arrived: True):
            while True:
                arrived = came[kind.path].get(timeout=WAIT_S)
                if fits(arrived):
                    return arrived

        yield until


def says(*words):
    return lambda arrived: all(word in arrived.payload for word in words)


def test_behaviours_that_hang_leave_the_robot_standing_and_go_on_when_they_can(processes, hear):
    boot = read_origin(hear(VELOCITY).attachment).boot
    hear(DRIVE, lambda arrived: b'"limited_by":"no command"' not in arrived.payload)
    processes.freeze("behaviours")
    hear(DRIVE, says(b'"limited_by":"no command"', b'"forward_mps":0.0'))
    hear(HOST, says(b"behaviours", b'"hung"'))
    processes.thaw("behaviours")
    hear(HOST, says(b"behaviours", b'"alive"'))
    last = read_origin(hear(VELOCITY).attachment)
    hear(DRIVE, lambda arrived: b'"limited_by":"no command"' not in arrived.payload)
    assert last.boot == boot
    processes.stop_all()
    account = processes.ledger.account(processes.deployment.journal, map(processes.deployment.outbox, ("behaviours",)))
    assert (account.missing, account.in_outboxes, account.missed) == ({}, 0, 0)


def test_a_reader_that_stands_still_holds_nobody_up(processes, hear):
    reader = [sys.executable, str(CHECKOUT / "benchmarks" / "board_reader.py"), processes.deployment.address]
    processes.start_beside("reader", [*reader, "ski/k2a/**", "--notes", str(processes.deployment.folder / "notes")])
    first = read_origin(hear(ODOMETRY).attachment).number
    processes.freeze("reader")
    hear(ODOMETRY, lambda arrived: read_origin(arrived.attachment).number > first + 300)  # many seconds of readings
    hear(VELOCITY)
    processes.thaw("reader")
    processes.kill("reader")
    processes.stop_all()
    account = processes.ledger.account(processes.deployment.journal, map(processes.deployment.outbox, ("robot",)))
    assert (account.missing, account.in_outboxes, account.missed) == ({}, 0, 0)
