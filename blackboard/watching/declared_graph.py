"""The graph of a mission, from what its components declare; nothing runs."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from blackboard import kinds
from blackboard.assembly import Assembly, assemble
from blackboard.component import Behaviour
from blackboard.control import CONTROL, as_triggers
from blackboard.kinds import Kind
from blackboard.mission import Mission
from blackboard.placement import placement
from blackboard.watching.board_graph import BoardGraph, Member, by_role

CONTROL_POSTS = (kinds.AGENDA, kinds.ACTIVATION, kinds.ACTIVATION_TIME, kinds.COMPONENT)


def declared_graph(mission: Mission) -> BoardGraph:
    """Return who posts and reads what in a mission, and on which host where its file says so.

    Raises MissionError where its parts do not fit together.
    """
    assembly = assemble(mission)
    try:
        if assembly.planner is not None:
            assembly.planner.start(assembly.parts())  # what it reads and posts follows from its rules
        members = [*_knowledge(assembly), *(_reflexes(assembly) if assembly.robot.moves else [])]
    finally:
        assembly.robot.close()
        if assembly.planner is not None:
            assembly.planner.close()
    hosts = hosts_of(mission) if mission.hosts else {}
    return BoardGraph(title=mission.name, members=by_role(replace(m, host=hosts.get(m.name, "")) for m in members))


def _knowledge(assembly: Assembly) -> list[Member]:
    robot, planner = assembly.robot, assembly.planner
    moves = robot.moves and assembly.safety is not None
    driven = [kinds.DRIVE] if moves else []
    members = [_member(robot.name, "robot", reads=driven, posts=[*robot.provides, kinds.ROBOT])]
    for source in assembly.sources:
        woken_by = [trigger.kind for trigger in as_triggers(source)]
        members.append(_member(source.name, "knowledge source", woken_by, source.reads, source.posts))
    if planner is not None:
        members.append(_member(planner.name, "rules", reads=planner.reads, posts=planner.posts))
    members.append(_member(CONTROL, "control", reads=[kinds.FOCUS], posts=CONTROL_POSTS))
    return members


def _reflexes(assembly: Assembly) -> list[Member]:
    members = []
    for behaviour, _ in assembly.behaviours:
        adjusts = type(behaviour).adjusts is not Behaviour.adjusts
        posts: list[Kind[Any]] = [kinds.RESPONSE, kinds.BEHAVIOUR, *([kinds.SWITCH] if adjusts else [])]
        members.append(_member(behaviour.name, "behaviour", reads=[kinds.MOTIVATION, *behaviour.reads], posts=posts))
    if assembly.coordinator is not None:
        coordinator = assembly.coordinator
        wires = kinds.SWITCH in coordinator.reads and assembly.planner is None  # else the switches belong to the rules
        posts = [kinds.VELOCITY, *([kinds.SWITCH] if wires else [])]
        reads: list[Kind[Any]] = [kinds.RESPONSE, *coordinator.reads]
        members.append(_member(coordinator.name, "coordinator", reads=reads, posts=posts))
    if assembly.safety is not None:
        safety = assembly.safety
        reads = [kinds.VELOCITY, *safety.reads]
        members.append(_member(safety.name, "safety layer", reads=reads, posts=[kinds.DRIVE]))
    return members


def hosts_of(mission: Mission, robot: str = "") -> dict[str, str]:
    """Return where each component runs, by its name: those of one robot, the first unless said, where there are several."""
    found: dict[str, str] = {}
    robot = robot or mission.robot.name
    for plan in placement(mission):
        if plan.of not in ("", robot):
            continue
        if plan.robot:
            found[robot] = plan.name
            found |= {mission.safety.name: plan.name} if mission.safety is not None else {}
        if plan.behaviours:
            found |= {spec.name: plan.name for spec in mission.behaviours}
            found |= {mission.coordinator.name: plan.name} if mission.coordinator is not None else {}
        if plan.rules and mission.rules is not None:
            found[mission.rules.name] = plan.name
        found |= dict.fromkeys(plan.sources, plan.name)
    return found


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
