"""Envelopes as hosts send them."""

import socket
from dataclasses import replace
from threading import Thread

import msgspec
import pytest

from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.journal import line_of
from blackboard.keeper.checking import Checker
from blackboard.keeper.service import Keeper
from blackboard.kinds import BATTERY
from blackboard.link.envelope import Origin, attachment_of
from blackboard.link.session import Arrived, LinkParams, open_session
from blackboard.messages.sensing import Battery
from blackboard.vocabulary import Vocabulary


@pytest.fixture
def checker():
    return Checker(Vocabulary(), 100_000)


@pytest.fixture
def battery():
    """Return a reading as it travels: number `n` of lane signal, revision `n`, stamp `n` seconds."""

    def make(n, host="robot", boot="b1", robot="k2a", lane="signal", **changes):
        key = Board(Vocabulary(), robot=robot).key(BATTERY)
        value = Battery(charge_fraction=n % 100 / 100)
        entry = Entry(
            key=key,
            id=None,
            revision=n,
            event="posted" if n == 1 else "revised",
            stamp_s=float(n),
            source=host,
            value=value,
        )
        payload = line_of(entry, msgspec.json.encode(value))
        message = Arrived(key, payload, attachment_of(Origin(host, boot, lane, n)))
        return replace(message, **changes)

    return make


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
