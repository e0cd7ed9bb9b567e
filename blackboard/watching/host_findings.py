"""Findings about hosts: gone, hanging, late, missing, twice."""

from collections.abc import Iterator

from blackboard.watching.finding import DoctorParams, Finding, listed, many
from blackboard.watching.setup_facts import HostFacts, SetupFacts


def host_findings(facts: SetupFacts, params: DoctorParams) -> Iterator[Finding]:
    """Yield what is wrong with each host."""
    versions = facts.keeper.version if facts.keeper is not None and facts.keeper.version else facts.version
    for host in facts.hosts:
        if host.state == "dead":
            yield Finding(
                about="host dead",
                what=f"{host.called} is gone (killed, frozen or cut off) with {listed(host.components) or 'all that it ran'}",
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
            if host.lacking and not (facts.keeper is not None and facts.keeper.journal_trouble):  # which explains it
                yield _lacking(host)


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
            what=f"{host.called} was too slow: {many(host.missed, 'entry')} could not be had any more",
            do="give it less to do or a faster machine; what stands it has again, by a snapshot",
        )


def _lacking(host: HostFacts) -> Finding:
    return Finding(
        about="missing entries",
        what=f"the keeper has not got {many(host.lacking, 'entry')} that {host.called} sent",
        do="look at the network between them; the host sends them again until the keeper has them",
    )


def component_findings(facts: SetupFacts, params: DoctorParams) -> Iterator[Finding]:
    """Yield what runs nowhere or twice."""
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
    told = {(host.robot, component) for host in facts.hosts if host.state == "dead" for component in host.components}
    running = at.keys() | told
    missing: dict[str, list[str]] = {}
    for key, name in facts.expected.items():
        robot, _, component = key.rpartition("/")
        if not any(there == component and robot in ("", where) for where, there in running):
            missing.setdefault(name, []).append(component)
    for name, components in sorted(missing.items()):
        yield Finding(
            about="host missing",
            what=f"nobody runs {listed(tuple(components))}, which host {name} should",
            do=f"start it: `ski host MISSION --name {name}`, or all with `ski up MISSION`",
        )
