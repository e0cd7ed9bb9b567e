"""What several robots of one world know together: their maps laid on each other, and the figures of all of them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from blackboard.errors import OutputError
from blackboard.grid import EMPTY_MAX, OCCUPIED_MIN, UNKNOWN, KnownPart
from blackboard.report.result import GridView, RunResult
from blackboard.report.scores import score_table
from blackboard.report.table import Value, describe
from blackboard.report.view import known_part

SUMS = ("path_m", "distance_m", "collisions", "touched_by_others", "posts")
CELL_SLACK = 1e-9


def united(grids: Sequence[GridView]) -> KnownPart | None:
    """Return the maps laid on each other as they lie: of each cell what is surest, of equally sure ones the first.

    None when nothing is known. Raises OutputError where their cells are not of one size.
    """
    parts = [part for part in (known_part(grid) for grid in grids) if part is not None]
    if not parts:
        return None
    cell_m = parts[0].cell_m
    if any(abs(part.cell_m - cell_m) > CELL_SLACK for part in parts):
        raise OutputError("the maps of the robots have cells of different sizes; give them one cell_m")
    places = [(round(part.x_min_m / cell_m), round(part.y_min_m / cell_m), *part.cells.shape) for part in parts]
    column, row = min(place[0] for place in places), min(place[1] for place in places)
    last_column, last_row = max(x + width for x, _, _, width in places), max(y + height for _, y, height, _ in places)
    cells = np.full((last_row - row, last_column - column), UNKNOWN, np.uint8)
    for part, (x, y, height, width) in zip(parts, places, strict=True):
        here = cells[y - row : y - row + height, x - column : x - column + width]
        surer = np.abs(part.cells.astype(int) - UNKNOWN) > np.abs(here.astype(int) - UNKNOWN)
        here[surer] = part.cells[surer]
    return KnownPart(cells, column * cell_m, row * cell_m, cell_m)


def disagreement(one: GridView, other: GridView) -> float | None:
    """Return the fraction of the cells that both maps decided, and decided differently; None where there is no such cell."""
    a, b = known_part(one), known_part(other)
    if a is None or b is None:
        return None
    cell_m = a.cell_m
    shift_x, shift_y = round((b.x_min_m - a.x_min_m) / cell_m), round((b.y_min_m - a.y_min_m) / cell_m)
    x0, x1 = max(0, shift_x), min(a.cells.shape[1], shift_x + b.cells.shape[1])
    y0, y1 = max(0, shift_y), min(a.cells.shape[0], shift_y + b.cells.shape[0])
    if x0 >= x1 or y0 >= y1:
        return None
    mine = a.cells[y0:y1, x0:x1]
    theirs = b.cells[y0 - shift_y : y1 - shift_y, x0 - shift_x : x1 - shift_x]
    full, empty = mine >= OCCUPIED_MIN, mine <= EMPTY_MAX
    full_too, empty_too = theirs >= OCCUPIED_MIN, theirs <= EMPTY_MAX
    both = (full | empty) & (full_too | empty_too)
    return float((both & (full != full_too)).sum() / both.sum()) if both.any() else None


def team_table(results: Mapping[str, RunResult]) -> dict[str, Value]:
    """Return the figures of all robots together: sums, and how good their maps are laid on each other."""
    runs = list(results.values())
    table: dict[str, Value] = {"robots": ", ".join(results), "time_s": max(float(r.table["time_s"]) for r in runs)}
    for name in SUMS:
        if all(name in run.table for run in runs):
            table[name] = sum(run.table[name] for run in runs)  # type: ignore[misc]
    if all("met_robots" in run.table for run in runs):
        table["met_each_other"] = (
            sum(int(run.table["met_robots"]) for run in runs) // 2
        )  # each meeting is one of two robots
    grids = [run.grid for run in runs if run.grid is not None]
    together = replace(runs[0], grid=united(grids), lines=())
    scores = score_table(together)
    for name in ("grid_right_fraction", "reachable_decided_fraction"):
        if name in scores:
            table[name] = scores[name]
    differ = disagreement(grids[0], grids[1]) if len(grids) == 2 else None
    return table | ({} if differ is None else {"maps_differ_fraction": differ})


def side_by_side(tables: Mapping[str, Mapping[str, Value]], title: str) -> Table:
    """Return the tables of the robots as one, a column each."""
    shown = Table(title=Text(title), title_justify="left", title_style="bold", box=box.SIMPLE_HEAD)
    shown.add_column("", style="dim", no_wrap=True)
    for name in tables:
        shown.add_column(Text(name), justify="right", overflow="fold")
    for row in dict.fromkeys(name for table in tables.values() for name in table if name != "robot"):
        cells = [describe(row, table[row]) if row in table else None for table in tables.values()]
        words = next(cell[0] for cell in cells if cell is not None)
        shown.add_row(Text(words), *(Text(cell[1] if cell is not None else "") for cell in cells))
    return shown
