"""The members of a board: names, roles, and which of their certificates counts. They stand in `members.json`."""

import datetime
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import msgspec

from blackboard.errors import KeysError, did_you_mean

ROLES = ("viewer", "planner", "operator", "robot", "knowledge", "agent")
HOSTING = ("planner", "robot", "knowledge")  # roles that run as hosts
MEMBERS_FILE = "members.json"
MEMBER_FILE = "member.json"
KEEPER_FILE = "keeper.json"
MAX_LIST_BYTES = 10_000_000

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.\-]{0,39}")  # a chunk of a key that is a file's name too


class Member(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Somebody who may speak with the keeper.

    `generation` counts its certificates: only the newest counts, since the number is part of the certificate's common name.
    """

    name: str
    roles: tuple[str, ...]
    robots: tuple[str, ...] = ()  # that it may post for; none named: every one
    hosts: tuple[str, ...] = ()  # the hosts that it may run as
    generation: Annotated[int, msgspec.Meta(ge=1)] = 1
    expires: datetime.datetime
    revoked: bool = False

    @property
    def common_name(self) -> str:
        """The common name of its certificate, which access control goes by."""
        return f"{self.name}.{self.generation}"


class KeeperKeys(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the keeper's certificate is good for, so that a keeper can look without reading certificates."""

    hosts: tuple[str, ...]
    expires: datetime.datetime


def new_member(
    name: str,
    roles: Iterable[str],
    expires: datetime.datetime,
    robots: Iterable[str] = (),
    hosts: Iterable[str] = (),
) -> Member:
    """Return a member whose parts fit together; raise KeysError where they do not."""
    member = Member(
        name=name,
        roles=tuple(dict.fromkeys(roles)),
        robots=tuple(dict.fromkeys(robots)),
        hosts=tuple(dict.fromkeys(hosts)),
        expires=expires,
    )
    if not member.hosts and set(HOSTING) & set(member.roles):
        member = msgspec.structs.replace(member, hosts=(name,))
    problem = _problem(member)
    if problem:
        raise KeysError(problem)
    return member


def _problem(member: Member) -> str | None:
    for what, text in [
        ("name", member.name),
        *(("robot", robot) for robot in member.robots),
        *(("host", host) for host in member.hosts),
    ]:
        if _NAME.fullmatch(text) is None:
            return f"{what} '{text}': use letters, digits, '_', '-' and '.', a letter or digit first, at most 40"
    if not member.roles:
        return f"{member.name} has no role; give it one of {', '.join(ROLES)}"
    for role in member.roles:
        if role not in ROLES:
            return f"there is no role '{role}'{did_you_mean(role, ROLES)}"
    if "robot" in member.roles and not member.robots:
        return f"{member.name}: a robot posts under its own name only; add `--robot NAME`"
    if member.hosts and not set(HOSTING) & set(member.roles):
        return f"{member.name}: a {' and '.join(member.roles)} runs no hosts; leave `--hosts` out"
    return None


def read_members(folder: Path) -> dict[str, Member]:
    """Return the members that a keeper's folder of keys lists, by name; raise KeysError where there is no sound list."""
    path = folder / MEMBERS_FILE
    listed: tuple[Member, ...] = _read(
        path, tuple[Member, ...], f"{folder} holds no keeper's keys; make them: `ski keys init {folder} --host NAME`"
    )
    members: dict[str, Member] = {}
    for member in listed:
        problem = f"'{member.name}' stands there twice" if member.name in members else _problem(member)
        if problem:
            raise KeysError(f"{path}: {problem}")
        members[member.name] = member
    return members


def read_member(folder: Path) -> Member:
    """Return whose keys a member's folder holds; raise KeysError where that cannot be told."""
    path = folder / MEMBER_FILE
    member: Member = _read(
        path, Member, f"{folder} holds no member's keys; name a folder that `ski keys add` made: .../members/NAME"
    )
    problem = _problem(member)
    if problem:
        raise KeysError(f"{path}: {problem}")
    return member


def read_keeper(folder: Path) -> KeeperKeys:
    """Return what the keeper's certificate is good for, by the folder that holds it; raise KeysError where that cannot be told."""
    path = folder / KEEPER_FILE
    keeper: KeeperKeys = _read(path, KeeperKeys, f"{path} is missing; take the whole folder that `ski keys init` made")
    return keeper


def encode(value: Any) -> bytes:
    """Return members as the JSON of their file, made to be read."""
    return msgspec.json.format(msgspec.json.encode(value), indent=2) + b"\n"


def _read(path: Path, type_: Any, missing: str) -> Any:
    try:
        with path.open("rb") as file:
            return msgspec.json.decode(file.read(MAX_LIST_BYTES), type=type_)
    except (FileNotFoundError, NotADirectoryError):
        raise KeysError(missing) from None
    except OSError as error:
        raise KeysError(f"{path} cannot be read ({error.strerror})") from None
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise KeysError(f"{path} is spoiled ({error}); take it from the machine where the keys were made") from None
