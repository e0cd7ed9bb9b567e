"""A board's graph as text: by panel, or by component."""

import textwrap
from collections.abc import Iterator, Sequence

from blackboard.watching.board_graph import ROLES, BoardGraph, heading_of, name_of

PLURALS = {
    "robot": "robot",
    "knowledge source": "knowledge sources",
    "rules": "rules",
    "behaviour": "behaviours",
    "coordinator": "coordinator",
    "safety layer": "safety layer",
    "control": "control module",
    "keeper": "board keeper",
}


def lines_by_panel(graph: BoardGraph, width: int) -> Iterator[str]:
    """Yield, for each kind, who posts it, whom it wakes, and who else reads it."""
    yield f"{graph.title}: who posts and reads what"
    heading = ""
    for path in graph.paths():
        if heading_of(path) != heading:
            heading = heading_of(path)
            yield ""
            yield heading
        yield f"  {name_of(path)}"
        yield from _row("posted by", graph.posters(path) or ["nobody"], width)
        yield from _row("wakes", graph.woken(path), width)
        yield from _row("read by", graph.readers(path), width)


def lines_by_component(graph: BoardGraph, width: int) -> Iterator[str]:
    """Yield, for each component, what wakes it, what else it reads, and what it posts."""
    yield f"{graph.title}: who posts and reads what"
    for role in ROLES:
        members = [one for one in graph.members if one.role == role]
        if members:
            yield ""
            yield PLURALS[role]
        for one in members:
            yield f"  {one.name}" + (f" on {one.host}" if one.host else "")
            yield from _row("woken by", one.woken_by, width)
            yield from _row("reads", one.reads, width)
            yield from _row("posts", one.posts, width)


def _row(label: str, names: Sequence[str], width: int) -> Iterator[str]:
    if names:
        first = f"    {label:9}  "
        yield from textwrap.wrap(
            ", ".join(names),
            max(width, len(first) + 20),
            initial_indent=first,
            subsequent_indent=" " * len(first),
            break_long_words=False,
            break_on_hyphens=False,
        )
