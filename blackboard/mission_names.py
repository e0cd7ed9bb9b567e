"""The names in a mission: each one once, and those that behaviours name where they must stand."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from blackboard.errors import MissionError, did_you_mean
from blackboard.key_expressions import is_chunk

if TYPE_CHECKING:
    from blackboard.mission import Mission, Spec


def check_names(mission: "Mission", tables: Sequence[str]) -> None:
    """Raise MissionError with file and line where a name is taken, unknown, or out of order; `tables` are those of a mission."""
    seen: dict[str, Spec] = {}
    for spec in (*mission.team, *mission.knowledge_sources, *mission.behaviours):
        if spec.name in seen or spec.name in tables:
            key = "name" if spec in mission.team else "use"
            raise MissionError(f"{spec.place.at(key)}: the name '{spec.name}' is taken; give this one a name = '...'")
        seen[spec.name] = spec
    order = [spec.name for spec in mission.behaviours]
    for place, spec in enumerate(mission.behaviours):
        for other in spec.wiring.inhibits:
            if other not in order:
                raise MissionError(
                    f"{spec.place.at('inhibits')}: there is no behaviour '{other}'{did_you_mean(other, order)}"
                )
            if order.index(other) <= place:
                raise MissionError(
                    f"{spec.place.at('inhibits')}: '{spec.name}' must stand before '{other}', which it inhibits; move it up"
                )
    for spec in mission.behaviours:
        level = spec.wiring.level
        if level and (level in seen or not is_chunk(level)):
            raise MissionError(
                f"{spec.place.at('level')}: level = '{level}' must be letters, digits, '_', '-', and no component's name"
            )
    if mission.behaviours and mission.coordinator is None:
        raise MissionError(
            f"{mission.path}: behaviours need a [coordinator]; add use = 'behaviours.superposition:Superposition'"
        )
