"""What a component is: robots, knowledge sources, behaviours, coordinators.

A component declares what it reads and posts, holds its parameters, and is called; it never blocks, sleeps, starts threads or
reads a clock. Each class names its parameters dataclass in `Params`.
"""

import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Literal, TypeVar

import numpy as np
import numpy.typing as npt

from blackboard.entry import Entry
from blackboard.errors import CheckpointError, MissionError
from blackboard.kinds import Kind
from blackboard.messages.base import Message
from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Drive, Response, Switch, Velocity
from blackboard.messages.sensing import RobotDescription

if TYPE_CHECKING:
    from blackboard.access import Access
    from blackboard.vocabulary import Vocabulary

P = TypeVar("P")
M = TypeVar("M", bound=Message)

UNNAMED = "robot"  # the name of a robot whose mission gives none: on the board it is called as its description says


WIRING = ("params", "name", "reads", "triggers", "posts", "rating", "work", "provides")  # as a mission has it, no state


@dataclass(frozen=True)
class NoParams:
    """For components that have nothing to set."""


class Component(Generic[P]):
    """Base of all components: a name, parameters, and random numbers of its own.

    `rng` is seeded from the run's seed and the component's name, so adding a component changes nobody else's numbers.
    """

    Params: ClassVar[type[Any]] = NoParams
    reads: Sequence[Kind[Any]] = ()  # what it reads beside its triggers
    derived: ClassVar[tuple[str, ...]] = ()  # attributes that follow from parameters or the board: no part of its state

    def __init__(self, params: P, *, name: str, seed: int = 0) -> None:
        self.params = params
        self.name = name
        self.rng = np.random.default_rng([seed, zlib.crc32(name.encode())])

    def state(self) -> object:
        """Return what has to outlive the process, to be pickled at once: its own attributes, unless it says otherwise."""
        apart = (*WIRING, *self.derived)
        return {name: value for name, value in vars(self).items() if name not in apart}

    def resume(self, state: object, board: "Access") -> None:
        """Go on where the process before this one was killed, on the board as it stands.

        `state` is of a while before that, None where nothing was kept. What it has posted since stands: it must number on above
        that, and post with no older stamps.
        """
        if not isinstance(state, dict):
            return
        apart = (*WIRING, *self.derived)
        missing = [name for name in vars(self) if name not in state and name not in apart]
        if missing:
            raise CheckpointError(f"what was kept has no '{missing[0]}': another version of the component wrote it")
        vars(self).update(state)


@dataclass(frozen=True)
class Trigger(Generic[M]):
    """When a knowledge source wakes: a kind, and a condition on what is posted there.

    It fires once `every` units have come since it last fired (one unit an entry, or what `count` says of its value), when
    `min_interval_s` has passed since then on the mission's clock, and when `when` holds for the newest entry.
    """

    kind: Kind[M]
    every: int = 1
    count: Callable[[M], int] | None = None
    min_interval_s: float = 0.0
    when: Callable[[Entry[M]], bool] | None = None

    @property
    def conditional(self) -> bool:
        """Say whether something other than the entry itself decides: only such triggers can let a cycle come to rest."""
        return self.every > 1 or self.min_interval_s > 0 or self.when is not None


class KnowledgeSource(Component[P], ABC):
    """Turns what stands on the board into knowledge: woken by its triggers, it reads, calls its pure core, and posts."""

    triggers: Sequence[Trigger[Any] | Kind[Any]] = ()  # a bare kind means every entry of it; may be set in __init__
    posts: Sequence[Kind[Any]] = ()
    rating: float = 0.0  # the higher goes first
    work: int = 1  # units of a cycle's budget that one activation costs

    @abstractmethod
    def activate(self, trigger: Entry[Any], board: "Access") -> None:
        """Answer one trigger; `board` reads and posts in this source's name."""

    def finish(self, board: "Access") -> None:
        """Post what is still held back, at the end of a run."""


@dataclass(frozen=True, slots=True)
class Progress:
    """How a behaviour fares with what it was asked for: `remaining_m` is how far it still has to go, where that means something."""

    outcome: Literal["none", "underway", "reached", "blocked"] = "none"
    remaining_m: float | None = None
    detail: str = ""


class Behaviour(Component[P], ABC):
    """Answers the newest readings with a response, every control cycle, while it is selected.

    A reflexive behaviour is selected from the start, a `motivated` one when a motivation asks for it; the mission file may say
    otherwise (`selected = ...`). `parameters` names what its motivation must give, in order; those after the first
    `optional` may be left out from the right.
    """

    motivated: ClassVar[bool] = False
    parameters: ClassVar[tuple[str, ...]] = ()
    optional: ClassVar[int] = 0  # so many of the last parameters may be left out

    @abstractmethod
    def respond(self, board: "Access") -> Response | None:
        """Return the response to the newest readings; None: nothing to say. What is read becomes the response's supports."""

    def select(self, parameters: tuple[float | str, ...]) -> None:
        """Begin anew, asked by a motivation with these parameters. Raises MissionError where they cannot be used."""

    def deselect(self) -> None:
        """Stop: another motivation said so."""

    def progress(self) -> Progress:
        """Say how it fares, after each answer."""
        return Progress()

    def adjusts(self) -> Mapping[str, Switch]:
        """Say which switches it puts into the lines of other behaviours, by their names, for as long as its answers go on."""
        return {}

    def done(self) -> bool:
        """Say whether the behaviour has reached its end and will not answer again unless selected anew."""
        return False


