"""Checks who posts and who reads, before anything runs: a mission whose parts do not fit is refused with one line."""

from collections.abc import Sequence
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from typing import Any

from blackboard import kinds
from blackboard.component import Behaviour, KnowledgeSource, Planner, Robot, SafetyLayer
from blackboard.control import as_triggers
from blackboard.errors import MissionError, did_you_mean
from blackboard.kinds import Kind
from blackboard.vocabulary import Vocabulary, core_kinds

RUNNER_POSTS = (
    kinds.ROBOT,
    kinds.RESPONSE,
    kinds.SWITCH,
    kinds.VELOCITY,
    kinds.DRIVE,
    kinds.BEHAVIOUR,
    kinds.COMPONENT,
    kinds.AGENDA,
    kinds.ACTIVATION,
    kinds.ACTIVATION_TIME,
)
FOR_SCORES = (kinds.TRUE_POSE, kinds.ROBOT_SUMMARY)


def check_wiring(
    robot: Robot[Any],
    sources: Sequence[KnowledgeSource[Any]],
    behaviours: Sequence[Behaviour[Any]],
    safety: SafetyLayer[Any] | None,
    planner: Planner[Any] | None = None,
) -> Vocabulary:
    """Return the mission's vocabulary, or raise MissionError.

    Refused are: a kind that nothing declares or posts, two posters of one slot, a source none of whose triggers is ever posted
    (a reading that this robot lacks is allowed beside one that it has), and a ring of triggers without any condition.
    """
    posted = posters(robot, sources, planner)
    known = {kind.path for kind in core_kinds()} | set(posted)
    for source in sources:
        triggers = as_triggers(source)
        if not triggers:
            raise MissionError(f"{source.name} has no triggers, so it would never run; declare some")
        silent = [t.kind for t in triggers if t.kind.path not in posted]
        for kind in silent:
            if len(silent) == len(triggers) or kind.level != "signal":
                raise MissionError(
                    f"{source.name} waits for '{kind.path}', which nobody in this mission posts"
                    f"{did_you_mean(kind.path, posted)}"
                )
    readers = [*sources, *behaviours, *([safety] if safety is not None else [])]
    for reader in readers:
        for kind in reader.reads:
            if kind.path not in known:
                raise MissionError(
                    f"{reader.name} reads the unknown kind '{kind.path}'{did_you_mean(kind.path, known)}"
                )
    for reader in readers:
        for kind in FOR_SCORES:
            if kind in reader.reads:
                raise MissionError(f"{reader.name} reads '{kind.path}', which no robot knows: it is for scores only")
    _check_rest(sources)
    declared: list[Kind[Any]] = [*robot.provides, *(kind for reader in readers for kind in reader.reads)]
    for source in sources:
        declared += [*source.posts, *(trigger.kind for trigger in as_triggers(source))]
    declared += planner.posts if planner is not None else []
    return Vocabulary(declared)


def posters(robot: Robot[Any], sources: Sequence[KnowledgeSource[Any]], planner: Planner[Any] | None) -> dict[str, str]:
    """Return who posts each kind, by its path; raise MissionError where two claim a kind that is not shared."""
    posted = {kind.path: "the runner" for kind in RUNNER_POSTS}
    claims = [(kind, robot.name) for kind in robot.provides]
    claims += [(kind, source.name) for source in sources for kind in source.posts]
    claims += [(kind, planner.name) for kind in planner.posts] if planner is not None else []
    for kind, name in claims:
        other = posted.get(kind.path)
        if other is not None and not kind.shared:
            raise MissionError(f"'{kind.path}' has two posters, {other} and {name}; leave one of them out")
        posted[kind.path] = name
    return posted


def _check_rest(sources: Sequence[KnowledgeSource[Any]]) -> None:
    """Refuse rings in which every trigger fires on every entry: they would never rest."""
    wakers: dict[str, dict[str, str]] = {source.name: {} for source in sources}  # woken: {waker: by which kind}
    for waker in sources:
        for woken in sources:
            for trigger in as_triggers(woken):
                if not trigger.conditional and trigger.kind in waker.posts:
                    wakers[woken.name][waker.name] = trigger.kind.path
    try:
        TopologicalSorter(wakers).prepare()
    except CycleError as error:
        ring = error.args[1]
        steps = " -> ".join(f"{a} ({wakers[b][a]})" for a, b in pairwise(ring))
        raise MissionError(
            f"{steps} -> {ring[-1]} would wake each other without end; "
            "give one of the triggers a condition (every, min_interval_s, when)"
        ) from None
