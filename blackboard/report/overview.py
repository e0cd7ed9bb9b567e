"""The run in one picture, `overview.png`: grid, lines, path, robot, scale bar, and what the colours mean."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from math import cos, sin
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon, Rectangle

from blackboard.grid import UNKNOWN
from blackboard.report import palette
from blackboard.report.result import RunResult, driven_m, segments
from blackboard.report.symbols import draw_corner_sample, draw_symbols, draw_target_sample
from blackboard.report.view import View, colours_over, scale_bar_m, simplified, view_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Pose = npt.NDArray[np.float64]  # one row of a trajectory

WIDTH_PX = 1600
DPI = 200
EDGE_PX = 48
HEAD_PX = 148
FOOT_PX = 104
PATH_SAMPLE_PX = 60  # the legend of a long run on a narrow map must still fit
CROWDED_ITEMS = 8  # more of them in the legend are written smaller
TITLE_LETTERS = 48  # as many of the widest kind as fit
SHAPE = (0.35, 0.9)  # height over width of the map's part
POINT_M, POINT_PX = 0.02, 1.5  # how large points are drawn, and no smaller than this
SMALLEST_ROBOT_PX = 9.0  # radius below which a ring around the robot shows where it stands


def write_overview(result: RunResult, path: Path) -> None:
    """Draw the overview and write it as PNG, 1600 px wide; the same result gives the same bytes."""
    with (
        mpl.rc_context(rc=dict(mpl.rcParamsDefault)),
        warnings.catch_warnings(),
    ):  # whatever the user's matplotlibrc says
        warnings.filterwarnings(
            "ignore", message="Glyph .* missing"
        )  # a mission's name in a script that the font lacks
        figure = overview_figure(result)
        figure.savefig(path, format="png", dpi=DPI, metadata={"Software": None})


def overview_figure(result: RunResult) -> Figure:
    """Return the overview as a figure with its own canvas."""
    ends = segments([e.value for e in result.lines])
    shown = ends if result.grid is not None or result.points is None else np.vstack([ends, np.tile(result.points, 2)])
    view = view_of(result.grid, result.trajectory, shown, result.robot.radius_m).widened(*SHAPE)
    map_width_px = WIDTH_PX - 2 * EDGE_PX
    map_height_px = round(map_width_px * view.height_m / view.width_m)
    height_px = HEAD_PX + map_height_px + FOOT_PX
    figure = Figure(figsize=(WIDTH_PX / DPI, height_px / DPI), dpi=DPI, facecolor=palette.rgb(palette.PAPER))
    FigureCanvasAgg(figure)
    page = figure.add_axes((0, 0, 1, 1))
    page.set(xlim=(0, WIDTH_PX), ylim=(0, height_px))
    page.axis("off")
    area = (EDGE_PX / WIDTH_PX, FOOT_PX / height_px, map_width_px / WIDTH_PX, map_height_px / height_px)
    axes = figure.add_axes(area, facecolor=palette.rgb(palette.UNKNOWN_COLOUR))
    axes.set(xlim=(view.x_min_m, view.x_max_m), ylim=(view.y_min_m, view.y_max_m), xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)
    px_per_m = map_width_px / view.width_m
    _draw_map(axes, result, view, px_per_m)
    _draw_head(page, result, height_px)
    _draw_foot(page, result, px_per_m, view)
    return figure


def main_figures(result: RunResult) -> str:
    """Return the line of figures under the title."""
    path = result.trajectory
    parts = [f"robot {result.robot.name}"]
    if len(path):
        parts.append(f"{_duration(float(path[-1, 0] - path[0, 0]))}, {driven_m(path):.0f} m driven")
    if result.grid is not None:
        known = int((result.grid.cells != UNKNOWN).sum()) * result.grid.cell_m**2
        parts.append(f"{known:.0f} m² mapped")
    elif result.points is not None:
        parts.append(f"{len(result.points):,} points")
    if result.lines:
        parts.append(f"{len(result.lines)} line{'s' if len(result.lines) > 1 else ''}")
    return "   ·   ".join(parts)


def _draw_map(axes: "Axes", result: RunResult, view: View, px_per_m: float) -> None:
    if result.grid is not None:
        picture, covered = colours_over(result.grid, view, palette.cell_colours())
        if picture.size:
            extent = (covered.x_min_m, covered.x_max_m, covered.y_min_m, covered.y_max_m)
            axes.imshow(picture, extent=extent, interpolation="nearest", aspect="auto", zorder=1)
            axes.set(xlim=(view.x_min_m, view.x_max_m), ylim=(view.y_min_m, view.y_max_m))
    elif result.points is not None:
        size = (max(POINT_PX, POINT_M * px_per_m) * 72 / DPI) ** 2
        axes.scatter(
            result.points[:, 0],
            result.points[:, 1],
            s=size,
            color=palette.rgb(palette.OCCUPIED_COLOUR),
            linewidths=0,
            zorder=1,
        )
    path = result.trajectory
    if len(path) > 1:
        kept = path[simplified(path[:, 1:3], 2.0 / px_per_m)]
        span_s = max(float(path[-1, 0] - path[0, 0]), 1e-9)
        colours = palette.path_colours((kept[1:, 0] - path[0, 0]) / span_s)
        pieces = np.stack([kept[:-1, 1:3], kept[1:, 1:3]], axis=1)
        axes.add_collection(
            LineCollection(list(pieces), colors=list(colours), linewidths=0.8, capstyle="round", zorder=2)
        )
    ends = segments([e.value for e in result.lines]).reshape(-1, 2, 2)
    for colour, width, order in ((palette.PAPER, 2.6, 3), (palette.LINE_COLOUR, 1.5, 4)):
        axes.add_collection(
            LineCollection(list(ends), colors=[palette.rgb(colour)], linewidths=width, capstyle="round", zorder=order)
        )
    draw_symbols(axes, result, px_per_m)
    if len(path):
        if _moved(result):
            _draw_robot(axes, path[0], result.robot.radius_m, px_per_m, palette.PAPER)
        _draw_robot(axes, path[-1], result.robot.radius_m, px_per_m, palette.ROBOT_COLOUR)


def _moved(result: RunResult) -> bool:
    """Say whether start and end lie far enough apart to be drawn as two robots."""
    step_m = result.trajectory[-1, 1:3] - result.trajectory[0, 1:3]
    return float(np.hypot(step_m[0], step_m[1])) > 0.5 * result.robot.radius_m


def _draw_robot(axes: "Axes", pose: Pose, radius_m: float, px_per_m: float, colour: palette.Colour) -> None:
    x_m, y_m, heading_rad = (float(v) for v in pose[1:])
    ink, fill = palette.rgb(palette.INK), palette.rgb(colour)
    if radius_m * px_per_m >= SMALLEST_ROBOT_PX:
        axes.add_patch(Circle((x_m, y_m), radius_m, facecolor=fill, edgecolor=ink, linewidth=0.9, zorder=6))
        axes.add_patch(_nose(x_m, y_m, heading_rad, radius_m, zorder=7))
        return
    ring_m = 2.0 * SMALLEST_ROBOT_PX / px_per_m
    tip = (x_m + ring_m * cos(heading_rad), y_m + ring_m * sin(heading_rad))
    axes.add_patch(Circle((x_m, y_m), ring_m, facecolor=fill, edgecolor=ink, linewidth=0.9, zorder=6))
    axes.add_line(Line2D((x_m, tip[0]), (y_m, tip[1]), color=ink, linewidth=0.9, zorder=7))
    axes.add_patch(Circle((x_m, y_m), radius_m, facecolor=ink, linewidth=0, zorder=7))


def _nose(x: float, y: float, heading_rad: float, radius: float, zorder: int) -> Polygon:
    """Return an arrow head inside a robot's body."""
    turns, reach = (0.0, 2.5, np.pi, -2.5), (0.72, 0.68, 0.25, 0.68)
    corners = [
        (x + r * radius * cos(heading_rad + a), y + r * radius * sin(heading_rad + a))
        for a, r in zip(turns, reach, strict=True)
    ]
    return Polygon(corners, closed=True, facecolor=palette.rgb(palette.INK), linewidth=0, zorder=zorder)


