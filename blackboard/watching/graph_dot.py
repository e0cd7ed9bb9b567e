"""A board's graph in the DOT language, for graphviz and whatever else reads it: kinds in a cluster for each panel."""

from collections.abc import Iterator

from blackboard.report import palette
from blackboard.watching.board_graph import BoardGraph, heading_of, name_of
from blackboard.watching.graph_colours import ROLE_COLOURS


def dot(graph: BoardGraph) -> str:
    """Return the graph: kinds are boxes, components ellipses; a thick arrow wakes, a thin one is read, a dark one posts."""
    return "\n".join(_lines(graph)) + "\n"


def _lines(graph: BoardGraph) -> Iterator[str]:
    ink, faint = _hex(palette.INK), _hex(palette.FAINT_INK)
    yield f"digraph {_quoted(graph.title)} {{"
    yield "  rankdir=LR; ranksep=1.0; newrank=true;"
    yield '  node [fontname="Helvetica", fontsize=10]; edge [arrowsize=0.7];'
    headings = dict.fromkeys(heading_of(path) for path in graph.paths())
    for number, heading in enumerate(headings):
        yield f"  subgraph cluster_{number} {{"
        yield f'    label={_quoted(heading)}; style=rounded; color="{faint}"; fontname="Helvetica-Bold";'
        for path in graph.paths():
            if heading_of(path) == heading:
                yield f"    {_quoted(path)} [label={_quoted(name_of(path))}, shape=box];"
        yield "  }"
    for one in graph.members:
        label = _quoted(one.name + (f"\n{one.host}" if one.host else ""))
        colour = _hex(ROLE_COLOURS[one.role])
        yield f'  {_quoted("@" + one.name)} [label={label}, shape=ellipse, penwidth=2, color="{colour}"];'
    for one in graph.members:
        name = _quoted("@" + one.name)
        for path in one.woken_by:
            yield f'  {_quoted(path)} -> {name} [penwidth=2, color="{ink}"];'
        for path in one.reads:
            yield f'  {_quoted(path)} -> {name} [color="{faint}", style=dashed];'
        for path in one.posts:
            yield f'  {name} -> {_quoted(path)} [color="{ink}"];'
    yield "}"


def _hex(colour: palette.Colour) -> str:
    return "#{:02x}{:02x}{:02x}".format(*colour)


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
