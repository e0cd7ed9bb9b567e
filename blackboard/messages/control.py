"""The control of knowledge sources: agenda, activations, and how each component fares."""

from typing import Annotated, Literal

from msgspec import Meta

from blackboard.messages.base import Count, Duration, Message, Name, Text

Rating = Annotated[float, Meta(ge=-1e6, le=1e6)]


class Waiting(Message, frozen=True, kw_only=True):
    """The activation records of one knowledge source that wait on the agenda."""

    source: Name
    rating: Rating
    records: Count
    trigger_key: Name


class Agenda(Message, frozen=True, kw_only=True):
    """What waits at the end of a cycle, highest rating first; `dropped` counts records lost to a full agenda since the start."""

    waiting: Annotated[tuple[Waiting, ...], Meta(max_length=1000)]
    dropped: Count = 0


class Activation(Message, frozen=True, kw_only=True):
    """A knowledge source activation record (KSAR) that has run."""

    source: Name
    trigger_key: Name
    trigger_revision: Count
    rating: Rating
    work: Count
    outcome: Literal["done", "failed"]


class ActivationTime(Message, frozen=True, kw_only=True):
    """Measured time of a knowledge source: differs from run to run, so it is kept out of recordings."""

    activations: Count
    total_s: Duration
    longest_s: Duration


class ComponentStatus(Message, frozen=True, kw_only=True):
    """Whether a component works; a failed one is shown with what it was working on."""

    state: Literal["running", "failed"]
    error: Text = ""
    trigger_key: Text = ""
    trigger_revision: Count = 0
