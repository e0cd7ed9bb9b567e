"""The kinds of entries that missions may post, as far as the keeper must know them."""

from collections.abc import Iterator, Sequence
from typing import Any

from blackboard.mission import find_mission, load_mission
from blackboard.toml_file import read_toml
from blackboard.vocabulary import Vocabulary

SHIPPED = ("knowledge_sources.", "behaviours.", "rules.", "sim.")  # their kinds all stand in blackboard.kinds


def mission_vocabulary(names: Sequence[str]) -> Vocabulary:
    """Return the kinds of all missions together; raise MissionError or BoardError where they do not fit.

    Components are loaded only where somebody else's are among them: a keeper that was killed must be back soon.
    """
    kinds = []
    for path in map(find_mission, names):
        if all(use.startswith(SHIPPED) for use in uses(read_toml(path).data)):
            continue
        from blackboard.assembly import assemble  # loads the world

        assembly = assemble(load_mission(path))
        kinds += list(assembly.vocabulary)
        assembly.robot.close()
    return Vocabulary(kinds)


def uses(table: Any) -> Iterator[str]:
    """Yield the classes that a mission file names, wherever they stand in it."""
    if isinstance(table, list):
        for item in table:
            yield from uses(item)
    elif isinstance(table, dict):
        for key, value in table.items():
            if key == "use" and isinstance(value, str):
                yield value
            else:
                yield from uses(value)
