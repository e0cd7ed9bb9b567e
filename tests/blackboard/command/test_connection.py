"""The shared arguments of verbs that talk to a running board."""

import argparse
from pathlib import Path

import pytest

from blackboard.command.connection import DEFAULT_ADDRESS, AddressError, add_connection_options, host_and_port


def parsed(*arguments: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add_connection_options(parser)
    return parser.parse_args(arguments)


def test_flag_over_environment_over_default(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SKI_CONNECT", raising=False)
    monkeypatch.setenv("SKI_KEYS", "")
    assert (parsed().connect, parsed().keys) == (DEFAULT_ADDRESS, None)
    monkeypatch.setenv("SKI_CONNECT", "tls/board:7447")
    monkeypatch.setenv("SKI_KEYS", "mine")
    assert (parsed().connect, parsed().keys) == ("tls/board:7447", Path("mine"))
    given = parsed("--connect", "tcp/10.0.0.1:1", "--keys", "others")
    assert (given.connect, given.keys) == ("tcp/10.0.0.1:1", Path("others"))


def test_host_and_port() -> None:
    assert host_and_port("tcp/127.0.0.1:7447") == ("127.0.0.1", 7447)
    assert host_and_port("tls/board.example:65535") == ("board.example", 65535)
    assert host_and_port("tcp/[::1]:7447") == ("::1", 7447)


@pytest.mark.parametrize(
    "address",
    [
        "",
        "7447",
        "localhost:7447",
        "udp/127.0.0.1:7447",
        "tcp/127.0.0.1",
        "tcp/127.0.0.1:0",
        "tcp/h:65536",
        "tcp/h:1\n",
    ],
)
def test_what_is_no_address(address: str) -> None:
    with pytest.raises(AddressError, match="write tcp/HOST:PORT or tls/HOST:PORT") as caught:
        host_and_port(address)
    assert "\n" not in str(caught.value)
