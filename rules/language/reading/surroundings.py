"""What a form may refer to: the templates, functions and globals of all files together."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import Enum

from rules.language.errors import RuleError
from rules.language.syntax import Position, Template


class Place(Enum):
    """Where an expression stands; what it may call depends on it."""

    CONDITION = "a condition"
    ACTION = "the right-hand side of a rule"
    FUNCTION = "a deffunction"
    START = "a value that is set at the start"


@dataclass(slots=True)
class Surroundings:
    """Names with what is known of them, and the faults found so far.

    `shadows` are relations that rule files use as ordered facts though the board has a template of this name: the file goes
    first, and the template is not to be had then.
    """

    templates: dict[str, Template] = field(default_factory=dict)
    functions: dict[str, tuple[int, int | None]] = field(default_factory=dict)
    globals: dict[str, Position] = field(default_factory=dict)
    shadows: Mapping[str, Position] = field(default_factory=dict)
    faults: list[RuleError] = field(default_factory=list)
    used: set[str] = field(default_factory=set)

    @contextmanager
    def collecting(self) -> Iterator[None]:
        """Keep the fault that ends this block, and go on behind it."""
        try:
            yield
        except RuleError as fault:
            self.faults.append(fault)
