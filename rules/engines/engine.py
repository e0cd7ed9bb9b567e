"""What an engine is: working memory, agenda and the firing of rules, the same for experta and for CLIPS.

Semantics are those of CLIPS 6.42 with the depth strategy: activations by salience, then the newest first; of those that one change
of working memory brings, as a rule the rule that is defined first. A fact that stands already is not asserted again.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from rules.language.errors import RuleError
from rules.language.syntax import Program
from rules.language.values import FactValue, Value

External = Callable[..., Value | None]  # called with the values of its arguments; None returns nil

FIRINGS_LIMIT = 10_000  # of one `run`


@dataclass(frozen=True, slots=True)
class Activation:
    """A rule and the facts that match its conditions: their indices, None for a condition that matches no one fact."""

    rule: str
    facts: tuple[int | None, ...]
    salience: int = 0


@dataclass(frozen=True, slots=True)
class FactChange:
    """A fact that a firing asserted or retracted."""

    index: int
    fact: FactValue
    asserted: bool


@dataclass(frozen=True, slots=True)
class Firing:
    """A rule that has fired, what it changed in working memory, and what it printed. `error`: what its actions raised.

    `changes` are what has gone, by index, then what has come; what the same firing undid is not among them.
    """

    activation: Activation
    changes: tuple[FactChange, ...] = ()
    printed: str = ""
    error: str | None = None


def told(error: Exception) -> str:
    """Return what an action raised as one line: what is no fault of a rule is told with its kind."""
    return str(error) if isinstance(error, RuleError) else f"{type(error).__name__}: {error}"


class Engine(ABC):
    """Runs one program. Raises RuleError (rules.language.errors) where the program cannot be compiled."""

    def __init__(self, program: Program, externals: Mapping[str, External] | None = None) -> None:
        self.program = program
        self.externals = dict(externals or {})

    @abstractmethod
    def reset(self) -> None:
        """Empty working memory, set the globals anew, and assert the deffacts."""

    @abstractmethod
    def assert_fact(self, fact: FactValue) -> int | None:
        """Put a fact into working memory and return its index; None where the same stands already."""

    @abstractmethod
    def retract(self, index: int) -> None:
        """Take a fact out of working memory; KeyError where there is none of this index."""

    @abstractmethod
    def facts(self) -> Mapping[int, FactValue]:
        """Return what stands in working memory by index, in the order of assertion."""

    @abstractmethod
    def agenda(self) -> Sequence[Activation]:
        """Return the activations that wait, the next to fire first."""

    @abstractmethod
    def fact(self, index: int) -> FactValue | None:
        """Return the fact of this index; None where there is none. Unlike `facts` it costs the same however many stand."""

    @abstractmethod
    def waiting(self) -> Activation | None:
        """Return the next activation to fire, None where none waits: the first of `agenda`, without reading the others."""

    @abstractmethod
    def drop(self, activation: Activation) -> None:
        """Take an activation off the agenda without firing it; KeyError where it is not there."""

    @abstractmethod
    def initial_facts(self) -> Sequence[FactValue]:
        """Return the facts of the program's deffacts, in order."""

    @abstractmethod
    def fire(self, activation: Activation | None = None) -> Firing | None:
        """Fire the next activation, or this one of the agenda; None where nothing waits or a rule said halt.

        What an action raises ends this firing, and is told in its `error`; nothing else is lost.
        """

    @property
    @abstractmethod
    def halted(self) -> bool:
        """Say whether a rule called `halt`; `resume` takes it back."""

    @abstractmethod
    def resume(self) -> None:
        """Let rules fire again after a halt."""

    @abstractmethod
    def globals(self) -> Mapping[str, Value]:
        """Return the globals' values by name."""

    @abstractmethod
    def set_global(self, name: str, value: Value) -> None:
        """Set a global; KeyError where the program has none of this name."""

    def take_faults(self) -> Sequence[RuleError]:
        """Return what of the conditions could not be evaluated since the last call, each once; it did not match."""
        return ()

    @abstractmethod
    def close(self) -> None:
        """Let go of what the engine holds outside Python."""
