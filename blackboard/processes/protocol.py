"""What manager and executors say to each other, as JSON under `ski/@agents/<machine>/...` and `ski/@manager/...`.

An order is the whole of what an executor is to run; it starts what is missing and stops the rest, so that an order that comes
twice does nothing twice. It names a mission and a host, never a command: what is run is always `ski host`.
"""

import re
import socket
from typing import Annotated, Literal, TypeVar

import msgspec
from msgspec import Meta, Struct

from blackboard.errors import LinkError
from blackboard.messages.base import Name, Text

State = Literal["starting", "running", "hung", "waiting", "stopping", "stopped", "failed", "done"]
AGENTS = "ski/@agents"
MANAGER_BEATS = "ski/@manager/*/beat"
KEEPER = "keeper"  # the name of the keeper's process; no host may have it
MAX_BYTES = 1_000_000

T = TypeVar("T")


class HostOrder(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One host: which part of which mission, and when it is to be started again (`blackboard.placement.HostParams`)."""

    name: Name
    robot: Name
    mission: Annotated[str, Meta(min_length=1, max_length=4096)]  # a shipped mission, or a file on that machine
    seed: Annotated[int, Meta(ge=0)] = 0
    pace: Annotated[float, Meta(gt=0, le=1000)] = 1.0
    settings: Annotated[tuple[Text, ...], Meta(max_length=1000)] = ()  # component.parameter=value
    restart: Literal["always", "on-failure", "never"] = "on-failure"
    restarts: Annotated[int, Meta(ge=0, le=1000)] = 5
    within_s: Annotated[float, Meta(gt=0, le=86_400)] = 60.0
    hang_s: Annotated[float, Meta(ge=1.0, le=3600)] = 5.0
    stop_s: Annotated[float, Meta(ge=0, le=600)] = 5.0


class Order(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All that an executor is to run for one manager; an empty one lets it go. `keeper_folder`: it runs the board keeper too,
    with the kinds of `keeper_mission` where those of every mission are not enough.
    """

    manager: Name
    hosts: Annotated[tuple[HostOrder, ...], Meta(max_length=1000)] = ()
    keeper_folder: str | None = None
    keeper_mission: str = ""
    prepare: str = ""  # a mission to be loaded already, whose hosts will be ordered soon


class ProcessReport(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How one process fares. `code` is the exit code of its last end, `signal` the signal that ended it."""

    name: Name
    state: State
    machine: Name
    robot: str = ""
    pid: int = 0
    restarts: int = 0
    age_s: float = 0.0
    cpu_s: float | None = None
    silent_s: float | None = None  # since its last heartbeat; None: none was heard yet
    code: int | None = None
    signal: int | None = None
    last_line: str = ""


class AgentReport(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How an executor and all that it runs fare; `manager` is empty while it waits for one."""

    machine: Name
    boot: Name
    pid: int
    version: str
    manager: str = ""
    why: str = ""  # it let go of what it ran
    processes: tuple[ProcessReport, ...] = ()


class ManagerBeat(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a manager says twice a second: that it is there."""

    manager: Name
    mission: str
    robot: str
    machine: str
    pid: int


def encode(message: Struct) -> bytes:
    """Return a message as JSON."""
    return msgspec.json.encode(message)


def decode(data: bytes, type_: type[T]) -> T:
    """Return a message that came from outside; raise LinkError for what is none."""
    if len(data) > MAX_BYTES:
        raise LinkError(f"a message of {len(data)} bytes between manager and agents: the limit is {MAX_BYTES}")
    try:
        return msgspec.json.decode(data, type=type_)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise LinkError(f"no {type_.__name__}: {error}") from None


def this_machine() -> str:
    """Return this machine's name, as part of a key."""
    name = re.sub(r"[^A-Za-z0-9_.-]", "-", socket.gethostname().split(".")[0])
    return name or "machine"
