"""zenoh's configuration without keys: loopback only, nothing else open."""

import json

import pytest

from blackboard.errors import LinkError
from blackboard.link.configuration import client_configuration, router_configuration

zenoh = pytest.importorskip("zenoh")


@pytest.mark.parametrize("make", [client_configuration, router_configuration])
def test_zenoh_takes_it_and_nothing_is_left_open(make):
    given = make("tcp/127.0.0.1:7612")
    taken = json.loads(str(zenoh.Config.from_json5(json.dumps(given))))
    assert taken["scouting"]["multicast"]["enabled"] is False
    assert taken["scouting"]["gossip"]["enabled"] is False
    assert taken["transport"]["shared_memory"]["enabled"] is False
    assert taken["adminspace"]["enabled"] is False
    ends = "connect" if given["mode"] == "client" else "listen"
    assert taken[ends]["endpoints"] == ["tcp/127.0.0.1:7612"]
    assert taken[{"connect": "listen", "listen": "connect"}[ends]]["endpoints"] == []


@pytest.mark.parametrize("make", [client_configuration, router_configuration])
@pytest.mark.parametrize("address", ["0.0.0.0:7612", "192.168.1.7", "tcp/[::]:7612", "robot.lan:7612"])
def test_beyond_loopback_it_takes_keys(make, address):
    with pytest.raises(LinkError, match="takes keys: `ski keys init"):
        make(address)


@pytest.mark.parametrize("make", [client_configuration, router_configuration])
def test_tls_takes_keys(make):
    with pytest.raises(LinkError, match="takes keys: `ski keys init"):
        make("tls/127.0.0.1:7612")
