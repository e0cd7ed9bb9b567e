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
        default=os.environ.get("SKI_CONNECT") or DEFAULT_ADDRESS,
        metavar="ADDRESS",
        help="the board keeper's address, tcp/HOST:PORT (default: %(default)s)",
    )
    parser.add_argument(
        "--keys",
        type=Path,
        default=Path(os.environ["SKI_KEYS"]) if os.environ.get("SKI_KEYS") else None,
        metavar="DIR",
        help="folder with the certificates to show, where the keeper asks for them",
    )


def link_params(options: argparse.Namespace) -> LinkParams:
    """Return the LinkParams that the options stand for; raise LinkError where the address is none."""
    parse_address(options.connect)
    return LinkParams(address=options.connect, keys=options.keys)
