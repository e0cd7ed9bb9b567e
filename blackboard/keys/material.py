"""The keys that a process shows: its folder checked before zenoh looks at it, so that what is wrong is said in one line."""

import datetime
from dataclasses import dataclass
from pathlib import Path

from blackboard.errors import KeysError
from blackboard.keys.members import MEMBERS_FILE, Member, read_keeper, read_member, read_members


@dataclass(frozen=True, slots=True)
class Material:
    """The files of one side of a link."""

    authority: Path
    certificate: Path
    key: Path


def member_material(folder: Path, now: datetime.datetime) -> tuple[Material, Member]:
    """Return a member's files and who it is; raise KeysError where they are missing, open to others or expired."""
    if (folder / MEMBERS_FILE).exists():
        raise KeysError(f"{folder} holds the keeper's keys; name the folder of a member: {folder}/members/NAME")
    member = read_member(folder)
    if member.expires <= now:
        raise KeysError(
            f"the keys of {member.name} expired on {member.expires:%Y-%m-%d}; `ski keys renew DIR {member.name}`"
        )
    return _material(folder), member


def keeper_material(folder: Path, now: datetime.datetime) -> tuple[Material, list[Member]]:
    """Return the keeper's files and its members; raise KeysError where something is missing, open to others or expired."""
    members = list(read_members(folder).values())
    keeper = read_keeper(folder / "keeper")
    if keeper.expires <= now:
        raise KeysError(f"the keeper's keys expired on {keeper.expires:%Y-%m-%d}; `ski keys renew {folder} keeper`")
    return _material(folder / "keeper"), members


def _material(folder: Path) -> Material:
    files = Material(folder / "ca.pem", folder / "cert.pem", folder / "key.pem")
    for path in (files.authority, files.certificate, files.key):
        try:
            with path.open("rb") as file:
                start = file.read(10)
        except OSError as error:
            raise KeysError(f"{path} cannot be read ({error.strerror}); copy the whole folder again") from None
        if start != b"-----BEGIN":
            raise KeysError(f"{path} is no PEM file; copy the whole folder again")
    if files.key.stat().st_mode & 0o077:
        raise KeysError(f"{files.key} can be read by others; `chmod 600 {files.key}`")
    return files