class Coordinator(Component[P], ABC):
    """Turns the behaviours' responses into one wanted velocity."""

    def switched(self, behaviour: str, response: Response, board: "Access") -> Response | None:
        """Return what of a behaviour's response goes on; None: nothing, and it inhibits nobody."""
        return response

    @abstractmethod
    def combine(self, responses: Mapping[str, Response], robot: RobotDescription, board: "Access") -> Velocity:
        """Return the wanted velocity. `responses` holds what `switched` let through of those not inhibited, by behaviour."""


@dataclass(frozen=True)
class Parts:
    """What a planner may act on: behaviours with the names of their parameters (and how many are optional), levels of the
    arbitration network, knowledge sources.
    """

    behaviours: Mapping[str, tuple[tuple[str, ...], int]]
    levels: Sequence[str]
    sources: Mapping[str, float]  # with their ratings
    vocabulary: "Vocabulary"
    owners: Mapping[str, str]  # who posts a kind, by its path


class Planner(Component[P], ABC):
    """Decides: looks at what stands on the board and sets motivations. It may read every kind.

    `note` hears of every post; `decide` is called once a cycle, after the knowledge sources.
    """

    posts: Sequence[Kind[Any]] = ()  # may be set in __init__
    acted: bool = (
        False  # since its state was last told: who keeps states does so at once, so that nothing is done twice
    )

    @abstractmethod
    def start(self, parts: Parts) -> None:
        """Get ready, before the first cycle. Raises a SkiError where it asks for what is not there."""

    @abstractmethod
    def note(self, entry: Entry[Any]) -> None:
        """Take note of a post."""

    @abstractmethod
    def decide(self, board: "Access") -> None:
        """Look at what changed, and act."""

    def close(self) -> None:
        """Let go of what it holds."""


class SafetyLayer(Component[P], ABC):
    """Stands between every wanted velocity and the wheels; no mission can leave it out."""

    @abstractmethod
    def limit(self, wanted: Velocity | None, board: "Access") -> Drive:
        """Return what may go to the wheels; `wanted` is None when nobody commands."""


@dataclass(frozen=True, slots=True)
class Reading(Generic[M]):
    """One thing that a robot's sensors said, taken at `stamp_s`."""

    kind: Kind[M]
    stamp_s: float
    value: M


@dataclass(frozen=True)
class WorldTruth:
    """What a simulated world really is: `solid` is the shapely geometry of all that stands still and is no floor, `floor` that
    of the floor which lies inside the world (solid things not taken out). Map frame, metres.
    """

    solid: Any
    floor: Any


class Robot(Component[P], ABC):
    """Where readings come from and commands go: a simulated robot, a recording, or a real one."""

    provides: Sequence[Kind[Any]] = ()  # kinds of its readings

    @property
    @abstractmethod
    def description(self) -> RobotDescription:
        """Body and sensors; known from construction on."""

    @property
    def start_s(self) -> float:
        """The mission's clock when the run begins."""
        return 0.0

    @property
    def end_s(self) -> float | None:
        """The stamp at which nothing more comes (the end of a recording); None: it goes on for ever."""
        return None

    @property
    def moves(self) -> bool:
        """Say whether it obeys commands; a recording does not."""
        return True

    @abstractmethod
    def advance(self, until_s: float) -> Iterator[Reading[Any]]:
        """Let time pass until `until_s` and yield the readings that came meanwhile, stamps never running back within a kind."""

    def join(self, other: "Robot[Any]") -> None:
        """Share another's world from now on, before anything has run; time then passes for all of its robots at once.

        Raises MissionError, beginning with the parameter that is wrong where it is one, where that cannot be.
        """
        raise MissionError(f"{type(self).__name__} cannot share a world with another robot; leave one of them out")

    def drive(self, command: Drive) -> None:
        """Take what goes to the wheels from now on."""

    def close(self) -> None:
        """Let go of files and connections; nothing is asked of it afterwards."""

    def true_pose(self) -> Pose | None:
        """Return where the robot really is, map frame, for scores; None where nobody knows. No component may ask."""
        return None

    def truth(self) -> WorldTruth | None:
        """Return the world as it is, for scores; None where nobody knows."""
        return None

    def drawn_lines(self) -> npt.NDArray[np.float64] | None:
        """Return the lines that others drew for the same map, (n, 4) by their ends, m; None where nobody did. Only for scores."""
        return None

    def summary(self) -> dict[str, float | int | str]:
        """Return figures for the table at the end of a run (distance driven, collisions, lines skipped, ...)."""
        return {}
