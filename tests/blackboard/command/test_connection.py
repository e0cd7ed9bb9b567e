"""The shared arguments of verbs that talk to a running board."""

import argparse
from pathlib import Path

import pytest

from blackboard.command.connection import add_connection_options, link_params
from blackboard.errors import LinkError
from blackboard.link.address import DEFAULT_ADDRESS


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


def test_what_is_no_address_is_refused_before_anything_is_loaded() -> None:
    with pytest.raises(LinkError, match="udp"):
        link_params(parsed("--connect", "udp/127.0.0.1:7447"))
