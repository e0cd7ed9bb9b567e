"""What a run knows when it ends: all that the writers of this package need."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import numpy.typing as npt

from blackboard.component import WorldTruth
from blackboard.entry import Entry
from blackboard.messages.sensing import RobotDescription
from blackboard.messages.symbols import Corner, Target
from blackboard.messages.world import Line

Trajectory = npt.NDArray[np.float64]  # (n, 4): stamp_s, x_m, y_m, heading_rad, map frame


class GridView(Protocol):
    """A grid to look at: `blackboard.grid.Grid`, or the part of one that is known. Row 0 lies at y_min_m."""

    @property
    def cells(self) -> npt.NDArray[np.uint8]:
        """Bytes (rows, columns): 0 empty, 128 unknown, 255 occupied."""

    @property
    def cell_m(self) -> float:
        """Side of a cell."""

    @property
    def x_min_m(self) -> float:
        """Left edge of column 0, map frame."""

    @property
    def y_min_m(self) -> float:
        """Lower edge of row 0, map frame."""


@dataclass(frozen=True, kw_only=True)
class RunResult:
    """The outcome of a run, or of as much of it as there was before it was stopped.

    What nobody knows is None or empty: a recording has no truth, a mission without a grid source no grid.
    """

    mission: str
    robot: RobotDescription
    trajectory: Trajectory
    grid: GridView | None = None
    points: npt.NDArray[np.float64] | None = None  # (n, 2): shown where there is no grid
    lines: Sequence[Entry[Line]] = ()
    corners: Sequence[Corner] = ()
    targets: Sequence[Target] = ()
    true_trajectory: Trajectory | None = None
    truth: WorldTruth | None = None
    table: Mapping[str, float | int | str] = field(default_factory=dict)


def segments(lines: Sequence[Line]) -> npt.NDArray[np.float64]:
    """Return the lines' ends as (n, 4): x and y of the start, x and y of the end, m."""
    ends = [(line.start.x_m, line.start.y_m, line.end.x_m, line.end.y_m) for line in lines]
    return np.array(ends, dtype=np.float64).reshape(-1, 4)


def driven_m(trajectory: Trajectory) -> float:
    """Return the length of the path through all poses."""
    return float(np.hypot(np.diff(trajectory[:, 1]), np.diff(trajectory[:, 2])).sum())
