"""Several robots in one picture: their maps laid on each other, and the way of each in a colour of its own."""

from collections.abc import Mapping
from math import cos, sin
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from blackboard.report import palette
from blackboard.report.figure_drawing import draw_grid
from blackboard.report.overview import DPI, EDGE_PX, FOOT_PX, HEAD_PX, SHAPE, WIDTH_PX
from blackboard.report.result import RunResult
from blackboard.report.team import united
from blackboard.report.view import scale_bar_m, simplified, view_of

PATH_STEP_PX = 2.0


def write_team_overview(results: Mapping[str, RunResult], title: str, told: str, path: Path) -> None:
    """Draw the robots' maps and ways under a title and a line that tells more; the same results give the same bytes."""
    with mpl.rc_context(rc=dict(mpl.rcParamsDefault)):  # whatever the user's matplotlibrc says
        figure = team_figure(results, title, told)
        figure.savefig(path, format="png", dpi=DPI, metadata={"Software": None})


def team_figure(results: Mapping[str, RunResult], title: str, told: str) -> Figure:
    """Return the picture as a figure with its own canvas."""
    runs = list(results.values())
    grid = united([run.grid for run in runs if run.grid is not None])
    ways = np.concatenate([run.trajectory for run in runs])
    view = view_of(grid, ways, np.zeros((0, 4)), max(run.robot.radius_m for run in runs)).widened(*SHAPE)
    map_width_px = WIDTH_PX - 2 * EDGE_PX
    map_height_px = round(map_width_px * view.height_m / view.width_m)
    height_px = HEAD_PX + map_height_px + FOOT_PX
    figure = Figure(figsize=(WIDTH_PX / DPI, height_px / DPI), dpi=DPI, facecolor=palette.rgb(palette.PAPER))
    FigureCanvasAgg(figure)
    area = (EDGE_PX / WIDTH_PX, FOOT_PX / height_px, map_width_px / WIDTH_PX, map_height_px / height_px)
    axes = figure.add_axes(area, facecolor=palette.rgb(palette.UNKNOWN_COLOUR))
    px_per_m = map_width_px / view.width_m
    if grid is not None:
        draw_grid(axes, grid, view)
    axes.set(xlim=(view.x_min_m, view.x_max_m), ylim=(view.y_min_m, view.y_max_m), xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)
    ink = palette.rgb(palette.INK)
    handles = []
    for number, (name, run) in enumerate(results.items()):
        colour = palette.rgb(palette.BEHAVIOUR_COLOURS[number % len(palette.BEHAVIOUR_COLOURS)])
        way = run.trajectory
        kept = way[simplified(way[:, 1:3], PATH_STEP_PX / px_per_m)]
        axes.plot(kept[:, 1], kept[:, 2], color=colour, linewidth=0.9, zorder=2)
        for pose, face in ((way[:1], palette.rgb(palette.PAPER)), (way[-1:], colour)):
            for _, x_m, y_m, heading_rad in pose.tolist():
                radius_m = run.robot.radius_m
                axes.add_patch(Circle((x_m, y_m), radius_m, facecolor=face, edgecolor=colour, linewidth=1.2, zorder=5))
                ahead = ([x_m, x_m + radius_m * cos(heading_rad)], [y_m, y_m + radius_m * sin(heading_rad)])
                axes.add_line(Line2D(*ahead, color=ink, linewidth=0.9, zorder=6))
        handles.append(Line2D([], [], color=colour, linewidth=2.2, label=name))
    length_m = scale_bar_m(view.width_m)
    figure.legend(handles=handles, loc="lower right", ncols=len(handles), frameon=False, fontsize=9)
    page: dict[str, Any] = {"parse_math": False, "color": ink}
    figure.text(EDGE_PX / WIDTH_PX, 1 - 68 / height_px, title, fontsize=16, fontweight="bold", **page)
    figure.text(EDGE_PX / WIDTH_PX, 1 - 116 / height_px, told, fontsize=9.5, **page)
    start = EDGE_PX / WIDTH_PX
    end = start + length_m * px_per_m / WIDTH_PX
    y = FOOT_PX / 2 / height_px
    figure.add_artist(Line2D([start, end], [y, y], color=ink, linewidth=1.2, transform=figure.transFigure))
    figure.text(end + 0.01, y, f"{length_m:g} m, empty circles: start", fontsize=9, va="center", **page)
    return figure
