"""The panels of `figures.png`: which there are for a run, what each draws, and what stands below it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.lines import Line2D

from blackboard.grid import UNKNOWN
from blackboard.report import palette
from blackboard.report.figure_drawing import (
    PATH_STEP_PX,
    VISIT_COLOURS,
    contrast_of,
    draw_diamond,
    draw_grid,
    draw_lines,
    draw_path,
    draw_points,
    draw_visits,
    lighter,
)
from blackboard.report.milestones import Ends, GridStage, Lead, LineStage, Milestones, Points
from blackboard.report.result import RunResult, Trajectory, driven_m, segments
from blackboard.report.view import View, simplified

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Draw = Callable[["Axes", View, float], None]  # on axes over a view, at so many pixels a metre
Sample = tuple[palette.Colour, str]
THICK, THIN = 2.0, 1.1  # widths of lines, pt
OUTCOMES = {"reached": "reached", "blocked": "blocked", "underway": "dropped"}  # of visits, in words
EARLY, ACCUMULATED = ("6.2 a", "6.2 c"), "6.3"  # figures of the thesis


@dataclass(frozen=True, kw_only=True)
class Panel:
    """One picture of the page: a title, the figure of the thesis that shows the same, what is drawn, and words below."""

    title: str
    caption: str
    draw: Draw
    thesis: str = ""
    samples: Sequence[Sample] = ()  # colours explained below it
    early: bool = False  # shows the part of the map that the first two sets of lines cover


def panels_of(result: RunResult, milestones: Milestones) -> list[Panel]:
    """Return the panels that a run has something for, in the thesis's order."""
    found = [
        _way_panel(result, milestones),
        *(_grid_panel(result, stage, thesis) for stage, thesis in _numbered(milestones.scans)),
        _lines_panel(result, "First 2-D lines", "6.4", milestones.first, palette.LINE_COLOUR),
        _points_panel("Raw points", "6.5", milestones.raw, "echoes, on the axes of their cones"),
        _points_panel("Filtered points", "6.6", milestones.filtered, "of them that the grid bears out"),
        _lines_panel(result, "Second 2-D lines", "6.7", milestones.second, palette.SECOND_LINE_COLOUR),
        *_both_panels(result, milestones),
        _targets_panel(result, milestones),
        _end_panel(result),
    ]
    return [panel for panel in found if panel is not None]


def _way_panel(result: RunResult, milestones: Milestones) -> Panel | None:
    path = result.trajectory
    if len(path) < 2:
        return None
    told = f"{driven_m(path):.0f} m in {path[-1, 0] - path[0, 0]:.0f} s"
    times = led_s(milestones.leads, float(path[-1, 0]))
    order = [name for name in milestones.behaviours if name in times]
    colours = {name: palette.BEHAVIOUR_COLOURS[i % len(palette.BEHAVIOUR_COLOURS)] for i, name in enumerate(order)}

    def draw(axes: "Axes", view: View, px_per_m: float) -> None:
        if result.grid is not None:
            draw_grid(axes, result.grid, view, faint=True)
        if not order:
            draw_path(axes, path, px_per_m)
            return
        for name, piece in pieces_by_lead(path, milestones.leads):
            kept = piece[simplified(piece[:, 1:3], PATH_STEP_PX / px_per_m)]
            colour = palette.rgb(colours.get(name, palette.FAINT_INK))
            axes.add_line(Line2D(kept[:, 1], kept[:, 2], color=colour, linewidth=1.2, solid_capstyle="round", zorder=3))

    samples = [(colours[name], f"{name.replace('_', ' ')} {times[name]:.0f} s") for name in order]
    title = "Way under the behaviours" if order else "Way"
    return Panel(title=title, thesis="6.1", caption=told, draw=draw, samples=samples)


def _numbered(stages: Sequence[GridStage]) -> list[tuple[GridStage, str]]:
    """Return the grids with the figures of the thesis that show the same: early ones, then the one that they lead to."""
    early = [*EARLY[: len(stages) - 1], ACCUMULATED] if stages else []
    return list(zip(stages, early, strict=True))


def _grid_panel(result: RunResult, stage: GridStage, thesis: str) -> Panel:
    known_m2 = int((stage.grid.cells != UNKNOWN).sum()) * stage.grid.cell_m**2
    until = result.trajectory[result.trajectory[:, 0] <= stage.stamp_s] if len(result.trajectory) else result.trajectory

    contrast = 1.0 if thesis == ACCUMULATED else contrast_of(stage.grid)

    def draw(axes: "Axes", view: View, px_per_m: float) -> None:
        draw_grid(axes, stage.grid, view, contrast=contrast)
        if len(until) > 1:
            draw_path(axes, until, px_per_m)

    scans = "the first scan" if stage.scans == 1 else f"{stage.scans} scans"
    return Panel(
        title=f"Grid after {scans}",
        thesis=thesis,
        caption=f"at {_seconds(stage.stamp_s - _start_s(result))}, {known_m2:.1f} m²"
        + (f", contrast {contrast:.0f} times" if contrast > 1.5 else ""),
        draw=draw,
        early=True,
    )


def _lines_panel(
    result: RunResult, title: str, thesis: str, stage: LineStage | None, colour: palette.Colour
) -> Panel | None:
    if stage is None:
        return None
    stamps = result.trajectory[:, 0]
    from_s, until_s = (stamp_s - _start_s(result) for stamp_s in (stage.from_s, stage.stamp_s))
    way = result.trajectory[(stamps >= stage.from_s) & (stamps <= stage.stamp_s)]

    def draw(axes: "Axes", view: View, px_per_m: float) -> None:
        if len(way) > 1:
            draw_path(axes, way, px_per_m)
        draw_lines(axes, stage.ends, colour, THICK)

    return Panel(
        title=title,
        thesis=thesis,
        caption=f"{_lines_told(stage)}, {stage.points:,} points, {from_s:.0f} to {until_s:.0f} s",
        draw=draw,
        early=True,
    )


