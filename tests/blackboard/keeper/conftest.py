"""Envelopes as hosts send them."""

from dataclasses import replace

import msgspec
import pytest

from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.journal import line_of
from blackboard.keeper.checking import Checker
from blackboard.kinds import BATTERY
from blackboard.link.envelope import Origin, attachment_of
from blackboard.link.session import Arrived
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
