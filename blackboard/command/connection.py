"""Where the board keeper is and who asks: the arguments that every verb shares which talks to a running board."""

import argparse
import os
from pathlib import Path

from blackboard.link.address import DEFAULT_ADDRESS, parse_address
from blackboard.link.session import LinkParams


def add_connection_options(parser: argparse.ArgumentParser) -> None:
    """Declare `--connect` and `--keys`; `SKI_CONNECT` and `SKI_KEYS` are their defaults."""
    parser.add_argument(
        "--connect",
        default=default_address(),
        metavar="ADDRESS",
        help="the board keeper's address, tcp/HOST:PORT (default: %(default)s)",
    )
    parser.add_argument(
        "--keys",
        type=Path,
        default=default_keys(),
        metavar="DIR",
        help="folder with the certificates to show, where the keeper asks for them",
    )


def default_address() -> str:
    """Return the keeper's address where none is named."""
    return os.environ.get("SKI_CONNECT") or DEFAULT_ADDRESS


def default_keys() -> Path | None:
    """Return the folder of certificates where none is named."""
    return Path(os.environ["SKI_KEYS"]) if os.environ.get("SKI_KEYS") else None


def link_params(options: argparse.Namespace) -> LinkParams:
    """Return the LinkParams that the options stand for; raise LinkError where the address is none."""
    parse_address(options.connect)
    return LinkParams(address=options.connect, keys=options.keys)
