"""Who posts and reads what on a board: its members, and the kinds between them."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from blackboard.kinds import LEVELLED_PANELS, LEVELS, PANELS

Role = Literal["robot", "knowledge source", "rules", "behaviour", "coordinator", "safety layer", "control", "keeper"]
ROLES: tuple[Role, ...] = (  # in the order of the data
    "robot",
    "knowledge source",
    "rules",
    "behaviour",
    "coordinator",
    "safety layer",
    "control",
    "keeper",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """One who posts or reads, with the paths of the kinds; `reads` are those that it reads without being woken by them."""

    name: str
    role: Role
    host: str = ""  # where it runs, if that is known
    woken_by: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    posts: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardGraph:
    """All members of a board, in the order of the data."""

    title: str
    members: tuple[Member, ...]

    def paths(self) -> list[str]:
        """Return the paths of all kinds that somebody posts or reads, by panel and level."""
        found = {path for one in self.members for path in (*one.woken_by, *one.reads, *one.posts)}
        return sorted(found, key=_place)

    def posters(self, path: str) -> list[str]:
        """Return who posts a kind."""
        return [one.name for one in self.members if path in one.posts]

    def woken(self, path: str) -> list[str]:
        """Return whom entries of a kind wake."""
        return [one.name for one in self.members if path in one.woken_by]

    def readers(self, path: str) -> list[str]:
        """Return who reads a kind without being woken by it."""
        return [one.name for one in self.members if path in one.reads]

    def as_dict(self) -> dict[str, Any]:
        """Return the same as plain data, for JSON."""
        return {
            "title": self.title,
            "members": {
                one.name: {
                    "role": one.role,
                    **({"host": one.host} if one.host else {}),
                    "woken_by": list(one.woken_by),
                    "reads": list(one.reads),
                    "posts": list(one.posts),
                }
                for one in self.members
            },
            "kinds": {
                path: {"posted_by": self.posters(path), "wakes": self.woken(path), "read_by": self.readers(path)}
                for path in self.paths()
            },
        }


def heading_of(path: str) -> str:
    """Return the panel of a kind's path, with its level where it has one."""
    chunks = path.split("/")
    return "/".join(chunks[: 2 if chunks[0] in LEVELLED_PANELS else 1])


def name_of(path: str) -> str:
    """Return a kind's path without panel and level."""
    return path.removeprefix(heading_of(path) + "/")


def by_role(members: Iterable[Member]) -> tuple[Member, ...]:
    """Return the members in the order of the data, those of one role as they came."""
    return tuple(sorted(members, key=lambda one: ROLES.index(one.role)))


def _place(path: str) -> tuple[int, int, str]:
    chunks = path.split("/")
    level = LEVELS.index(chunks[1]) if len(chunks) > 2 and chunks[1] in LEVELS else len(LEVELS)
    return (PANELS.index(chunks[0]) if chunks[0] in PANELS else len(PANELS), level, path)
