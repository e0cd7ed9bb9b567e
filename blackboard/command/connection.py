"""Where the board keeper is and who asks: the arguments that every verb shares which talks to a running board."""

import argparse
import importlib
import os
import re
from pathlib import Path
from typing import Any

from blackboard.errors import SkiError

DEFAULT_ADDRESS = "tcp/127.0.0.1:7447"
_LOCATOR = re.compile(r"(tcp|tls)/(\[[0-9A-Fa-f:.]+\]|[^\s/:\[\]]+):([0-9]{1,5})")


class AddressError(SkiError):
    """An address that no keeper can have."""


def add_connection_options(parser: argparse.ArgumentParser) -> None:
    """Declare `--connect` and `--keys`; `SKI_CONNECT` and `SKI_KEYS` are their defaults."""
    parser.add_argument(
        "--connect",
        default=os.environ.get("SKI_CONNECT") or DEFAULT_ADDRESS,
        metavar="ADDRESS",
        help="the board keeper's address, tcp/HOST:PORT or tls/HOST:PORT (default: %(default)s)",
    )
    parser.add_argument(
        "--keys",
        type=Path,
        default=Path(os.environ["SKI_KEYS"]) if os.environ.get("SKI_KEYS") else None,
        metavar="DIR",
        help="folder with the certificates to show, where the keeper asks for them",
    )


def link_params(options: argparse.Namespace) -> Any:
    """Return the LinkParams that the options stand for; raise AddressError where the address is none."""
    host_and_port(options.connect)
    return importlib.import_module("blackboard.link.session").LinkParams(address=options.connect, keys=options.keys)


def host_and_port(address: str) -> tuple[str, int]:
    """Return host and port of `tcp/HOST:PORT` or `tls/HOST:PORT`; raise AddressError for anything else."""
    found = _LOCATOR.fullmatch(address)
    if found is None or not 1 <= int(found.group(3)) <= 65535:
        raise AddressError(f"address {address!r}: write tcp/HOST:PORT or tls/HOST:PORT, such as {DEFAULT_ADDRESS}")
    return found.group(2).strip("[]"), int(found.group(3))
