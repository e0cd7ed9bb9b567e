"""Processes of a mission, each killed and started again: the others go on, and everything that was posted is written down."""

import time
from queue import SimpleQueue

import pytest
from deployment import KEEPER, Deployment, Processes, free_port
from trial import note_beats

from blackboard.kinds import DRIVE, GRID, ODOMETRY, VELOCITY
from blackboard.link import addresses
from blackboard.link.envelope import read_origin
from blackboard.link.session import LinkParams, open_session

pytestmark = pytest.mark.timeout(180)
WAIT_S = 60.0  # that long only where the thing never happens


class Ear:
    """Hears what comes under a key expression."""

    def __init__(self, session, expression):
        self._came = SimpleQueue()
        session.subscribe(expression, self._came.put)

    def until(self, fits=lambda arrived: True):
        """Return the first message that fits."""
        end_s = time.monotonic() + WAIT_S
        while True:
            arrived = self._came.get(timeout=max(0.001, end_s - time.monotonic()))
            if fits(arrived):
                return arrived


def boot_of(arrived):
    return read_origin(arrived.attachment).boot


@pytest.fixture
def processes(tmp_path):
    """Keeper, robot and behaviours at work."""
    address = f"tcp/127.0.0.1:{free_port()}"
    with Processes(
        Deployment(folder=tmp_path, address=address, mission="wander-lab", hosts=("robot", "behaviours"))
    ) as at_work:
        at_work.start_all()
        yield at_work


@pytest.fixture
def session(processes):
    with open_session(LinkParams(address=processes.deployment.address)) as opened:
        note_beats(opened, processes)
        yield opened


def account_at_the_end(processes):
    deployment = processes.deployment
    statuses = processes.stop_all()
    outboxes = [deployment.outbox(host) for host in ("robot", "behaviours", "knowledge_sources")]
    return statuses, processes.ledger.account(deployment.journal, outboxes)


def test_each_is_killed_and_started_again_and_nothing_is_lost(processes, session):
    readings, commands = (Ear(session, f"ski/k2a/{kind.path}") for kind in (ODOMETRY, VELOCITY))
    beats = Ear(session, addresses.keeper("k2a", "beat"))
    drives = Ear(session, f"ski/k2a/{DRIVE.path}")
    first = {"robot": boot_of(readings.until()), "behaviours": boot_of(commands.until())}

    processes.kill("robot")
    processes.start("robot")
    readings.until(lambda arrived: boot_of(arrived) != first["robot"])

    processes.kill("behaviours")
    processes.start("behaviours")
    commands.until(lambda arrived: boot_of(arrived) != first["behaviours"])

    keeper = beats.until().payload.partition(b",")[0]
    processes.kill(KEEPER)
    processes.start(KEEPER)
    beats.until(lambda arrived: not arrived.payload.startswith(keeper))
    moving = b'"limited_by":"no command"'
    drives.until(lambda arrived: moving not in arrived.payload)  # a command has come through to the wheels

    statuses, account = account_at_the_end(processes)
    assert statuses == {"robot": 0, "behaviours": 0, KEEPER: 0}
    assert account.boots["robot"] == account.boots["behaviours"] == 2
    assert (account.missing, account.twice, account.refused) == ({}, 0, 0)
    assert account.in_outboxes == 0
    assert account.missed == 0
    assert account.written == account.posted


def test_who_comes_late_takes_up_what_stands(processes, session):
    """Sonar echoes become a grid only for one who knows the robot's body, which its host told when it began."""
    Ear(session, f"ski/k2a/{VELOCITY.path}").until()
    grid = Ear(session, f"ski/k2a/{GRID.path}/*")
    processes.start("knowledge_sources")
    assert read_origin(grid.until().attachment).host == "knowledge_sources"
    _, account = account_at_the_end(processes)
    assert (account.missing, account.in_outboxes) == ({}, 0)
