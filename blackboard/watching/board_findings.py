"""Findings about what stands on the boards: failures, and streams that fell silent."""

from collections.abc import Iterator

from blackboard.watching.finding import DoctorParams, Finding
from blackboard.watching.setup_facts import HostFacts, RobotFacts, SetupFacts, StreamFacts


def board_findings(facts: SetupFacts, params: DoctorParams) -> Iterator[Finding]:
    """Yield what is wrong on each robot's board."""
    for robot in facts.robots:
        for component, error in sorted(robot.failed.items()):
            yield Finding(
                about="component failed",
                what=f"{component} of {robot.name} has failed and is left out: {error or 'no reason given'}",
                do=f"`ski get status/component/{component} --json` shows what it worked on; mend it and start its host again",
            )
        yield from _rules_at_work(robot)
        for process, words in sorted(robot.given_up.items()):
            yield Finding(
                about="process given up",
                what=f"the process of host {process} ended too often and is not started again"
                + (f": {words}" if words else ""),
                do="`ski ps` names its log; mend what it says and start it with `ski up MISSION`",
            )
        linked = [host for host in facts.hosts if host.robot == robot.name and host.state == "alive"]
        if linked and robot.clock_s is None:
            yield Finding(
                about="no clock",
                what=f"the clock of {robot.name} has not begun: no host runs the robot",
                do="start the host that runs the robot; it begins the clock",
            )
        elif robot.clock_s is not None and robot.mission in ("", "underway"):
            yield from _silent(robot, robot.clock_s, linked, params)


def _rules_at_work(robot: RobotFacts) -> Iterator[Finding]:
    for rule, text in sorted(robot.rule_errors.items()):
        yield Finding(
            about="rule error",
            what=f"rule {rule} of {robot.name} went wrong: {text}",
            do=f"`ski get control/rule_error/{rule}` shows when; mend the rule file, a changed one takes over by itself",
        )
    for behaviour, waited_s in sorted(robot.unanswered.items()):
        yield Finding(
            about="no acknowledgement",
            what=f"{behaviour} of {robot.name} has not taken up what it was asked for {waited_s:.1f} s before",
            do="see that the host that runs the behaviours is alive and keeps up",
        )


def _silent(robot: RobotFacts, clock_s: float, linked: list[HostFacts], params: DoctorParams) -> Iterator[Finding]:
    for reading in robot.readings:
        silent_s = clock_s - reading.stamp_s
        if linked and _is_silent(reading, silent_s, params):
            yield Finding(
                about="silent source",
                what=f"{reading.name} of {robot.name} has not come for {silent_s:.0f} s",
                do="look at the robot, its sensor and the host that runs it",
            )
    for source in robot.activations:
        host = next((host for host in linked if source.name in host.components), None)
        silent_s = clock_s - source.stamp_s
        if source.name in robot.failed:
            continue
        if host is not None and source.wakers_came and not source.rests and _is_silent(source, silent_s, params):
            yield Finding(
                about="silent source",
                what=f"{source.name} in {host.called} has done nothing for {silent_s:.0f} s, though {source.woken_by} comes",
                do="`ski get control/agenda` shows what waits before it; if nothing does, start its host again",
            )


def _is_silent(stream: StreamFacts, silent_s: float, params: DoctorParams) -> bool:
    """Say whether a stream that had a rhythm has lost it; a clock that begins far from 0 makes no rhythm too short."""
    if stream.count < params.silent_after:
        return False
    interval_s = max(0.0, stream.stamp_s) / stream.count
    return silent_s > max(params.silent_s, params.silent_intervals * interval_s)
