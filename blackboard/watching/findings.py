"""What is wrong with a setup, and what to do about it: from facts to findings, nothing is asked or measured here."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass

from blackboard.parameters import require
from blackboard.watching.setup_facts import HostFacts, RobotFacts, SetupFacts, StreamFacts
from blackboard.watching.summary import printable


@dataclass(frozen=True, slots=True, kw_only=True)
class DoctorParams:
    """From where on something counts as wrong."""

    clock_limit_s: float = 0.5  # stamps of recordings and logs of two machines can no longer be laid side by side
    silent_s: float = 3.0  # so long nothing at least,
    silent_intervals: float = 20.0  # and so many times as long as it took from one to the next until then
    silent_after: int = 20  # one that has happened less often has no rhythm yet

    def __post_init__(self) -> None:
        require(0 < self.clock_limit_s <= 3600, "clock_limit_s", self.clock_limit_s, "(0, 3600] seconds")
        require(0 < self.silent_s <= 3600, "silent_s", self.silent_s, "(0, 3600] seconds")
        require(self.silent_intervals >= 1, "silent_intervals", self.silent_intervals, "1 and more")
        require(self.silent_after >= 2, "silent_after", self.silent_after, "2 and more")


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing that is wrong, each in one line: what it is, and what to do."""

    about: str  # the same word for the same kind of trouble, for programs
    what: str
    do: str

    def as_dict(self) -> dict[str, str]:
        """Return the same as plain data, for JSON."""
        return {name: printable(text) for name, text in asdict(self).items()}


Rule = Callable[[SetupFacts, DoctorParams], Iterator[Finding]]


def findings(facts: SetupFacts, params: DoctorParams | None = None) -> list[Finding]:
    """Return all that is wrong, what stands in the way of everything else first."""
    params = params or DoctorParams()
    unreached = list(_link(facts))
    return unreached or [found for rule in _RULES for found in rule(facts, params)]


def _link(facts: SetupFacts) -> Iterator[Finding]:
    address, said = facts.address, f" ({facts.trouble})" if facts.trouble else ""
    if facts.answers == "nobody":
        yield Finding(
            about="nothing running",
            what=f"nothing listens at {address}{said}",
            do="start all with `ski up MISSION`, or a keeper with `ski board serve`; if it runs elsewhere, --connect ADDRESS",
        )
    elif facts.answers == "something else":
        yield Finding(
            about="wrong port",
            what=f"what listens at {address} is no board keeper and speaks no zenoh{said}",
            do="choose another port for the keeper (`ski board serve --listen ADDRESS`) and name it with --connect ADDRESS",
        )
    elif facts.answers == "certificates":
        yield Finding(
            about="certificate",
            what=f"the keeper at {address} takes members with certificates only{said}",
            do="connect to tls/HOST:PORT with --keys DIR; `ski keys` makes certificates",
        )
    elif facts.answers == "refused":
        yield Finding(
            about="certificate",
            what=f"the keeper at {address} and these keys do not accept each other{said}",
            do="use keys made by this keeper's own authority that have not expired; `ski keys` makes new ones",
        )
    elif facts.answers == "a router" or facts.keeper is None:
        yield Finding(
            about="no keeper",
            what=f"a zenoh router listens at {address}, and no board keeper answers there{said}",
            do="stop that router or leave it its port, and start `ski board serve`; with keys, see that they may read",
        )


def _keeper(facts: SetupFacts, params: DoctorParams) -> Iterator[Finding]:
    keeper = facts.keeper
    assert keeper is not None
    if keeper.version and keeper.version != facts.version:
        yield Finding(
            about="version difference",
            what=f"the keeper is ski {keeper.version}, this is ski {facts.version}",
            do="install one version everywhere and start what is older anew",
        )
    if keeper.journal_trouble:
        yield Finding(
            about="journal",
            what=f"the keeper cannot write its journal in {keeper.folder or 'its folder'}: {keeper.journal_trouble}",
            do="free some space there: it goes on by itself, and the hosts keep what it has not got until then",
        )
    for reason, count in sorted(keeper.refused.items()):
        example = keeper.refused_example.get(reason, "")
        yield Finding(
            about="rejected writer",
            what=f"the keeper refused {_many(count, 'post')} ({reason})"
            + (f", the last: {example}" if example else ""),
            do="mend or stop who posts it; refused.jsonl in the keeper's folder names every one",
        )
    for attempt, count in sorted(keeper.rejected.items()):
        yield Finding(
            about="rejected writer",
            what=f"the keeper turned away {_many(count, 'message')} that its sender's role does not allow ({attempt})",
            do="give the sender keys with the role that it needs: `ski keys`; or find out who tries",
        )
    if keeper.overflowed:
        yield Finding(
            about="slow reader",
            what=f"the keeper could not keep up and dropped {_many(keeper.overflowed, 'message')}, which are sent again",
            do="give its machine less to do, or post less: `ski watch --sort rate` shows who posts most",
        )


