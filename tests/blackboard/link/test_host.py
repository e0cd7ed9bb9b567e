"""A host that starts while its keeper is away."""

from queue import SimpleQueue
from threading import Thread

import pytest

from blackboard.errors import LinkError
from blackboard.keeper.service import Keeper
from blackboard.link import configuration
from blackboard.link import host as module
from blackboard.link.addresses import host_beat
from blackboard.link.host import Host, HostOptions
from blackboard.link.session import Arrived, LinkParams, open_session
from blackboard.mission import find_mission, load_mission
from blackboard.vocabulary import Vocabulary

WAIT_S = 20.0


@pytest.fixture
def started(address, monkeypatch):
    """Return a function that makes a host, and the attempts that it makes to reach a keeper."""
    monkeypatch.setattr(configuration, "CONNECT_MS", 100)
    attempts = []

    def make(patience_s, before=lambda: None):
        reach = module.open_session

        def opened(link):
            attempts.append(link)
            if len(attempts) == 3:
                before()
            return reach(link)

        monkeypatch.setattr(module, "open_session", opened)
        options = HostOptions(link=LinkParams(address=address), patience_s=patience_s)
        return Host(load_mission(find_mission("wander-lab")), "behaviours", options)

    return make, attempts


def test_a_patient_host_waits_for_the_keeper(started, tmp_path, address):
    make, attempts = started
    keeper = Keeper(LinkParams(address=address), tmp_path / "boards", Vocabulary())
    serving = Thread(target=keeper.run)
    there: SimpleQueue[bool] = SimpleQueue()
    beats: SimpleQueue[Arrived] = SimpleQueue()

    def begin():
        keeper.open()
        serving.start()
        there.put(True)

    host = make(3600.0, begin)
    working = Thread(target=host.run)
    working.start()
    try:
        there.get(timeout=WAIT_S)
        with open_session(LinkParams(address=address)) as session:
            session.subscribe(host_beat("k2a", "behaviours"), beats.put)
            beats.get(timeout=WAIT_S)
    finally:
        host.stop()
        working.join()
        keeper.stop()
        serving.join()
        keeper.close()
    assert len(attempts) == 3


def test_one_without_patience_tries_once(started):
    make, attempts = started
    with pytest.raises(LinkError, match="no keeper answers"):
        make(0.0).run()
    assert len(attempts) == 1


def test_a_patient_one_gives_up_when_it_is_told_to_end(started):
    make, attempts = started
    host = make(3600.0, lambda: host.stop())
    with pytest.raises(LinkError, match="no keeper answers"):
        host.run()
    assert len(attempts) == 3