def _draw_head(page: "Axes", result: RunResult, height_px: int) -> None:
    ink, faint = palette.rgb(palette.INK), palette.rgb(palette.FAINT_INK)
    words = " ".join(result.mission.split())
    title = words if len(words) <= TITLE_LETTERS else words[: TITLE_LETTERS - 1] + "…"
    page.text(EDGE_PX, height_px - 68, title, fontsize=16, fontweight="bold", color=ink, parse_math=False)
    page.text(EDGE_PX, height_px - 116, main_figures(result), fontsize=9.5, color=faint, parse_math=False)


@dataclass(frozen=True)
class _Item:
    """One thing explained below the map: `draw` puts a symbol of this width at x, y."""

    width_px: float
    label: str
    draw: Callable[["Axes", float, float], None]


def _draw_foot(page: "Axes", result: RunResult, px_per_m: float, view: View) -> None:
    """Put scale bar and legend side by side, the free room shared out evenly between them."""
    length_m = scale_bar_m(view.width_m)
    items = [_Item(length_m * px_per_m, f"{length_m:g} m", lambda a, x, y: _draw_scale(a, x, y, length_m * px_per_m))]
    if result.grid is not None:
        swatches = (
            ("empty", palette.EMPTY_COLOUR),
            ("unknown", palette.UNKNOWN_COLOUR),
            ("occupied", palette.OCCUPIED_COLOUR),
        )
        items += [_Item(26, name, _swatch(colour)) for name, colour in swatches]
    elif result.points is not None:
        items.append(_Item(26, "points", _points_sample))
    if result.lines:
        items.append(_Item(44, "line", _draw_line_sample))
    if result.corners:
        items.append(_Item(20, "corner", draw_corner_sample))
    if result.targets:
        items.append(_Item(24, "target", draw_target_sample))
    if len(result.trajectory) > 1:
        span_s = float(result.trajectory[-1, 0] - result.trajectory[0, 0])
        items.append(_Item(PATH_SAMPLE_PX, f"path, 0 to {_duration(span_s)}", _draw_path_sample))
    if len(result.trajectory):
        if _moved(result):
            items.append(_Item(34, "start", _robot_sample(palette.PAPER)))
        items.append(_Item(34, "end" if _moved(result) else "robot", _robot_sample(palette.ROBOT_COLOUR)))
    crowded = len(items) > CROWDED_ITEMS
    texts = [
        page.text(
            0,
            FOOT_PX / 2,
            i.label,
            fontsize=7.5 if crowded else 9,
            color=palette.rgb(palette.INK),
            va="center_baseline",
        )
        for i in items
    ]
    widths_px = [text.get_window_extent().width for text in texts]
    gap_px = 9.0 if crowded else 14.0
    used_px = sum(widths_px) + sum(i.width_px + gap_px for i in items)
    room_px = (WIDTH_PX - 2 * EDGE_PX - used_px) / max(1, len(items) - 1)
    x_px = float(EDGE_PX)
    for item, text, width_px in zip(items, texts, widths_px, strict=True):
        item.draw(page, x_px, FOOT_PX / 2)
        text.set_x(x_px + item.width_px + gap_px)
        x_px += item.width_px + gap_px + width_px + min(room_px, 70.0)


