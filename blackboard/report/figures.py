"""The run in panels, `figures.png`, in the manner of Bou-Ghannam 1992, Figures 6.1 to 6.9."""

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from blackboard.report import palette
from blackboard.report.figure_panels import Panel, Sample, panels_of, segments_of
from blackboard.report.milestones import Milestones
from blackboard.report.overview import main_figures
from blackboard.report.result import RunResult
from blackboard.report.view import View, scale_bar_m, view_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH_PX = 1600
DPI = 200
EDGE_PX = 48
GAP_PX = 40  # between panels
COLUMNS = 3
HEAD_PX = 160
TITLE_PX = 34  # above each panel
CAPTION_PX = 58  # below each panel
SAMPLE_PX = 20  # each row of colours that are explained below that
LETTER_PX = 7.6  # about as wide as a letter of them
LEAST_PANELS = 4  # fewer show nothing that overview.png does not
SHAPE = (0.55, 1.1)  # height over width of a panel's map


def write_figures(result: RunResult, milestones: Milestones, path: Path) -> bool:
    """Draw the panels and write them as PNG; say whether there were enough of them. The same run gives the same bytes."""
    panels = panels_of(result, milestones)
    if len(panels) < LEAST_PANELS:
        return False
    with mpl.rc_context(rc=dict(mpl.rcParamsDefault)), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        figures_page(result, milestones, panels).savefig(path, format="png", dpi=DPI, metadata={"Software": None})
    return True


def figures_page(result: RunResult, milestones: Milestones, panels: Sequence[Panel]) -> Figure:
    """Return the page as a figure with its own canvas."""
    whole, early = views_of(result, milestones)
    width_px = (WIDTH_PX - 2 * EDGE_PX - (COLUMNS - 1) * GAP_PX) / COLUMNS
    map_px = round(width_px * whole.height_m / whole.width_m)
    rows = [panels[i : i + COLUMNS] for i in range(0, len(panels), COLUMNS)]
    rows_px = [
        TITLE_PX + map_px + CAPTION_PX + SAMPLE_PX * max(_sample_rows(p.samples, width_px) for p in row) for row in rows
    ]
    height_px = HEAD_PX + sum(rows_px)
    figure = Figure(figsize=(WIDTH_PX / DPI, height_px / DPI), dpi=DPI, facecolor=palette.rgb(palette.PAPER))
    FigureCanvasAgg(figure)
    page = figure.add_axes((0, 0, 1, 1))
    page.set(xlim=(0, WIDTH_PX), ylim=(0, height_px))
    page.axis("off")
    ink, faint = palette.rgb(palette.INK), palette.rgb(palette.FAINT_INK)
    title = " ".join(result.mission.split())
    page.text(EDGE_PX, height_px - 68, title[:48], fontsize=16, fontweight="bold", color=ink, parse_math=False)
    page.text(EDGE_PX, height_px - 112, main_figures(result), fontsize=9.5, color=faint, parse_math=False)
    for index, panel in enumerate(panels):
        row, column = divmod(index, COLUMNS)
        left_px = EDGE_PX + column * (width_px + GAP_PX)
        bottom_px = height_px - HEAD_PX - sum(rows_px[:row]) - TITLE_PX - map_px
        view = early if panel.early else whole
        axes = figure.add_axes((left_px / WIDTH_PX, bottom_px / height_px, width_px / WIDTH_PX, map_px / height_px))
        px_per_m = width_px / view.width_m
        panel.draw(axes, view, px_per_m)
        axes.set(xlim=(view.x_min_m, view.x_max_m), ylim=(view.y_min_m, view.y_max_m), xticks=[], yticks=[])
        for spine in axes.spines.values():
            spine.set(color=palette.rgb(palette.UNKNOWN_COLOUR), linewidth=0.8)
        page.text(left_px, bottom_px + map_px + 11, panel.title, fontsize=8.5, fontweight="bold", color=ink)
        if panel.thesis:
            words = f"as Fig. {panel.thesis}"
            page.text(left_px + width_px, bottom_px + map_px + 11, words, fontsize=6.5, color=faint, ha="right")
        _draw_caption(page, panel, left_px, bottom_px, width_px, scale_bar_m(view.width_m), px_per_m)
    return figure


def views_of(result: RunResult, milestones: Milestones) -> tuple[View, View]:
    """Return the part of the map that the whole run shows, and the part that the early panels do, in one shape."""
    whole = view_of(result.grid, result.trajectory, segments_of(result), result.robot.radius_m).widened(*SHAPE)
    stages = [stage for stage in (milestones.first, milestones.second, milestones.merged) if stage is not None]
    shown = [stage.ends for stage in stages]
    shown += [np.hstack([points, points]) for points in (milestones.filtered,) if points is not None]
    if not shown and not milestones.scans:
        return whole, whole
    grid = milestones.scans[-1].grid if milestones.scans else None
    ends = np.vstack([np.zeros((0, 4)), *shown])
    early = view_of(grid, result.trajectory[:1], ends, result.robot.radius_m)
    shape = whole.height_m / whole.width_m
    return whole, early.widened(shape, shape)


def _sample_rows(samples: Sequence[Sample], width_px: float) -> int:
    """Return how many rows the samples of a panel take, about."""
    rows, x = 0, width_px
    for _, label in samples:
        wide_px = 40 + LETTER_PX * len(label)
        rows, x = (rows, x + wide_px) if x + wide_px <= width_px else (rows + 1, wide_px)
    return rows


def _draw_caption(
    page: "Axes", panel: Panel, left_px: float, bottom_px: float, width_px: float, bar_m: float, px_per_m: float
) -> None:
    """Put the words below a panel on the left, its scale bar on the right, and the samples of its colours under them."""
    ink, faint = palette.rgb(palette.INK), palette.rgb(palette.FAINT_INK)
    y = bottom_px - 20
    page.text(left_px, y, panel.caption, fontsize=6.5, color=ink, va="center_baseline")
    right, bar_px = left_px + width_px, bar_m * px_per_m
    xs, ys = [right - bar_px] * 3 + [right] * 3, [y + 5, y - 5, y, y, y + 5, y - 5]
    page.add_line(Line2D(xs, ys, color=faint, linewidth=0.8, solid_capstyle="butt", solid_joinstyle="miter"))
    page.text(right - bar_px - 7, y, f"{bar_m:g} m", fontsize=6, color=faint, ha="right", va="center_baseline")
    x, y = left_px, y - 25
    for colour, label in panel.samples:
        text = page.text(x + 24, y, label, fontsize=6, color=faint, va="center_baseline")
        wide_px = 24 + float(text.get_window_extent().width)
        if x > left_px and x + wide_px > right:
            x, y = left_px, y - 20
            text.set_position((x + 24, y))
        page.add_line(Line2D([x + 3, x + 17], [y, y], color=palette.rgb(colour), linewidth=2.0))
        x += wide_px + 16
