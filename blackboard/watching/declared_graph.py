"""The graph of a mission, from what its components declare; nothing runs."""

from collections.abc import Iterable
from typing import Any

from blackboard import kinds
from blackboard.component import Behaviour
from blackboard.control import CONTROL, as_triggers
from blackboard.kinds import Kind
from blackboard.mission import Mission
from blackboard.runner import Run
from blackboard.watching.board_graph import BoardGraph, Member, by_role

CONTROL_POSTS = (kinds.AGENDA, kinds.ACTIVATION, kinds.ACTIVATION_TIME, kinds.COMPONENT)


def declared_graph(mission: Mission) -> BoardGraph:
    """Return who posts and reads what in a mission; raise MissionError where its parts do not fit together."""
    run = Run(mission)
    try:
        return BoardGraph(title=mission.name, members=by_role(_members(mission, run)))
    finally:
        run.close()


def _members(mission: Mission, run: Run) -> list[Member]:
    robot, planner = run.robot, run.planning.planner if run.planning is not None else None
    moves = robot.moves and mission.safety is not None
    members = [
        _member(
            robot.name,
            "robot",
            reads=[kinds.DRIVE] if moves else [],
            posts=[*robot.provides, kinds.ROBOT],
        )
    ]
    for source in run.sources:
        woken_by = [trigger.kind for trigger in as_triggers(source)]
        members.append(_member(source.name, "knowledge source", woken_by, source.reads, source.posts))
    if planner is not None:
        members.append(_member(planner.name, "rules", reads=planner.reads, posts=planner.posts))
    members.append(_member(CONTROL, "control", reads=[kinds.FOCUS], posts=CONTROL_POSTS))
    return members + (_reflexes(mission) if moves else [])


def _reflexes(mission: Mission) -> list[Member]:
    members = []
    posts: list[Kind[Any]]
    for spec in mission.behaviours:
        behaviour: Behaviour[Any] = spec.build(0)
        adjusts = type(behaviour).adjusts is not Behaviour.adjusts
        posts = [kinds.RESPONSE, kinds.BEHAVIOUR, *([kinds.SWITCH] if adjusts else [])]
        members.append(_member(behaviour.name, "behaviour", reads=[kinds.MOTIVATION, *behaviour.reads], posts=posts))
    if mission.coordinator is not None:
        coordinator = mission.coordinator.build(0)
        wires = kinds.SWITCH in coordinator.reads and mission.rules is None  # else the switches belong to the rules
        posts = [kinds.VELOCITY, *([kinds.SWITCH] if wires else [])]
        reads = [kinds.RESPONSE, *coordinator.reads]
        members.append(_member(coordinator.name, "coordinator", reads=reads, posts=posts))
    if mission.safety is not None:
        safety = mission.safety.build(0)
        members.append(_member(safety.name, "safety layer", reads=[kinds.VELOCITY, *safety.reads], posts=[kinds.DRIVE]))
    return members


def _member(
    name: str,
    role: Any,
    woken_by: Iterable[Kind[Any]] = (),
    reads: Iterable[Kind[Any]] = (),
    posts: Iterable[Kind[Any]] = (),
) -> Member:
    woken = _paths(woken_by)
    read = tuple(path for path in _paths(reads) if path not in woken)
    return Member(name=name, role=role, woken_by=woken, reads=read, posts=_paths(posts))


def _paths(of: Iterable[Kind[Any]]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(kind.path for kind in of))
