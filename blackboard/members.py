"""The robots of a mission: to each a mission of its own, all in one world."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from blackboard.component import Robot
from blackboard.errors import MissionError, did_you_mean
from blackboard.mission import Mission, Spec


def members(mission: Mission) -> tuple[Mission, ...]:
    """Return the mission of each robot, in order: its own components and random numbers, and nothing of the others.

    A mission with one robot is its own and only member.
    """
    return tuple(_of(mission, robot) for robot in mission.team) or (mission,)


def member(mission: Mission, robot: str) -> Mission:
    """Return the mission of one robot by its name; raise MissionError where there is none."""
    for spec in mission.team:
        if spec.name == robot:
            return _of(mission, spec)
    raise MissionError(
        f"{mission.path}: there is no robot '{robot}'{did_you_mean(robot, [s.name for s in mission.team])}"
    )


def share_world(missions: Sequence[Mission], robots: Sequence[Robot[Any]]) -> None:
    """Let the robots of these missions, one for each, share the first one's world.

    Raises MissionError with file and line where they cannot.
    """
    for mission, robot in list(zip(missions, robots, strict=True))[1:]:
        try:
            robot.join(robots[0])
        except MissionError as error:
            raise mission.robot.refused(error) from None


def _of(mission: Mission, robot: Spec) -> Mission:
    def its(spec: Spec | None) -> Spec | None:
        return replace(spec, of=robot.name) if spec is not None else None

    return replace(
        mission,
        team=(),
        robot=replace(robot, of=robot.name),
        knowledge_sources=tuple(replace(spec, of=robot.name) for spec in mission.knowledge_sources),
        behaviours=tuple(replace(spec, of=robot.name) for spec in mission.behaviours),
        coordinator=its(mission.coordinator),
        rules=its(mission.rules),
        safety=its(mission.safety),
    )
