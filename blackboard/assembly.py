"""A mission's components, built and checked against each other: for the embedded run and for every host of a linked one."""

from dataclasses import dataclass
from typing import Any

from blackboard.component import Behaviour, Coordinator, KnowledgeSource, Parts, Planner, Robot, SafetyLayer
from blackboard.mission import Mission, Wiring
from blackboard.vocabulary import Vocabulary
from blackboard.wiring import check_wiring, posters


@dataclass(frozen=True)
class Assembly:
    """All components of a mission for one robot, none of them on a board yet."""

    mission: Mission
    robot: Robot[Any]
    sources: list[KnowledgeSource[Any]]
    behaviours: list[tuple[Behaviour[Any], Wiring]]
    coordinator: Coordinator[Any] | None
    safety: SafetyLayer[Any] | None
    planner: Planner[Any] | None
    vocabulary: Vocabulary

    @property
    def switches_of(self) -> str | None:
        """Who may set the switches of the arbitration network: the planner where there is one."""
        return self.planner.name if self.planner is not None else None

    def parts(self) -> Parts:
        """Return what a planner may act on."""
        return Parts(
            behaviours={b.name: (b.parameters, b.optional) for b, _ in self.behaviours},
            levels=list(dict.fromkeys(wiring.level for _, wiring in self.behaviours if wiring.level)),
            sources={source.name: source.rating for source in self.sources},
            vocabulary=self.vocabulary,
            owners=posters(self.robot, self.sources, self.planner),
        )


def assemble(mission: Mission, seed: int = 0) -> Assembly:
    """Build a mission's components; raise MissionError where they do not fit together."""
    robot: Robot[Any] = mission.robot.build(seed)
    sources: list[KnowledgeSource[Any]] = []
    for spec in mission.knowledge_sources:
        source = spec.build(seed)
        if spec.rating is not None:
            source.rating = float(spec.rating)
        sources.append(source)
    behaviours = [(spec.build(seed), spec.wiring) for spec in mission.behaviours]
    coordinator = mission.coordinator.build(seed) if mission.coordinator is not None else None
    safety = mission.safety.build(seed) if mission.safety is not None else None
    planner: Planner[Any] | None = mission.rules.build(seed) if mission.rules is not None else None
    vocabulary = check_wiring(robot, sources, [b for b, _ in behaviours], safety, planner)
    return Assembly(mission, robot, sources, behaviours, coordinator, safety, planner, vocabulary)
