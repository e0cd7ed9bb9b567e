"""What a mission's rules may act on, told from the mission file without building the mission."""

from contextlib import suppress

from blackboard.component import Behaviour, KnowledgeSource, Parts
from blackboard.errors import MissionError
from blackboard.mission import Mission, load_mission, shipped_missions
from blackboard.vocabulary import Vocabulary


def parts_of(mission: Mission) -> Parts:
    """Return the behaviours, levels and knowledge sources of a mission."""
    behaviours = {
        spec.name: (tuple(spec.type.parameters), spec.type.optional)
        for spec in mission.behaviours
        if issubclass(spec.type, Behaviour)
    }
    sources = {
        spec.name: spec.type.rating if spec.rating is None else spec.rating
        for spec in mission.knowledge_sources
        if issubclass(spec.type, KnowledgeSource)
    }
    kinds = [
        kind for spec in mission.knowledge_sources if issubclass(spec.type, KnowledgeSource) for kind in spec.type.posts
    ]
    levels = list(dict.fromkeys(spec.wiring.level for spec in mission.behaviours if spec.wiring.level))
    return Parts(behaviours, levels, sources, Vocabulary(kinds), {})


def complete_missions() -> dict[str, Mission]:
    """Return the shipped missions that need nothing from a command line (such as the recording to play), by name."""
    found: dict[str, Mission] = {}
    for name, path in shipped_missions().items():
        with suppress(MissionError):
            found[name] = load_mission(path)
    return found


def parts_of_all() -> Parts:
    """Return what the shipped missions have together."""
    every = [parts_of(mission) for mission in complete_missions().values()]
    return Parts(
        behaviours={name: takes for parts in every for name, takes in parts.behaviours.items()},
        levels=list(dict.fromkeys(level for parts in every for level in parts.levels)),
        sources={name: rating for parts in every for name, rating in parts.sources.items()},
        vocabulary=Vocabulary([kind for parts in every for kind in parts.vocabulary]),
        owners={},
    )
