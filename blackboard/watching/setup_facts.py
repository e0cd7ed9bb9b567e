"""What `ski doctor` gathers about a setup, as plain records: findings are drawn from these alone."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Answers = Literal[
    "nobody",  # nothing listens
    "something else",  # no zenoh
    "certificates",  # it wants them, and none were shown
    "no certificates",  # it takes none, and some were shown
    "refused",  # those that were shown are not good for it
    "a router",  # and nobody answers as the keeper
    "a keeper",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class KeeperFacts:
    """What the keeper says of itself; counts are since its start."""

    version: str = ""
    journal_trouble: str = ""  # why it cannot write; empty: it can
    folder: str = ""
    refused: Mapping[str, int] = field(default_factory=dict)  # posts, by reason
    refused_example: Mapping[str, str] = field(default_factory=dict)
    rejected: Mapping[str, int] = field(default_factory=dict)  # what members may not do, by what it was
    overflowed: int = 0  # messages dropped because too many waited


@dataclass(frozen=True, slots=True, kw_only=True)
class HostFacts:
    """One host, as its status and its beats tell."""

    robot: str
    name: str
    state: str = "alive"
    version: str = ""
    machine: str = ""
    components: tuple[str, ...] = ()
    offset_s: float = 0.0  # its wall clock minus the keeper's
    round_trip_s: float = 0.0
    missed: int = 0  # envelopes that it could not have any more
    boots: int = 1  # processes of this name that are linked at once
    lacking: int = 0  # envelopes that it had sent a while ago and the keeper has not got

    @property
    def called(self) -> str:
        """Its name for people."""
        return f"host {self.name}" + (f" on {self.machine}" if self.machine else "")


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamFacts:
    """Something that goes on: a reading, or a knowledge source's activations. Stamps are on the mission's clock."""

    name: str
    count: int  # how often it has happened
    stamp_s: float  # of the last time
    woken_by: str = ""  # the kind that wakes it, of a knowledge source
    wakers_came: int = 0  # entries of that kind, while the doctor listened
    rests: bool = False  # because a rule says so


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFacts:
    """One robot's board."""

    name: str
    clock_s: float | None = None  # the mission's clock; None: not begun
    mission: str = ""  # how it stands: underway, done, given up; empty where nothing says so
    readings: tuple[StreamFacts, ...] = ()
    activations: tuple[StreamFacts, ...] = ()
    failed: Mapping[str, str] = field(default_factory=dict)  # components with what they failed of
    rule_errors: Mapping[str, str] = field(default_factory=dict)  # by rule
    unanswered: Mapping[str, float] = field(
        default_factory=dict
    )  # behaviours that do not acknowledge, for how many seconds
    given_up: Mapping[str, str] = field(
        default_factory=dict
    )  # processes that are not started again, with their last words


@dataclass(frozen=True, slots=True, kw_only=True)
class SetupFacts:
    """Everything that was found out."""

    address: str
    version: str  # of the ski that asks
    answers: Answers
    trouble: str = ""  # why the link failed, in the words of those who refused
    member: str = ""  # whose keys were shown, with their roles
    keeper: KeeperFacts | None = None
    robots: tuple[RobotFacts, ...] = ()
    hosts: tuple[HostFacts, ...] = ()
    expected: Mapping[str, str] = field(
        default_factory=dict
    )  # hosts that should run components: by the component's name, or by robot and name, `east/rules`
