"""Marks of corners and targets in the overview, and their samples for the legend."""

from math import cos, pi, sin, sqrt
from typing import TYPE_CHECKING

from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from blackboard.messages.symbols import Corner
from blackboard.report import palette
from blackboard.report.result import RunResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CORNER_PX = 15.0  # length of a mark's arms
TARGET_PX = 11.0  # half a diagonal
ORDER = 5  # above the lines, below the robot


def draw_symbols(axes: "Axes", result: RunResult, px_per_m: float) -> None:
    """Draw the corners as angles that open as they do, on the side where there is room, and the targets as diamonds."""
    for corner in result.corners:
        _draw_corner(axes, corner, CORNER_PX / px_per_m)
    for target in result.targets:
        _draw_diamond(axes, target.place.x_m, target.place.y_m, TARGET_PX / px_per_m)


def draw_corner_sample(page: "Axes", x: float, y: float) -> None:
    """Draw a corner for the legend, 20 px wide."""
    _draw_angle(page, x + 3, y - 8, (pi / 2, 0.0), CORNER_PX)


def draw_target_sample(page: "Axes", x: float, y: float) -> None:
    """Draw a target for the legend, 24 px wide."""
    _draw_diamond(page, x + 12, y, TARGET_PX)


def _draw_corner(axes: "Axes", corner: Corner, length: float) -> None:
    half = corner.opening_rad / 2
    arms = (corner.bisector_rad - half, corner.bisector_rad + half)
    side = 1.0 if corner.shape != "convex" else -1.0  # the mark stands on the robot's side of the lines
    shift = side * 0.35 * length / max(sin(half), 1 / sqrt(2))
    x = corner.place.x_m + shift * cos(corner.bisector_rad)
    y = corner.place.y_m + shift * sin(corner.bisector_rad)
    _draw_angle(axes, x, y, arms, length)


def _draw_angle(axes: "Axes", x: float, y: float, arms_rad: tuple[float, float], length: float) -> None:
    first, second = ((x + length * cos(a), y + length * sin(a)) for a in arms_rad)
    xs, ys = (first[0], x, second[0]), (first[1], y, second[1])
    for colour, width in ((palette.PAPER, 3.4), (palette.CORNER_COLOUR, 2.0)):
        axes.add_line(Line2D(xs, ys, color=palette.rgb(colour), linewidth=width, solid_joinstyle="miter", zorder=ORDER))


def _draw_diamond(axes: "Axes", x: float, y: float, half: float) -> None:
    ends = [(x - half, y), (x, y + half), (x + half, y), (x, y - half)]
    face, edge = palette.rgb(palette.TARGET_COLOUR), palette.rgb(palette.PAPER)
    axes.add_patch(Polygon(ends, closed=True, facecolor=face, edgecolor=edge, linewidth=0.8, zorder=ORDER))