def _draw_scale(page: "Axes", x: float, y: float, width_px: float) -> None:
    ends = ([x, x, x, x + width_px, x + width_px, x + width_px], [y + 8, y - 8, y, y, y + 8, y - 8])
    page.add_line(
        Line2D(*ends, color=palette.rgb(palette.INK), linewidth=1.2, solid_capstyle="butt", solid_joinstyle="miter")
    )


def _swatch(colour: palette.Colour) -> Callable[["Axes", float, float], None]:
    def draw(page: "Axes", x: float, y: float) -> None:
        edge = palette.rgb(palette.FAINT_INK)
        page.add_patch(Rectangle((x, y - 13), 26, 26, facecolor=palette.rgb(colour), edgecolor=edge, linewidth=0.5))

    return draw


def _points_sample(page: "Axes", x: float, y: float) -> None:
    page.scatter(
        [x + 4, x + 12, x + 21], [y - 3, y + 4, y - 1], s=6, color=palette.rgb(palette.OCCUPIED_COLOUR), linewidths=0
    )


def _draw_line_sample(page: "Axes", x: float, y: float) -> None:
    page.add_line(Line2D([x, x + 44], [y, y], color=palette.rgb(palette.LINE_COLOUR), linewidth=1.8))


def _draw_path_sample(page: "Axes", x: float, y: float) -> None:
    xs = np.linspace(x, x + PATH_SAMPLE_PX, 45)
    pieces = [[(a, y), (b, y)] for a, b in zip(xs[:-1].tolist(), xs[1:].tolist(), strict=True)]
    colours = list(palette.path_colours(np.linspace(0.0, 1.0, 44)))
    page.add_collection(LineCollection(pieces, colors=colours, linewidths=2.2))


def _robot_sample(colour: palette.Colour) -> Callable[["Axes", float, float], None]:
    def draw(page: "Axes", x: float, y: float) -> None:
        page.add_patch(
            Circle((x + 17, y), 16, facecolor=palette.rgb(colour), edgecolor=palette.rgb(palette.INK), linewidth=0.9)
        )
        page.add_patch(_nose(x + 17, y, 0.0, 16, zorder=3))

    return draw


def _duration(span_s: float) -> str:
    seconds = round(span_s)
    if seconds < 120:
        return f"{seconds} s"
    if seconds < 7200:
        return f"{seconds // 60} min" + (f" {seconds % 60} s" if seconds % 60 else "")
    return f"{seconds // 3600} h {seconds % 3600 // 60} min"
