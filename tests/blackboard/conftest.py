"""A keeper at work, and a link to it."""

import socket
from threading import Thread

import pytest

from blackboard.keeper.service import Keeper
from blackboard.link.session import LinkParams, open_session
from blackboard.vocabulary import Vocabulary


@pytest.fixture
def address():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{free.getsockname()[1]}"


@pytest.fixture
def keeper(tmp_path, address):
    """A keeper at work in a thread of its own."""
    at_work = Keeper(LinkParams(address=address), tmp_path / "boards", Vocabulary())
    try:
        at_work.open()
        thread = Thread(target=at_work.run)
        thread.start()
        yield at_work
        at_work.stop()
        thread.join()
    finally:
        at_work.close()


@pytest.fixture
def client(keeper, address):
    with open_session(LinkParams(address=address)) as session:
        yield session
