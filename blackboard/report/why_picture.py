"""A why-tree as a picture: what is explained on the left, its reasons to the right of it, readings at the ends."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, PathPatch, Rectangle
from matplotlib.path import Path as Curve

from blackboard.errors import OutputError
from blackboard.report import palette
from blackboard.report.output_folder import unwritable
from blackboard.report.why_tree import COLUMN_GAP, LETTERS, Box, boxes_of
from blackboard.why import Reason

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DPI = 150
LETTER_IN, LINE_IN = 0.058, 0.135  # of a 6.5 pt letter and line
FONT_PT = 6.5
EDGE_IN = 0.35
COLOURS = {
    "commands": palette.ROBOT_COLOUR,
    "motivations": palette.LINE_COLOUR,
    "control": palette.CORNER_COLOUR,
    "hypotheses": palette.TARGET_COLOUR,
    "observations": palette.PATH_COLOURS[1],
    "status": palette.FAINT_INK,
}


def write_why_picture(reason: Reason, path: Path) -> None:
    """Draw the tree and write it as PNG or SVG, by the ending of the name. The same tree gives the same bytes."""
    ending = path.suffix.lower().lstrip(".")
    if ending not in ("png", "svg"):
        raise OutputError(f"--picture {path}: name a .png or .svg file")
    rc = {**mpl.rcParamsDefault, "svg.hashsalt": "why", "svg.fonttype": "none"}
    metadata = {"Software": None} if ending == "png" else {"Date": None}
    try:
        with mpl.rc_context(rc=rc):
            why_figure(reason).savefig(path, format=ending, dpi=DPI, metadata=metadata)
    except OSError as error:
        raise unwritable(path, error) from None


def why_figure(reason: Reason) -> Figure:
    """Return the tree as a figure with its own canvas."""
    root = boxes_of(reason)
    boxes = list(_all(root))
    width = max(box.x for box in boxes) + LETTERS
    height = max(box.y + box.height / 2 for box in boxes)
    size = (width * LETTER_IN + 2 * EDGE_IN, height * LINE_IN + 2 * EDGE_IN)
    figure = Figure(figsize=size, dpi=DPI, facecolor=palette.rgb(palette.PAPER))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    edge_x, edge_y = EDGE_IN / LETTER_IN, EDGE_IN / LINE_IN
    axes.set(xlim=(-edge_x, width + edge_x), ylim=(height + edge_y, -edge_y))
    axes.axis("off")
    for box in boxes:
        for child in box.below:
            _draw_edge(axes, box, child)
    for box in boxes:
        _draw_box(axes, box)
    return figure


def _all(box: Box) -> Iterator[Box]:
    yield box
    for child in box.below:
        yield from _all(child)


def _draw_edge(axes: "Axes", box: Box, child: Box) -> None:
    start, end, half = (box.x + LETTERS, box.y), (child.x, child.y), COLUMN_GAP / 2
    points = [start, (start[0] + half, start[1]), (end[0] - half, end[1]), end]
    curve = Curve(points, [Curve.MOVETO, Curve.CURVE4, Curve.CURVE4, Curve.CURVE4])
    axes.add_patch(PathPatch(curve, fill=False, edgecolor=palette.rgb(palette.FAINT_INK), linewidth=0.8, zorder=1))


def _draw_box(axes: "Axes", box: Box) -> None:
    ink, faint = palette.rgb(palette.INK), palette.rgb(palette.FAINT_INK)
    colour = palette.rgb(COLOURS.get(box.panel, palette.FAINT_INK))
    top = box.y - box.height / 2
    axes.add_patch(
        FancyBboxPatch(
            (box.x, top),
            LETTERS,
            box.height,
            boxstyle="square,pad=0",
            facecolor=palette.rgb(palette.PAPER),
            edgecolor=palette.rgb(palette.UNKNOWN_COLOUR),
            linewidth=0.8,
            zorder=2,
        )
    )
    axes.add_patch(Rectangle((box.x, top), 0.9, box.height, facecolor=colour, linewidth=0, zorder=3))
    y = top + 0.95
    left = box.x + 2.0
    axes.text(
        left, y, box.heading, fontsize=FONT_PT, fontweight="bold", color=ink, va="center", parse_math=False, zorder=4
    )
    for line in box.lines:
        y += 1.0
        axes.text(left, y, line, fontsize=FONT_PT - 0.5, color=ink, va="center", parse_math=False, zorder=4)
    if box.note:
        axes.text(left, y + 1.0, box.note, fontsize=FONT_PT - 0.5, color=faint, va="center", style="italic", zorder=4)
