"""`ski keys`: make, list, renew and revoke the keys of a board that other machines can reach."""

import argparse
import datetime
import importlib
import json
import sys
from pathlib import Path
from types import ModuleType

from blackboard.errors import KeysError
from blackboard.keys.members import ROLES, Member
from blackboard.keys.roles import MEANINGS
from blackboard.link.address import DEFAULT_ADDRESS
from blackboard.link.configuration import client_configuration

EXPIRES_SOON_DAYS = 30


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    init = actions.add_parser("init", help="make an authority and the keeper's keys in a new folder")
    init.add_argument("folder", type=Path, metavar="DIR", help="the folder; it stays on this machine")
    init.add_argument(
        "--host",
        action="append",
        required=True,
        metavar="NAME_OR_IP",
        help="a name or address under which others reach the keeper; may be given again",
    )
    add = actions.add_parser(
        "add",
        help="make a member's keys",
        epilog="roles: " + "; ".join(f"{role}: {MEANINGS[role]}" for role in ROLES),
    )
    add.add_argument("folder", type=Path, metavar="DIR", help="the folder that `ski keys init` made")
    add.add_argument("roles", metavar="ROLE[,ROLE...]", help=f"what it may do: {', '.join(ROLES)}")
    add.add_argument("name", metavar="NAME", help="the member's name; an agent's is that of its machine")
    add.add_argument(
        "--robot",
        action="append",
        default=[],
        metavar="NAME",
        help="the robot that it may post for; may be given again (default: every robot; needed for a robot)",
    )
    add.add_argument(
        "--hosts",
        nargs="+",
        default=[],
        metavar="NAME",
        help="the hosts that it may run as (default: one, by its own name)",
    )
    renew = actions.add_parser("renew", help="make new keys for a member, or for `keeper`, in place of the ones it has")
    revoke = actions.add_parser("revoke", help="take all rights from a member")
    listing = actions.add_parser(
        "list", help="show the keeper and all members, their roles and until when their keys count"
    )
    config = actions.add_parser(
        "config", help="print zenoh's configuration for other zenoh tools that show a member's keys"
    )
    config.add_argument("folder", type=Path, metavar="DIR/members/NAME", help="the member's folder")
    config.add_argument(
        "--connect", default=DEFAULT_ADDRESS, metavar="ADDRESS", help="the keeper's address (default: %(default)s)"
    )
    for below in (renew, revoke, listing):
        below.add_argument("folder", type=Path, metavar="DIR", help="the folder that `ski keys init` made")
    for below in (renew, revoke):
        below.add_argument("name", metavar="NAME", help="the member's name")
    for below in (init, add, renew):
        below.add_argument("--days", type=int, default=365, help="until when the keys count (default: %(default)s)")
    listing.add_argument("--json", action="store_true", help="print a JSON list")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    if options.action == "config":
        _say(json.dumps(client_configuration(options.connect, options.folder.absolute()), indent=2))
        return 0
    folder = _folder_module()
    now = datetime.datetime.now(datetime.UTC)
    path: Path = options.folder
    match options.action:
        case "init":
            folder.create(path, options.host, now, options.days)
            _say(f"wrote {path}; keep {path}/authority to yourself\nnext: ski keys add {path} viewer NAME")
            _say(f"then:  ski board serve --listen tls/0.0.0.0:7447 --keys {path}")
        case "add":
            roles = [role for role in options.roles.split(",") if role]
            made = folder.add(
                path, roles, options.name, now, robots=options.robot, hosts=options.hosts, days=options.days
            )
            _say(f"wrote {made}; copy it to where {options.name} runs, and name it there with --keys\n{_RESTART}")
        case "renew":
            made = folder.renew(path, options.name, now, options.days)
            _say(f"wrote {made}; copy it to where {options.name} runs\n{_RESTART}")
        case "revoke":
            folder.revoke(path, options.name)
            _say(f"{options.name} may do nothing any more\n{_RESTART}")
        case _:
            members = folder.listed(path)
            _say(
                json.dumps([_row(member, now) for member in members], indent=2)
                if options.json
                else _table(members, now)
            )
    return 0


_RESTART = "this counts from the keeper's next start on"


def _folder_module() -> ModuleType:
    try:
        return importlib.import_module("blackboard.keys.folder")
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "cryptography":
            raise
        raise KeysError(
            "making keys takes the package cryptography: pip install 'sensory-knowledge-integrator[access]'"
        ) from None


def _table(members: list[Member], now: datetime.datetime) -> str:
    rows = [("name", "roles", "robots", "hosts", "expires", "state")]
    for member in members:
        roles, robots, hosts = (",".join(names) or "-" for names in (member.roles, member.robots, member.hosts))
        state = _state(member, now)
        rows.append((member.name, roles, robots, hosts, f"{member.expires:%Y-%m-%d}", state))
    widths = [max(len(row[i]) for row in rows) for i in range(6)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    )


def _row(member: Member, now: datetime.datetime) -> dict[str, object]:
    return {
        "name": member.name,
        "roles": list(member.roles),
        "robots": list(member.robots),
        "hosts": list(member.hosts),
        "expires": member.expires.isoformat(),
        "state": _state(member, now),
    }


def _state(member: Member, now: datetime.datetime) -> str:
    days = (member.expires - now).days
    if member.revoked:
        return "revoked"
    if member.expires <= now:
        return "expired"
    return f"expires in {days} days" if days < EXPIRES_SOON_DAYS else "good"


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
