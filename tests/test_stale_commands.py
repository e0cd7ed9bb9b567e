"""A velocity that was posted while the keeper was away is written down later, and never moves the robot."""

import time
from queue import Empty

import pytest
from cut_off import moves
from deployment import KEEPER, Deployment, Processes, free_port

from blackboard.kinds import DRIVE, ODOMETRY, VELOCITY
from blackboard.link.replica import Replica
from blackboard.link.session import LinkParams, open_session
from blackboard.messages.motion import Velocity
from blackboard.vocabulary import Vocabulary

pytestmark = pytest.mark.timeout(180)
WAIT_S = 60.0  # that long only where the thing never happens


@pytest.fixture
def processes(tmp_path):
    """Keeper and robot alone: the test is the behaviours."""
    address = f"tcp/127.0.0.1:{free_port()}"
    with Processes(Deployment(folder=tmp_path, address=address, mission="wander-lab", hosts=("robot",))) as at_work:
        at_work.start_all()
        yield at_work


@pytest.fixture
def commander(processes, tmp_path):
    with open_session(LinkParams(address=processes.deployment.address)) as session:
        replica = Replica(session, Vocabulary(), "k2a", "behaviours", state=tmp_path / "commander")
        replica.join()
        yield replica
        replica.close()


def run_until(replica, holds):
    end_s = time.monotonic() + WAIT_S
    while not holds():
        assert time.monotonic() < end_s, "it never happened"
        try:
            replica.handle(replica.queue.get(timeout=0.05))
        except Empty:
            replica.tend()


def command(replica, forward_mps):
    now_s = replica.board.now_s = replica.now_s()
    wanted = Velocity(forward_mps=forward_mps, turn_radps=0.0, valid_until_s=now_s + 0.3)
    return replica.board.post(VELOCITY, wanted, source="test")


def newest(replica, kind):
    """Return a function that says whether something newer than now has come."""
    stood = replica.board.newest(kind)
    return lambda: replica.board.newest(kind) is not stood


def drives(replica, forward):
    entry = replica.board.newest(DRIVE)
    return entry is not None and (entry.value.forward_mps > 0) == forward


def test_a_velocity_that_comes_late_moves_nothing(processes, commander):
    run_until(commander, newest(commander, ODOMETRY))
    run_until(commander, lambda: command(commander, 0.1) and drives(commander, forward=True))  # one in time does
    run_until(commander, lambda: drives(commander, forward=False))  # and is good for a moment only
    run_until(commander, lambda: not commander.unacknowledged)
    stood_s = commander.now_s()

    processes.kill(KEEPER)
    stale = command(commander, 0.3)
    assert commander.unacknowledged
    processes.start(KEEPER)
    run_until(commander, lambda: not commander.unacknowledged)  # the keeper has it
    run_until(commander, newest(commander, ODOMETRY))  # and the robot is there again

    processes.kill("robot")  # its next start finds the velocity on the board
    processes.start("robot")
    run_until(commander, newest(commander, ODOMETRY))
    run_until(commander, newest(commander, DRIVE))
    processes.stop_all()

    journal = processes.deployment.journal
    assert f'"stamp_s":{stale.stamp_s!r}'.encode() in journal.read_bytes()
    told, _ = moves(journal, "k2a")
    assert any(drive.forward_mps > 0 for stamp_s, drive in told if stamp_s < stood_s)
    assert not [stamp_s for stamp_s, drive in told if stamp_s > stood_s and drive.forward_mps > 0]
