"""Speaks against lines of the model that the grid does not bear out, and against new ones where it is in doubt what stands there.

Triggered by  hypotheses/feature/grid                  GridTile: at most once in an interval
Reads         hypotheses/feature/model_line, hypotheses/symbol/new_area_visited, hypotheses/symbol/change
Posts         nothing of its own: endorsements of what it reads, about "grid" and about "change"

So the lines of people and of things that were moved do not enter the model for good: match/merge takes back what is denied. Source:
Bou-Ghannam 1992, sections 2.6 and 3.3; grid and lines bear each other out as in section 5.2.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from blackboard.access import Access
from blackboard.component import KnowledgeSource, Trigger
from blackboard.entry import Entry
from blackboard.grid import EMPTY_MAX, Grid
from blackboard.kinds import CHANGE, GRID, MODEL_LINE, NEW_AREA_VISITED
from blackboard.messages.conflicts import Change
from blackboard.messages.model import ModelLine
from blackboard.parameters import require
from knowledge_sources.grid_mirror import GridMirror
from knowledge_sources.standing_hypotheses import Reason, give

EMPTY = Reason("the grid is empty along it", "grid", "against", "strong")


@dataclass(frozen=True, slots=True, kw_only=True)
class LineDoubtsParams:
    """How often, and what counts as empty."""

    interval_s: float = 2.0
    beside_m: float = (
        0.15  # to either side of a line: a wall is blurred by two or three cells, and the pose errs by as much
    )
    empty_fraction: float = 0.8  # of a line, along which the grid is empty: its ends are unsure
    change_fraction: float = 0.5  # of a new line, that lies where a change is in doubt

    def __post_init__(self) -> None:
        require(0.0 <= self.interval_s <= 3600.0, "interval_s", self.interval_s, "[0, 3600] seconds")
        require(0.0 <= self.beside_m <= 1.0, "beside_m", self.beside_m, "[0, 1] metres")
        for name in ("empty_fraction", "change_fraction"):
            require(0.0 < getattr(self, name) <= 1.0, name, getattr(self, name), "(0, 1]")


def empty_along(line: ModelLine, grid: Grid, beside_m: float) -> float:
    """Return along which share of a line all cells within `beside_m` of it are empty."""
    places, (nx, ny) = _places(line, grid.cell_m)
    steps = round(beside_m / grid.cell_m)
    aside = np.arange(-steps, steps + 1) * grid.cell_m
    beside = places[:, None, :] + aside[None, :, None] * np.array([nx, ny])
    empty = grid.values_at(beside.reshape(-1, 2)).reshape(beside.shape[:2]) <= EMPTY_MAX
    return float(empty.all(axis=1).mean())


def share_within(line: ModelLine, change: Change, beside_m: float) -> float:
    """Return which share of a line lies in the box of a change, or within `beside_m` of it."""
    places, _ = _places(line, 0.05)
    low_x, low_y, high_x, high_y = change.extent()
    inside = (places[:, 0] >= low_x - beside_m) & (places[:, 0] <= high_x + beside_m)
    inside &= (places[:, 1] >= low_y - beside_m) & (places[:, 1] <= high_y + beside_m)
    return float(inside.mean())


def _places(line: ModelLine, step_m: float) -> tuple[np.ndarray[Any, np.dtype[np.float64]], tuple[float, float]]:
    """Return places (n, 2) a step apart along a line, and the direction across it."""
    start, end = np.array([line.start.x_m, line.start.y_m]), np.array([line.end.x_m, line.end.y_m])
    length = max(float(np.hypot(*(end - start))), 1e-9)
    count = max(round(length / step_m), 1)
    places = start + ((np.arange(count) + 0.5) / count)[:, None] * (end - start)
    dx, dy = ((end - start) / length).tolist()
    return places, (-dy, dx)


class LineDoubts(KnowledgeSource[LineDoubtsParams]):
    """Says of each line what speaks against it, and takes it back when that does not hold any more."""

    Params = LineDoubtsParams
    reads = (MODEL_LINE, NEW_AREA_VISITED, CHANGE)
    rating = 3.0

    def __init__(self, params: LineDoubtsParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self.triggers = (Trigger(kind=GRID, min_interval_s=params.interval_s),)
        self._grid = GridMirror()

    def activate(self, trigger: Entry[Any], board: Access) -> None:
        grid = self._grid.look(board)
        if grid is None:
            return
        changes = [e for e in board.entries(CHANGE) if e.value.change == "appeared" and not e.value.accepted]
        for entry in board.entries(MODEL_LINE):
            give(board, entry, self._of_grid(entry.value, grid))
        for new in board.entries(NEW_AREA_VISITED):
            give(board, new, [*self._of_grid(new.value.line, grid), *self._of_changes(new.value.line, changes)])

    def _of_grid(self, line: ModelLine, grid: Grid) -> list[Reason]:
        return [EMPTY] if empty_along(line, grid, self.params.beside_m) >= self.params.empty_fraction else []

    def _of_changes(self, line: ModelLine, changes: Sequence[Entry[Change]]) -> list[Reason]:
        for change in changes:
            if share_within(line, change.value, self.params.beside_m) >= self.params.change_fraction:
                return [Reason(f"change {change.id}, where it lies, is in doubt", "change", "against")]
        return []
