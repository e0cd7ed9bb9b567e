"""What the panels of `figures.png` are drawn with: grids, ways, lines, points, and places that were visited."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import LineCollection

from blackboard.grid import UNKNOWN
from blackboard.messages.geometry import Point
from blackboard.report import palette
from blackboard.report.milestones import Ends, Points, Visit
from blackboard.report.result import GridView, Trajectory
from blackboard.report.view import View, colours_over, simplified

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PATH_STEP_PX = 2.0
VISIT_COLOURS = {"reached": palette.TARGET_COLOUR, "blocked": palette.LINE_COLOUR, "underway": palette.FAINT_INK}
NUMBERED_VISITS = 40  # more of them would hide each other


def draw_grid(axes: "Axes", grid: GridView, view: View, *, faint: bool = False, contrast: float = 1.0) -> None:
    """Draw the grid's part within the view; `faint`, as a ground for other things; `contrast`, how much farther from unknown."""
    values = np.clip(np.rint((np.arange(256) - UNKNOWN) * contrast) + UNKNOWN, 0, 255).astype(int)
    colours = palette.cell_colours()[values]
    if faint:
        colours = np.rint(255 - (255 - colours.astype(np.float64)) * 0.45).astype(np.uint8)
    picture, covered = colours_over(grid, view, colours)
    if picture.size:
        extent = (covered.x_min_m, covered.x_max_m, covered.y_min_m, covered.y_max_m)
        axes.set_facecolor(palette.rgb(tuple(colours[UNKNOWN].tolist())))
        axes.imshow(picture, extent=extent, interpolation="nearest", aspect="auto", zorder=1)


def draw_path(axes: "Axes", path: Trajectory, px_per_m: float) -> None:
    """Draw a way from light to dark, and where it ends."""
    kept = path[simplified(path[:, 1:3], PATH_STEP_PX / px_per_m)]
    span_s = max(float(path[-1, 0] - path[0, 0]), 1e-9)
    colours = palette.path_colours((kept[1:, 0] - path[0, 0]) / span_s)
    pieces = np.stack([kept[:-1, 1:3], kept[1:, 1:3]], axis=1)
    axes.add_collection(LineCollection(list(pieces), colors=list(colours), linewidths=1.0, capstyle="round", zorder=3))
    face, edge = palette.rgb(palette.ROBOT_COLOUR), palette.rgb(palette.INK)
    axes.scatter(path[-1:, 1], path[-1:, 2], s=16, color=face, edgecolor=edge, linewidths=0.7, zorder=5)


def draw_lines(axes: "Axes", ends: Ends, colour: palette.Colour, width: float) -> None:
    """Draw lines by their ends."""
    pieces = list(ends.reshape(-1, 2, 2))
    axes.add_collection(
        LineCollection(pieces, colors=[palette.rgb(colour)], linewidths=width, capstyle="round", zorder=4)
    )


def draw_points(axes: "Axes", points: Points) -> None:
    """Draw points."""
    axes.scatter(points[:, 0], points[:, 1], s=1.6, color=palette.rgb(palette.OCCUPIED_COLOUR), linewidths=0, zorder=3)


def draw_visits(axes: "Axes", visits: Sequence[Visit]) -> None:
    """Draw the places that the robot was asked to go to, numbered in that order, by what became of them."""
    words: dict[str, Any] = {
        "fontsize": 4.6,
        "color": palette.rgb(palette.PAPER),
        "ha": "center",
        "va": "center_baseline",
        "zorder": 7,
    }
    for number, visit in enumerate(visits, 1):
        draw_diamond(axes, visit.place, 52, palette.rgb(VISIT_COLOURS[visit.outcome]), palette.PAPER, 0.7)
        if len(visits) <= NUMBERED_VISITS:
            axes.text(visit.place.x_m, visit.place.y_m, str(number), **words)


def draw_diamond(axes: "Axes", place: Point, size: float, face: Any, edge: palette.Colour, width: float) -> None:
    """Draw a place as a diamond."""
    axes.scatter(
        [place.x_m],
        [place.y_m],
        s=size,
        marker="D",
        facecolor=face,
        edgecolor=palette.rgb(edge),
        linewidths=width,
        zorder=6,
    )


def contrast_of(grid: GridView) -> float:
    """Return how much farther from unknown the cells may be shown: until the surest tenth of the occupied ones is black."""
    surer = grid.cells[grid.cells > UNKNOWN]
    if not len(surer):
        return 1.0
    return max(1.0, (255 - UNKNOWN) / (float(np.percentile(surer, 90)) - UNKNOWN))


def lighter(colour: palette.Colour, fraction: float) -> palette.Colour:
    """Return a colour mixed with paper."""
    red, green, blue = (round(a + (b - a) * fraction) for a, b in zip(colour, palette.PAPER, strict=True))
    return (red, green, blue)
