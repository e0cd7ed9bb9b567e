"""A folder of keys on the machine where they are made.

DIR/authority/{ca.pem, key.pem}                     signs; only `ski keys` needs it, keep it to yourself
DIR/members.json, DIR/keeper/                       what the keeper needs
DIR/members/NAME/{ca, cert, key}.pem, member.json   what a member needs: copy this folder to its machine
"""

import datetime
from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec

from blackboard.errors import KeysError, LinkError
from blackboard.keys.certificates import KEEPER_NAME, Pair, expiry, hosts_of, make_authority, make_keeper, make_member
from blackboard.keys.files import make_folder, read_file, write_files
from blackboard.keys.members import (
    KEEPER_FILE,
    MEMBER_FILE,
    MEMBERS_FILE,
    KeeperKeys,
    Member,
    encode,
    new_member,
    read_keeper,
    read_members,
)
from blackboard.link.address import parse_address

LOOPBACK = ("localhost", "127.0.0.1", "::1")  # the keeper's certificate is good for these too
AUTHORITY_DAYS = 3650
DAYS = 365  # of the keeper's and members' certificates
MAX_DAYS = 3650


def create(path: Path, hosts: Sequence[str], now: datetime.datetime, days: int = DAYS) -> None:
    """Make an authority and the keeper's keys in a new folder; `hosts` are the names and addresses under which others reach it.

    This and all below raise KeysError where it cannot be done.
    """
    _check_days(days)
    for host in hosts:
        _check_host(host)
    make_folder(path, empty=True)
    authority = make_authority(now, AUTHORITY_DAYS)
    write_files(path / "authority", {"ca.pem": authority.certificate, "key.pem": authority.key})
    _write_keeper(path, hosts, now, days)
    write_files(path, {MEMBERS_FILE: encode(())})


def add(
    path: Path,
    roles: Iterable[str],
    name: str,
    now: datetime.datetime,
    *,
    robots: Iterable[str] = (),
    hosts: Iterable[str] = (),
    days: int = DAYS,
) -> Path:
    """Make a member's keys; return the folder to copy to its machine. The name of one that was revoked may come back."""
    _check_days(days)
    members = read_members(path)
    member = new_member(name, roles, now, robots, hosts)
    before = members.get(name)
    if name == KEEPER_NAME:
        raise KeysError(f"'{name}' is the keeper's own name; give the member another one")
    if before is not None:
        if not before.revoked:
            raise KeysError(f"{name} is a member already; `ski keys renew` or `ski keys revoke` it")
        member = msgspec.structs.replace(member, generation=before.generation + 1)
    return _issue(path, members, member, now, days)


def renew(path: Path, name: str, now: datetime.datetime, days: int = DAYS) -> Path:
    """Make new keys for a member or the keeper; a member's old ones count no more once the keeper has started again."""
    _check_days(days)
    members = read_members(path)
    if name == KEEPER_NAME:
        _write_keeper(path, read_keeper(path / "keeper").hosts, now, days)
        return path / "keeper"
    member = _known(members, name)
    if member.revoked:
        raise KeysError(f"{name} was revoked; `ski keys add` it again")
    return _issue(path, members, msgspec.structs.replace(member, generation=member.generation + 1), now, days)


def revoke(path: Path, name: str) -> None:
    """Take all rights from a member, from the keeper's next start on."""
    members = read_members(path)
    members[name] = msgspec.structs.replace(_known(members, name), revoked=True)
    write_files(path, {MEMBERS_FILE: encode(list(members.values()))})


def listed(path: Path) -> list[Member]:
    """Return the keeper, as if it were a member, and all members."""
    members = read_members(path)
    keeper = read_keeper(path / "keeper")
    shown = Member(name=KEEPER_NAME, roles=(KEEPER_NAME,), hosts=keeper.hosts, expires=keeper.expires)
    return [shown, *members.values()]


def _issue(path: Path, members: dict[str, Member], member: Member, now: datetime.datetime, days: int) -> Path:
    authority = _authority(path)
    pair = make_member(authority, member.common_name, now, days)
    member = msgspec.structs.replace(member, expires=expiry(pair.certificate))
    folder = path / "members" / member.name
    make_folder(folder.parent)
    files = {"ca.pem": authority.certificate, "cert.pem": pair.certificate, "key.pem": pair.key}
    write_files(folder, {**files, MEMBER_FILE: encode(member)})
    write_files(path, {MEMBERS_FILE: encode(list({**members, member.name: member}.values()))})
    return folder


def _write_keeper(path: Path, hosts: Sequence[str], now: datetime.datetime, days: int) -> None:
    authority = _authority(path)
    pair = make_keeper(authority, list(dict.fromkeys([*hosts, *LOOPBACK])), now, days)
    said = KeeperKeys(hosts=hosts_of(pair.certificate), expires=expiry(pair.certificate))
    files = {"ca.pem": authority.certificate, "cert.pem": pair.certificate, "key.pem": pair.key}
    write_files(path / "keeper", {**files, KEEPER_FILE: encode(said)})


def _authority(path: Path) -> Pair:
    return Pair(read_file(path / "authority" / "ca.pem"), read_file(path / "authority" / "key.pem"))


def _known(members: dict[str, Member], name: str) -> Member:
    if name not in members:
        known = ", ".join(members) or "nobody yet"
        raise KeysError(f"there is no member '{name}'; members: {known}")
    return members[name]


def _check_host(host: str) -> None:
    try:
        parsed = parse_address(f"[{host}]" if ":" in host else host)
    except LinkError:
        raise KeysError(f"host '{host}': give a host name or an IP address, without a port") from None
    if parsed.host in ("0.0.0.0", "::"):  # noqa: S104 - named to be refused
        raise KeysError(f"host '{host}' is no place that others can reach; give this machine's name or address")


def _check_days(days: int) -> None:
    if not 1 <= days <= MAX_DAYS:
        raise KeysError(f"--days {days} is outside 1..{MAX_DAYS}")
