"""`ski graph MISSION`: who posts and reads what, as text, DOT, picture or JSON, from what the components declare."""

import argparse
import json
import shutil
import sys
from pathlib import Path

from blackboard.command.mission_options import add_mission_options, load
from blackboard.report.output_folder import unwritable
from blackboard.watching.declared_graph import declared_graph
from blackboard.watching.graph_text import lines_by_component, lines_by_panel


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    add_mission_options(parser)
    parser.add_argument("--by", choices=("panel", "component"), default="panel", help="how the text is arranged")
    parser.add_argument("--dot", type=Path, metavar="FILE", help="also write it in the DOT language, for graphviz")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="also draw it: a .png or .svg file")
    parser.add_argument("--json", action="store_true", help="print the graph as JSON")


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    graph = declared_graph(load(options))
    if options.dot is not None:
        from blackboard.watching.graph_dot import dot

        try:
            options.dot.write_text(dot(graph), encoding="utf-8")
        except OSError as error:
            raise unwritable(options.dot, error) from None
    if options.picture is not None:
        from blackboard.watching.graph_picture import write_graph_picture  # loads matplotlib

        write_graph_picture(graph, options.picture)
    if options.json:
        sys.stdout.write(json.dumps(graph.as_dict(), indent=2) + "\n")
    elif options.dot is None and options.picture is None:
        lines = lines_by_panel if options.by == "panel" else lines_by_component
        sys.stdout.write("\n".join(lines(graph, shutil.get_terminal_size().columns)) + "\n")
    return 0
