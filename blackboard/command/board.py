"""`ski board serve`: keep the board for all processes of a mission. `ski board status`: ask the keeper how it stands."""

import argparse
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from blackboard.command.connection import add_connection_options, default_address, default_keys, link_params
from blackboard.command.ending import when_told_to_end
from blackboard.errors import LinkError
from blackboard.keeper.board_folder import DEFAULT
from blackboard.link.address import parse_address
from blackboard.link.configuration import listening_at
from blackboard.link.session import LinkParams
from blackboard.vocabulary import Vocabulary

if TYPE_CHECKING:
    from blackboard.keys.rejections import Rejection

EXIT_MISSING = 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the sub-verbs and their arguments."""
    below = parser.add_subparsers(dest="board_verb", metavar="VERB", required=True)
    serve = below.add_parser(
        "serve",
        help="keep the board: pass on what is posted, write it down, answer those who come late",
        description="Keep the board of every robot: pass on what is posted, write it down, answer those who come late.",
    )
    serve.add_argument("mission", nargs="*", help="missions whose components bring kinds of entries of their own")
    serve.add_argument(
        "--listen",
        "--connect",
        dest="connect",
        default=default_address(),
        metavar="ADDRESS",
        help="where to listen (default: %(default)s)",
    )
    serve.add_argument(
        "--keys",
        type=Path,
        default=default_keys(),
        metavar="DIR",
        help="folder with the keeper's certificates: needed to listen beyond this machine",
    )
    serve.add_argument(
        "--out",
        "--folder",
        dest="folder",
        type=Path,
        default=DEFAULT,
        metavar="DIR",
        help="where to journal; what stands there is brought back (default: %(default)s)",
    )
    serve.add_argument("--fresh", action="store_true", help="begin with empty boards: what stands in DIR is set aside")
    serve.add_argument("--leashed", action="store_true", help="end when standard input ends")
    status = below.add_parser(
        "status",
        help="say what the keeper holds, and whether anything is missing",
        description="Say what the keeper holds. The exit status is 1 where something is missing or cannot be written down.",
    )
    add_connection_options(status)
    status.add_argument("--json", action="store_true", help="print it as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the sub-verb."""
    return _serve(options) if options.board_verb == "serve" else _status(options)


def _serve(options: argparse.Namespace) -> int:
    from blackboard.keeper.service import Keeper  # loads what `ski board --help` does not need
    from blackboard.keys.rejections import Rejections

    parse_address(options.connect)
    sys.setswitchinterval(0.0005)  # the clock is asked on other threads, and must be answered at once
    vocabulary = Vocabulary()
    if options.mission:
        from blackboard.keeper.mission_kinds import mission_vocabulary

        vocabulary = mission_vocabulary(options.mission)
    link = LinkParams(address=options.connect, keys=options.keys)
    rejections = Rejections(tell=_rejected)
    keeper = Keeper(link, options.folder, vocabulary, fresh=options.fresh, tell=_tell, rejected=rejections.told)
    try:
        if options.keys is not None:
            rejections.start()
        with when_told_to_end(keeper.stop):
            keeper.open()
            if options.leashed:
                from blackboard.processes.leashed import end_with_holder

                end_with_holder()
            for robot, entries in keeper.brought_back.items():
                sys.stdout.write(f"board of {robot}: {entries} entries stand again (--fresh begins anew)\n")
            sys.stdout.write(f"listening at {listening_at(link.address, link.keys)}, journals in {options.folder}\n")
            sys.stdout.flush()
            keeper.run()
    finally:
        keeper.close()
        rejections.close()
    return 0


def _status(options: argparse.Namespace) -> int:
    from blackboard.keeper.status import KeeperStatus, told
    from blackboard.link.addresses import KEEPER_STATUS
    from blackboard.link.session import open_session

    with open_session(link_params(options)) as session:
        answers = [answer for answer in session.ask(KEEPER_STATUS) if not answer.error]
    if not answers:
        raise LinkError(f"the keeper at {options.connect} does not answer; look at it, or start it anew")
    status = msgspec.json.decode(answers[0].payload, type=KeeperStatus)
    if options.json:
        sys.stdout.buffer.write(msgspec.json.format(answers[0].payload, indent=2) + b"\n")
    else:
        sys.stdout.writelines(f"{line}\n" for line in told(status))
    return EXIT_MISSING if status.missing or status.troubled else 0


def _rejected(rejection: "Rejection", often: int) -> None:
    from blackboard.keys.rejections import spoken

    line = spoken(rejection, often)
    if line is not None:
        _tell(line)


def _tell(line: str) -> None:
    sys.stderr.write(f"{time.strftime('%H:%M:%S')} {line}\n")
    sys.stderr.flush()
