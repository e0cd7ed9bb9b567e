"""A board's graph as a picture, in the manner of Hearsay-II: kinds lie across by panel, components stand upon them.

Nothing hides behind anything else however many there are: a component is one upright line with a mark on each kind that it has to
do with, and where no mark is, two lines only cross. The way of the data goes from the upper left to the lower right.
"""

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from blackboard.errors import OutputError
from blackboard.report import palette
from blackboard.report.output_folder import unwritable
from blackboard.watching.board_graph import BoardGraph, heading_of, name_of
from blackboard.watching.graph_colours import ROLE_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DPI = 150
COLUMN_IN, ROW_IN, EDGE_IN = 0.32, 0.21, 0.3
LETTER_IN = 0.07  # of an 8 pt letter
SLANT = 0.75  # of a slanted title's length: how far up it reaches
FONT_PT = 8.0
MARK_PT = 6.5


def write_graph_picture(graph: BoardGraph, path: Path) -> None:
    """Draw the graph and write it as PNG or SVG, by the ending of the name. The same graph gives the same bytes."""
    ending = path.suffix.lower().lstrip(".")
    if ending not in ("png", "svg"):
        raise OutputError(f"--picture {path}: name a .png or .svg file")
    rc = {**mpl.rcParamsDefault, "svg.hashsalt": "graph", "svg.fonttype": "none"}
    metadata = {"Software": None} if ending == "png" else {"Date": None}
    try:
        with mpl.rc_context(rc=rc):
            graph_figure(graph).savefig(path, format=ending, dpi=DPI, metadata=metadata)
    except OSError as error:
        raise unwritable(path, error) from None


def graph_figure(graph: BoardGraph) -> Figure:
    """Return the graph as a figure with its own canvas."""
    rows, headings = _rows(graph)
    titles = [one.name + (f" @ {one.host}" if one.host else "") for one in graph.members]
    names = max((len(name_of(path)) for path in rows), default=0)
    left, above = (names + 6) * LETTER_IN, max(map(len, titles), default=0) * LETTER_IN * SLANT + 0.2
    across, down = len(titles) + 1, max([*rows.values(), 0]) + 1
    legend = 3 * ROW_IN
    right = max((len(title) - 3 * (across - 1 - i)) * LETTER_IN * SLANT for i, title in enumerate(titles))
    width = left + across * COLUMN_IN + max(right, 0.0) + 2 * EDGE_IN
    height = above + down * ROW_IN + legend + 2 * EDGE_IN + 2 * ROW_IN
    figure = Figure(figsize=(width, height), dpi=DPI, facecolor=palette.rgb(palette.PAPER))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    x_from, y_from = -(left + EDGE_IN) / COLUMN_IN, -(above + EDGE_IN + 2 * ROW_IN) / ROW_IN
    axes.set(xlim=(x_from, x_from + width / COLUMN_IN), ylim=(y_from + height / ROW_IN, y_from))
    axes.axis("off")
    _draw_panels(axes, graph, rows, headings, x_from + EDGE_IN / COLUMN_IN)
    _draw_members(axes, graph, rows, titles)
    ink = palette.rgb(palette.INK)
    axes.text(
        x_from + EDGE_IN / COLUMN_IN,
        y_from + EDGE_IN / ROW_IN + 0.5,
        f"{graph.title}: who posts and reads what",
        fontsize=FONT_PT + 3,
        fontweight="bold",
        color=ink,
        va="center",
        parse_math=False,
    )
    _draw_legend(axes, graph, x_from + EDGE_IN / COLUMN_IN, down + 1.2)
    return figure


def _rows(graph: BoardGraph) -> tuple[dict[str, float], dict[str, float]]:
    """Return how far down each kind lies, by its path, and each panel's heading."""
    rows: dict[str, float] = {}
    headings: dict[str, float] = {}
    y = 0.0
    for path in graph.paths():
        heading = heading_of(path)
        if heading not in headings:
            y += 0.4 if headings else 0.0
            headings[heading] = y
            y += 1.0
        rows[path] = y
        y += 1.0
    return rows, headings


def _draw_panels(
    axes: "Axes", graph: BoardGraph, rows: dict[str, float], headings: dict[str, float], left: float
) -> None:
    ink, faint, pale = (palette.rgb(c) for c in (palette.INK, palette.FAINT_INK, palette.UNKNOWN_COLOUR))
    for heading, y in headings.items():
        axes.text(left, y, heading, fontsize=FONT_PT, fontweight="bold", color=ink, va="center", parse_math=False)
    for path, y in rows.items():
        posted = any(path in one.posts for one in graph.members)
        colour = ink if posted else faint
        text = name_of(path)
        axes.text(-0.3, y, text, fontsize=FONT_PT, color=colour, va="center", ha="right", parse_math=False)
        touched = [
            x for x, one in enumerate(graph.members) if path in one.posts or path in one.reads or path in one.woken_by
        ]
        axes.plot([-0.2, max(touched)], [y, y], color=pale, linewidth=1.0, zorder=1)


def _draw_members(axes: "Axes", graph: BoardGraph, rows: dict[str, float], titles: list[str]) -> None:
    paper = palette.rgb(palette.PAPER)
    for x, (one, title) in enumerate(zip(graph.members, titles, strict=True)):
        colour = palette.rgb(ROLE_COLOURS[one.role])
        touched = [rows[path] for path in (*one.woken_by, *one.reads, *one.posts)]
        axes.plot([x, x], [-0.4, max([*touched, 0.0])], color=colour, linewidth=1.1, alpha=0.55, zorder=2)
        axes.text(x, -0.6, title, fontsize=FONT_PT, color=colour, rotation=50, rotation_mode="anchor", parse_math=False)
        for paths, marker, face in (
            (one.reads, "o", paper),
            (one.woken_by, "o", colour),
            (one.posts, "s", colour),
        ):
            for path in paths:
                shift = 0.17 if path in one.posts and (path in one.reads or path in one.woken_by) else 0.0
                at = x + (shift if marker == "s" else -shift)
                axes.plot(
                    [at],
                    [rows[path]],
                    marker,
                    color=face,
                    markeredgecolor=colour,
                    markersize=MARK_PT - shift * 8,
                    zorder=3,
                )


def _draw_legend(axes: "Axes", graph: BoardGraph, left: float, y: float) -> None:
    ink, paper = palette.rgb(palette.INK), palette.rgb(palette.PAPER)
    x = left + 0.3
    for marker, face, words in (("s", ink, "posts"), ("o", ink, "is woken by"), ("o", paper, "reads")):
        axes.add_line(Line2D([x], [y], marker=marker, color=face, markeredgecolor=ink, markersize=MARK_PT))
        axes.text(x + 0.5, y, words, fontsize=FONT_PT, color=ink, va="center")
        x += 1.3 + len(words) * LETTER_IN / COLUMN_IN
    for role in dict.fromkeys(one.role for one in graph.members):
        axes.text(x, y, role, fontsize=FONT_PT, color=palette.rgb(ROLE_COLOURS[role]), va="center")
        x += 0.7 + len(role) * LETTER_IN / COLUMN_IN