def _points_panel(title: str, thesis: str, points: Points | None, told: str) -> Panel | None:
    if points is None:
        return None
    return Panel(
        title=title,
        thesis=thesis,
        caption=f"{len(points):,} {told}",
        draw=lambda axes, view, px_per_m: draw_points(axes, points),
        early=True,
    )


def _both_panels(result: RunResult, milestones: Milestones) -> list[Panel]:
    first, second, merged = milestones.first, milestones.second, milestones.merged
    if first is None or second is None:
        return []
    samples = [(palette.LINE_COLOUR, "first"), (palette.SECOND_LINE_COLOUR, "second")]

    def both(axes: "Axes", width: float, shade: float) -> None:
        draw_lines(axes, first.ends, lighter(palette.LINE_COLOUR, shade), width)
        draw_lines(axes, second.ends, lighter(palette.SECOND_LINE_COLOUR, shade), width)

    panels = [
        Panel(
            title="First and second lines",
            thesis="6.8",
            caption=f"{len(first.ends)} and {len(second.ends)} lines",
            draw=lambda axes, view, px_per_m: both(axes, THIN, 0.0),
            samples=samples,
            early=True,
        )
    ]
    if merged is not None:

        def all_three(axes: "Axes", view: View, px_per_m: float) -> None:
            both(axes, 2.6, 0.55)
            draw_lines(axes, merged.ends, palette.INK, THIN)

        panels.append(
            Panel(
                title="Merged lines over both",
                thesis="6.9",
                caption=f"{_lines_told(merged)} at {merged.stamp_s - _start_s(result):.0f} s",
                draw=all_three,
                samples=[(palette.INK, "merged"), *samples],
                early=True,
            )
        )
    return panels


def _targets_panel(result: RunResult, milestones: Milestones) -> Panel | None:
    visits = milestones.visits
    if not visits and not result.targets:
        return None
    counts = {word: sum(v.outcome == outcome for v in visits) for outcome, word in OUTCOMES.items()}
    counts["open"] = len(result.targets)
    told = [f"{count} {word}" for word, count in counts.items() if count]

    def draw(axes: "Axes", view: View, px_per_m: float) -> None:
        if result.grid is not None:
            draw_grid(axes, result.grid, view, faint=True)
        for target in result.targets:
            draw_diamond(axes, target.place, 34, "none", palette.TARGET_COLOUR, 1.1)
        draw_visits(axes, visits)

    return Panel(
        title="Targets, in the order of the visits" if visits else "Targets",
        caption=", ".join(told),
        draw=draw,
        samples=[(VISIT_COLOURS[outcome], word) for outcome, word in OUTCOMES.items() if counts[word]],
    )


def _end_panel(result: RunResult) -> Panel | None:
    if result.grid is None:
        return None
    known_m2 = int((result.grid.cells != UNKNOWN).sum()) * result.grid.cell_m**2
    lines = segments_of(result)
    grid = result.grid

    def draw(axes: "Axes", view: View, px_per_m: float) -> None:
        draw_grid(axes, grid, view)
        draw_lines(axes, lines, palette.LINE_COLOUR, THIN)

    return Panel(title="The map at the end", caption=f"{known_m2:.0f} m², {len(lines)} lines", draw=draw)


def led_s(leads: Sequence[Lead], end_s: float) -> dict[str, float]:
    """Return for how long each behaviour led until `end_s`."""
    times: dict[str, float] = {}
    stamps = [lead.stamp_s for lead in leads] + [end_s]
    for lead, until_s in zip(leads, stamps[1:], strict=True):
        if lead.behaviour:
            times[lead.behaviour] = times.get(lead.behaviour, 0.0) + max(0.0, until_s - lead.stamp_s)
    return {name: time_s for name, time_s in times.items() if time_s > 0}


def pieces_by_lead(path: Trajectory, leads: Sequence[Lead]) -> list[tuple[str, Trajectory]]:
    """Return the way in pieces, each with the behaviour that led there; a piece begins where the one before it ends."""
    starts = np.array([lead.stamp_s for lead in leads])
    cuts = [0, *np.searchsorted(path[:, 0], starts).tolist(), len(path)]
    names = ["", *(lead.behaviour for lead in leads)]
    return [
        (name, path[max(0, first - 1) : past])
        for name, (first, past) in zip(names, pairwise(cuts), strict=True)
        if past > first and past - max(0, first - 1) > 1
    ]


def segments_of(result: RunResult) -> Ends:
    """Return the ends of the lines at the end."""
    return segments([entry.value for entry in result.lines])


def _lines_told(stage: LineStage) -> str:
    length_m = float(np.hypot(stage.ends[:, 2] - stage.ends[:, 0], stage.ends[:, 3] - stage.ends[:, 1]).sum())
    return f"{len(stage.ends)} line{'' if len(stage.ends) == 1 else 's'}, {length_m:.1f} m"


def _start_s(result: RunResult) -> float:
    """Return the stamp of the first pose: a recording's clock begins anywhere."""
    return float(result.trajectory[0, 0]) if len(result.trajectory) else 0.0


def _seconds(stamp_s: float) -> str:
    return f"{stamp_s:.1f} s" if stamp_s < 10 else f"{stamp_s:.0f} s"
