"""What a finding of `ski doctor` is, and from where on something counts as wrong."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass

from blackboard.parameters import require
from blackboard.watching.setup_facts import SetupFacts
from blackboard.watching.summary import printable


@dataclass(frozen=True, slots=True, kw_only=True)
class DoctorParams:
    """From where on something counts as wrong."""

    clock_limit_s: float = 0.5  # stamps of recordings and logs of two machines can no longer be laid side by side
    silent_s: float = 3.0  # so long nothing at least,
    silent_intervals: float = 20.0  # and so many times as long as it took from one to the next until then
    silent_after: int = 20  # one that has happened less often has no rhythm yet

    def __post_init__(self) -> None:
        require(0 < self.clock_limit_s <= 3600, "clock_limit_s", self.clock_limit_s, "(0, 3600] seconds")
        require(0 < self.silent_s <= 3600, "silent_s", self.silent_s, "(0, 3600] seconds")
        require(self.silent_intervals >= 1, "silent_intervals", self.silent_intervals, "1 and more")
        require(self.silent_after >= 2, "silent_after", self.silent_after, "2 and more")


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing that is wrong, each in one line: what it is, and what to do."""

    about: str  # the same word for the same kind of trouble, for programs
    what: str
    do: str

    def as_dict(self) -> dict[str, str]:
        """Return the same as plain data, for JSON."""
        return {name: printable(text) for name, text in asdict(self).items()}


Rule = Callable[[SetupFacts, DoctorParams], Iterator[Finding]]


def many(count: int, what: str) -> str:
    """Return how many of what, in words."""
    return f"1 {what}" if count == 1 else f"{count} {what[:-1]}ies" if what.endswith("y") else f"{count} {what}s"


def listed(names: tuple[str, ...], most: int = 4) -> str:
    """Return the first names, and how many more there are."""
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"
