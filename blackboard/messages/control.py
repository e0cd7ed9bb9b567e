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


class Focus(Message, frozen=True, kw_only=True):
    """What a rule says of a knowledge source, by its id: another rating, or that it is to rest (Bou-Ghannam 1992, section 4.4)."""

    rating: Rating
    enabled: bool = True


class Fact(Message, frozen=True, kw_only=True):
    """A fact that a rule asserted into working memory, by its index there; what follows from entries stands on their own keys."""

    relation: Name
    fact: Text


class Firing(Message, frozen=True, kw_only=True):
    """A rule that fired, by its name: the facts that matched its conditions ("" for one that no single fact matches), what it
    did on the board, and what it printed. Its supports are the entries behind those facts.
    """

    rule: Name
    number: Count
    facts: Annotated[tuple[Text, ...], Meta(max_length=100)] = ()
    did: Annotated[tuple[Text, ...], Meta(max_length=1000)] = ()
    said: Text = ""
    error: Text = ""


class RuleError(Message, frozen=True, kw_only=True):
    """What went wrong with a rule, by its name: its actions raised, or it fired without end."""

    rule: Name
    text: Text


class CommunicationError(Message, frozen=True, kw_only=True):
    """A behaviour, by its id, that has not acknowledged the motivation of this number in time (Bou-Ghannam 1992, section 5.1)."""

    number: Count
    waited_s: Duration


class RuleFile(Message, frozen=True, kw_only=True):
    """A rule file as it was read."""

    name: Name
    text: Annotated[str, Meta(max_length=1_000_000)]


class RuleFiles(Message, frozen=True, kw_only=True):
    """The rules that decide. Where a changed file was refused, `refused` says why and the files before it stay in force."""

    engine: Name
    files: Annotated[tuple[RuleFile, ...], Meta(max_length=1000)]
    refused: Text = ""
