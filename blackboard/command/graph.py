"""`ski graph [MISSION]`: who posts and reads what, as a mission's components declare it, or as a run or running board shows."""

import argparse
import json
import shutil
import sys
from collections.abc import Iterable
from pathlib import Path

import msgspec

from blackboard.command.connection import add_connection_options, link_params
from blackboard.command.mission_options import add_mission_options, load
from blackboard.errors import BoardError, MessageError
from blackboard.journal import JournalLine, read_journal
from blackboard.kinds import HOST
from blackboard.link.envelope import read_payload
from blackboard.messages.hosts import HostStatus
from blackboard.mission import shipped_missions
from blackboard.report.output_folder import unwritable
from blackboard.watching.board_graph import BoardGraph
from blackboard.watching.graph_text import lines_by_component, lines_by_panel
from blackboard.watching.observed_graph import observed_graph, path_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    known = ", ".join(shipped_missions())
    parser.add_argument(
        "mission",
        nargs="?",
        help=f"a shipped mission ({known}) or a .toml file: what its components declare (default: the running board as it is seen)",
    )
    add_mission_options(parser, mission=False)
    parser.add_argument(
        "--in", dest="folder", type=Path, metavar="DIR", help="the output folder of a run, as it was seen"
    )
    parser.add_argument("--on", metavar="ROBOT", help="whose board, where there are several")
    parser.add_argument("--by", choices=("panel", "component"), default="panel", help="how the text is arranged")
    parser.add_argument("--dot", type=Path, metavar="FILE", help="write it in the DOT language, for graphviz")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw it: a .png or .svg file")
    parser.add_argument("--json", action="store_true", help="print the graph as JSON")
    add_connection_options(parser)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    graph = _graph(options)
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


def _graph(options: argparse.Namespace) -> BoardGraph:
    if options.mission is not None and options.folder is not None:
        raise BoardError("give a MISSION, or a run with --in DIR, not both")
    if options.mission is not None:
        from blackboard.watching.declared_graph import declared_graph  # builds the mission's components

        return declared_graph(load(options))
    if options.folder is not None:
        return _seen(str(options.folder), read_journal(options.folder), options.on)
    return _seen(options.connect, _standing(options), options.on)


def _standing(options: argparse.Namespace) -> list[JournalLine]:
    from blackboard.link.session import open_session

    with open_session(link_params(options)) as session:
        answers = session.ask("ski/**")
    lines = []
    for answer in answers:
        try:
            lines.append(read_payload(answer.key, answer.payload))
        except MessageError:
            continue
    return lines


def _seen(title: str, lines: Iterable[JournalLine], robot: str | None) -> BoardGraph:
    """Return the graph of one robot's lines; where they are in memory only while they are looked at, they are read once."""
    hosts: dict[str, str] = {}
    robots: dict[str, None] = {}

    def ours() -> Iterable[JournalLine]:
        for line in lines:
            name = line.key.split("/")[1]
            robots[name] = None
            if robot is None or name == robot:
                if path_of(line.key) == HOST.path:
                    hosts.update(dict.fromkeys(_components(line), line.key.rsplit("/", 1)[1]))
                yield line

    graph = observed_graph(title, ours(), hosts)
    if robot is None and len(robots) > 1:
        raise BoardError(f"{title} has the boards of {', '.join(sorted(robots))}; choose one with --on ROBOT")
    return graph


def _components(line: JournalLine) -> tuple[str, ...]:
    try:
        return msgspec.json.decode(line.value, type=HostStatus).components
    except (msgspec.DecodeError, UnicodeDecodeError):
        return ()
