"""Processes and machines: how hosts and processes fare, and what only a simulation knows."""

from typing import Annotated, Literal

from msgspec import Meta

from blackboard.messages.base import Count, Duration, Message, Name, Seconds, Text


class HostStatus(Message, frozen=True, kw_only=True):
    """How a host fares, by its name: `dead` when its link ended without a word, `hung` when it is linked but its loop is silent,
    `stopped` when it took its leave. `offset_s` is how far its own clock (wall time) is ahead of the keeper's.
    """

    state: Literal["alive", "hung", "dead", "stopped"]
    boot: Name
    machine: Annotated[str, Meta(max_length=200)] = ""
    pid: Count = 0
    version: Annotated[str, Meta(max_length=200)] = ""
    components: Annotated[tuple[Name, ...], Meta(max_length=1000)] = ()
    offset_s: Seconds = 0.0
    round_trip_s: Duration = 0.0
    detail: Text = ""


class RobotSummary(Message, frozen=True, kw_only=True):
    """A robot's own figures for the table at the end of a run, JSON: distance driven, collisions, ..."""

    figures: Annotated[str, Meta(max_length=100_000)]


class HostBeat(Message, frozen=True, kw_only=True):
    """What a host says of itself several times a second, from its own loop; no entry of the board.

    `lanes` has the number of the last envelope sent in each lane; `missed` counts envelopes that could not be had any more.
    """

    boot: Name
    pid: Count
    machine: Annotated[str, Meta(max_length=200)]
    version: Annotated[str, Meta(max_length=200)]
    components: Annotated[tuple[Name, ...], Meta(max_length=1000)]
    lanes: dict[str, Count]
    offset_s: Seconds = 0.0
    round_trip_s: Duration = 0.0
    missed: Count = 0
    leaving: bool = False


class CycleBeat(Message, frozen=True, kw_only=True):
    """The robot's host has posted all readings of a cycle: behaviours may answer."""

    number: Count
