"""`ski post KEY JSON`: post on a running board, as a person: checked against the vocabulary before anything is sent."""

import argparse
import json
import sys
from pathlib import Path

import msgspec

from blackboard.command.connection import add_connection_options, link_params
from blackboard.errors import BoardError, KeysError, LinkError
from blackboard.keeper.mission_kinds import mission_vocabulary
from blackboard.keeper.status import KeeperStatus
from blackboard.keys.members import read_member
from blackboard.keys.roles import may_put
from blackboard.link.addresses import KEEPER_STATUS
from blackboard.link.session import Session, open_session
from blackboard.watching.saying import check_speaker, parse_key, read_value, whole_key
from blackboard.watching.summary import printable, summarise
from blackboard.watching.visit import Visit


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument(
        "key", metavar="KEY", help="e.g. motivations/motivation/target_nav; ski/<robot>/... for one of several"
    )
    parser.add_argument("value", nargs="?", metavar="JSON", help="the value; - reads it from standard input")
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument("--retract", action="store_true", help="take what you posted off the board")
    instead.add_argument("--for", dest="reason_for", metavar="WHY", help="say why you hold what stands there for true")
    instead.add_argument("--against", metavar="WHY", help="say why you do not")
    parser.add_argument(
        "--about", default="", help="what the reason is about: your next one about the same takes its place"
    )
    parser.add_argument(
        "--as", dest="name", default="operator", metavar="NAME", help="who says it (default: %(default)s)"
    )
    parser.add_argument("--mission", metavar="MISSION", help="a mission whose components bring kinds of their own")
    parser.add_argument("--json", action="store_true", help="print what was posted as JSON")
    add_connection_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    instead = options.retract or options.reason_for is not None or options.against is not None
    if (options.value is None) != bool(instead):
        raise BoardError("give either a JSON value to post, or one of --retract, --for WHY, --against WHY")
    text = sys.stdin.buffer.read() if options.value == "-" else (options.value or "").encode()
    vocabulary = mission_vocabulary([] if options.mission is None else [options.mission])
    if options.key.startswith("ski/"):
        parse_key(vocabulary, options.key)
    with open_session(link_params(options)) as session:
        key = whole_key(options.key, _robots(session))
        robot, kind, member = parse_key(vocabulary, key)
        _check_role(options.keys, key)
        visit = Visit(session, vocabulary, robot)
        board = visit.board
        check_speaker(board, options.name)
        if options.retract:
            board.retract(kind, member, source=options.name)
        elif options.value is None:
            verdict, why = ("for", options.reason_for) if options.against is None else ("against", options.against)
            board.endorse(key, who=options.name, verdict=verdict, why=why, about=options.about)  # type: ignore[arg-type]
        else:
            board.post(kind, read_value(board, kind, member, text), id=member, source=options.name)
        for payload in visit.send():
            if options.json:
                sys.stdout.write(json.dumps(msgspec.json.decode(payload), indent=2) + "\n")
            else:
                sys.stdout.write(f"{printable(key)} {summarise(payload)}\n")
    return 0


def _check_role(keys: Path | None, key: str) -> None:
    """Raise KeysError where the keeper would turn the post away without a word."""
    if keys is not None:
        speaker = read_member(keys)
        if not may_put(speaker, key):
            raise KeysError(
                f"{key}: {speaker.name} ({', '.join(speaker.roles)}) may not post there; `ski keys` gives other roles"
            )


def _robots(session: Session) -> list[str]:
    """Return the robots whose boards the keeper has."""
    for answer in session.ask(KEEPER_STATUS):
        if not answer.error:
            return [board.robot for board in msgspec.json.decode(answer.payload, type=KeeperStatus).boards]
    raise LinkError("no board keeper answers, or these keys may not ask it; `ski doctor` says why")
