"""A nursery forks `ski` commands: on a leash, with their own log, their ends known; its own end takes nobody with it."""

import os
import queue
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from blackboard.errors import OutputError
from blackboard.processes.child import Ended
from blackboard.processes.identity import gone_within, is_alive
from blackboard.processes.nursery_children import UNKNOWN, ForkedChild, Nursery, can_fork

pytestmark = pytest.mark.skipif(not can_fork(), reason="this system cannot hand over files or hold processes")

LONG_S = 20.0


class Owner:
    def __init__(self, folder: Path) -> None:
        self.log = folder / "child.log"
        self.ends: queue.SimpleQueue[Ended] = queue.SimpleQueue()
        self.nursery = Nursery("wander-lab", folder / "nursery.log")
        self.children: list[ForkedChild] = []

    def fork(self, *arguments: str) -> ForkedChild:
        self.children.append(self.nursery.start("map", arguments, self.log, self.ends.put))
        return self.children[-1]

    def fork_waiting(self, tmp_path: Path) -> ForkedChild:
        """Fork a command that waits until it is ended: nobody ever writes to what it is to read."""
        pipe = tmp_path / "waits.fifo"
        os.mkfifo(pipe)
        return self.fork("lines", str(pipe), "--out", str(tmp_path / "out"))


@pytest.fixture
def owner(tmp_path: Path) -> Iterator[Owner]:
    owner = Owner(tmp_path)
    try:
        yield owner
    finally:
        for child in owner.children:
            child.kill()
        owner.nursery.close()


def test_what_it_forks_is_the_command_with_its_own_log(owner: Owner) -> None:
    child = owner.fork("check", "wander-lab")
    ended = owner.ends.get(timeout=LONG_S)
    assert (ended.name, ended.pid, ended.code, ended.last_line) == ("map", child.pid, 0, "The mission is sound.")
    assert child.join(LONG_S) == 0


def test_an_error_is_one_line_and_a_code(owner: Owner) -> None:
    owner.fork("check", "wander-lap")
    ended = owner.ends.get(timeout=LONG_S)
    assert ended.code == 2
    assert ended.last_line.startswith("ski: there is no mission 'wander-lap'; did you mean 'wander-lab'?")


def test_wrong_arguments_end_it_too(owner: Owner) -> None:
    owner.fork("check", "--no-such-thing")
    assert owner.ends.get(timeout=LONG_S).code == 2


def test_one_that_is_killed(owner: Owner, tmp_path: Path) -> None:
    child = owner.fork_waiting(tmp_path)
    assert is_alive(child.identity)
    child.kill()
    assert owner.ends.get(timeout=LONG_S).code == -signal.SIGKILL


def test_the_nursery_may_end_before_its_children(owner: Owner, tmp_path: Path) -> None:
    child = owner.fork_waiting(tmp_path)
    who = owner.nursery.identity
    assert who is not None
    os.kill(who.pid, signal.SIGKILL)
    assert gone_within(who, LONG_S)
    assert is_alive(child.identity)
    with pytest.raises(OutputError, match="the nursery does not answer"):
        owner.fork("check", "wander-lab")
    assert not owner.nursery.alive
    child.terminate()
    assert owner.ends.get(timeout=LONG_S).code == UNKNOWN


def test_a_mission_that_cannot_be_loaded_leaves_it_able_to_fork(tmp_path: Path) -> None:
    nursery = Nursery("no-such-mission", tmp_path / "nursery.log")
    try:
        ends: queue.SimpleQueue[Ended] = queue.SimpleQueue()
        nursery.start("map", ["check", "wander-lab"], tmp_path / "map.log", ends.put)
        assert ends.get(timeout=LONG_S).code == 0
    finally:
        nursery.close()