def _hosts(facts: SetupFacts, params: DoctorParams) -> Iterator[Finding]:
    versions = facts.keeper.version if facts.keeper is not None and facts.keeper.version else facts.version
    for host in facts.hosts:
        if host.state == "dead":
            yield Finding(
                about="host dead",
                what=f"{host.called} is gone (killed, frozen or cut off) with {_listed(host.components) or 'all that it ran'}",
                do=f"if it does not come back, `ski ps` names its log; start it again with `ski host MISSION --name {host.name}`",
            )
        elif host.state == "hung":
            yield Finding(
                about="host hung",
                what=f"{host.called} is linked and its loop stands still",
                do="if it was stopped, let it go on (kill -CONT); else kill it and start it again",
            )
        if host.state in ("alive", "hung"):
            yield from _linked_host(host, versions, params)


def _linked_host(host: HostFacts, version: str, params: DoctorParams) -> Iterator[Finding]:
    if host.version and host.version != version:
        yield Finding(
            about="version difference",
            what=f"{host.called} is ski {host.version}, the keeper is ski {version}",
            do="install one version everywhere and start what is older anew",
        )
    if abs(host.offset_s) > params.clock_limit_s + host.round_trip_s / 2:
        side = "ahead of" if host.offset_s > 0 else "behind"
        yield Finding(
            about="clock difference",
            what=f"the clock of {host.called} is {abs(host.offset_s):.2f} s {side} the keeper's",
            do="let both machines follow a time server (chrony, systemd-timesyncd); the mission's own clock is not touched by it",
        )
    if host.boots > 1:
        yield Finding(
            about="two of one",
            what=f"{host.boots} processes are linked as host {host.name}",
            do="stop all but one, or give them names of their own in [hosts]",
        )
    if host.missed:
        yield Finding(
            about="slow reader",
            what=f"{host.called} was too slow: {_many(host.missed, 'entry')} could not be had any more",
            do="give it less to do or a faster machine; what stands it has again, by a snapshot",
        )
    if host.lacking:
        yield Finding(
            about="missing entries",
            what=f"the keeper has not got {_many(host.lacking, 'entry')} that {host.called} sent",
            do="look at the network between them; the host sends them again until the keeper has them",
        )


def _components(facts: SetupFacts, params: DoctorParams) -> Iterator[Finding]:
    if facts.keeper is not None and not any(host.state in ("alive", "hung") for host in facts.hosts):
        yield Finding(
            about="no hosts",
            what="the keeper runs, and no host does",
            do="start a mission: `ski up MISSION`, or its hosts one by one: `ski host MISSION --name NAME`",
        )
    at: dict[tuple[str, str], list[str]] = {}
    for host in facts.hosts:
        if host.state in ("alive", "hung"):
            for component in host.components:
                at.setdefault((host.robot, component), []).append(host.name)
    for (robot, component), names in sorted(at.items()):
        if len(names) > 1:
            yield Finding(
                about="two of one",
                what=f"{component} of {robot} runs in {' and '.join(sorted(names))}: each posts over the other",
                do="stop one of them, or name it in one [hosts] table only",
            )
    told = {component for host in facts.hosts if host.state == "dead" for component in host.components}
    running = {component for _, component in at} | told
    missing: dict[str, list[str]] = {}
    for component, name in facts.expected.items():
        if component not in running:
            missing.setdefault(name, []).append(component)
    for name, components in sorted(missing.items()):
        yield Finding(
            about="host missing",
            what=f"nobody runs {_listed(tuple(components))}, which host {name} should",
            do=f"start it: `ski host MISSION --name {name}`, or all with `ski up MISSION`",
        )


def _boards(facts: SetupFacts, params: DoctorParams) -> Iterator[Finding]:
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
        if host is not None and source.wakers_came and _is_silent(source, silent_s, params):
            yield Finding(
                about="silent source",
                what=f"{source.name} in {host.called} has done nothing for {silent_s:.0f} s, though {source.woken_by} comes",
                do="`ski get control/agenda` shows what waits before it, `ski get control/focus` whether a rule lets it rest",
            )


def _is_silent(stream: StreamFacts, silent_s: float, params: DoctorParams) -> bool:
    """Say whether a stream that had a rhythm has lost it; a clock that begins far from 0 makes no rhythm too short."""
    if stream.count < params.silent_after:
        return False
    interval_s = max(0.0, stream.stamp_s) / stream.count
    return silent_s > max(params.silent_s, params.silent_intervals * interval_s)


def _many(count: int, what: str) -> str:
    return f"1 {what}" if count == 1 else f"{count} {what[:-1]}ies" if what.endswith("y") else f"{count} {what}s"


def _listed(names: tuple[str, ...], most: int = 4) -> str:
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


_RULES: tuple[Rule, ...] = (_keeper, _hosts, _components, _boards)
