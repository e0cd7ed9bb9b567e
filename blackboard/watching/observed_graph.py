"""The graph of a board as it was seen at work: who posted what is told by the entries' sources, who read what by their supports.

What somebody read and posted nothing from is not seen; who was woken by what is told by the activations.
"""

from collections.abc import Iterable, Mapping
from typing import Protocol

import msgspec

from blackboard.entry import Support
from blackboard.errors import BoardError
from blackboard.kinds import ACTIVATION, BEHAVIOUR, DRIVE, FIRING, HOST, LEVELLED_PANELS, RESPONSE, RULES, VELOCITY
from blackboard.messages.control import Activation
from blackboard.watching.board_graph import BoardGraph, Member, Role, by_role

TELLING: tuple[tuple[str, Role], ...] = (  # what somebody posts tells the role, the first that holds
    (DRIVE.path, "safety layer"),
    (VELOCITY.path, "coordinator"),
    (RESPONSE.path, "behaviour"),
    (BEHAVIOUR.path, "behaviour"),
    (FIRING.path, "rules"),
    (RULES.path, "rules"),
    (ACTIVATION.path, "control"),
    (HOST.path, "keeper"),
)


class Seen(Protocol):
    """What is looked at of an entry."""

    @property
    def key(self) -> str: ...
    @property
    def source(self) -> str: ...
    @property
    def supports(self) -> tuple[Support, ...]: ...
    @property
    def value(self) -> msgspec.Raw: ...


def observed_graph(title: str, entries: Iterable[Seen], hosts: Mapping[str, str] | None = None) -> BoardGraph:
    """Return who posted, read and was woken by what; `hosts` tells where each component runs, where that is known.

    Raises BoardError where there are no entries.
    """
    posts: dict[str, dict[str, None]] = {}
    reads: dict[str, dict[str, None]] = {}
    woken: dict[str, dict[str, None]] = {}
    for entry in entries:
        path = path_of(entry.key)
        posts.setdefault(entry.source, {})[path] = None
        for support in entry.supports:
            reads.setdefault(entry.source, {})[path_of(support.key)] = None
        if path == ACTIVATION.path:
            try:
                activation = msgspec.json.decode(entry.value, type=Activation)
            except (msgspec.DecodeError, UnicodeDecodeError):
                continue
            woken.setdefault(activation.source, {})[path_of(activation.trigger_key)] = None
    if not posts:
        raise BoardError(f"{title}: nothing stands there to draw a graph of")
    members = [
        _member(name, posts.get(name, {}), reads.get(name, {}), woken.get(name, {}), (hosts or {}).get(name, ""))
        for name in dict.fromkeys([*posts, *woken])
    ]
    return BoardGraph(title=title, members=by_role(members))


def path_of(key: str) -> str:
    """Return the path of a key's kind."""
    chunks = key.split("/")[2:]
    return "/".join(chunks[: 3 if chunks and chunks[0] in LEVELLED_PANELS else 2])


def _member(
    name: str, posts: Mapping[str, None], reads: Mapping[str, None], woken: Mapping[str, None], host: str
) -> Member:
    role: Role = next((role for path, role in TELLING if path in posts), "knowledge source")
    if role == "knowledge source" and any(path.startswith("observations/signal/") for path in posts):
        role = "robot"
    others = (
        () if role == "control" else tuple(path for path in reads if path not in woken)
    )  # it names others' triggers
    return Member(name=name, role=role, host=host, woken_by=tuple(woken), reads=others, posts=tuple(posts))
