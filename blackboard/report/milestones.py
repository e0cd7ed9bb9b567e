"""Moments of a run worth a picture of their own, after Bou-Ghannam 1992, Figures 6.1 to 6.9.

Early grids, the first and second set of lines with the points they came from, which behaviour led when, and the places that
the robot was asked to go to.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from blackboard.messages.geometry import Point
from blackboard.report.result import GridView

Points = npt.NDArray[np.float64]  # (n, 2) m, map frame
Ends = npt.NDArray[np.float64]  # (n, 4) m, map frame: x and y of the start, x and y of the end


@dataclass(frozen=True, kw_only=True)
class GridStage:
    """The grid as it stood after so many full scans."""

    stamp_s: float
    scans: int
    grid: GridView


@dataclass(frozen=True, kw_only=True)
class LineStage:
    """Lines that stood at `stamp_s`, from points gathered since `from_s`; `points` counts them."""

    from_s: float
    stamp_s: float
    ends: Ends
    points: int = 0


@dataclass(frozen=True, kw_only=True)
class Lead:
    """From `stamp_s` on, this behaviour leads; none where `behaviour` is empty."""

    stamp_s: float
    behaviour: str


@dataclass(frozen=True, kw_only=True)
class Visit:
    """A place that a behaviour was asked to go to, and what became of it."""

    place: Point
    behaviour: str
    stamp_s: float
    outcome: Literal["underway", "reached", "blocked"] = "underway"


@dataclass(frozen=True, kw_only=True)
class Milestones:
    """What was kept on the way; what a mission has no part for is None or empty."""

    scans: Sequence[GridStage] = ()  # early ones, then the one from which the first set of points was taken
    raw: Points | None = None  # of the first set
    filtered: Points | None = None
    first: LineStage | None = None
    second: LineStage | None = None
    merged: LineStage | None = None
    behaviours: Sequence[str] = ()  # in the order of the mission
    leads: Sequence[Lead] = field(default_factory=tuple)
    visits: Sequence[Visit] = ()
