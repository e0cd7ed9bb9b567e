"""How every host fares: linked or not by its liveliness token, hanging or not by its own beat.

A token that ends without a farewell means death, and is known within milliseconds; a token that stands while the beat stays away
means that the process hangs. Both are told once, when they change.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from msgspec.structs import replace

from blackboard.link.clock import CLOCK_OFF_S, clock_is_off
from blackboard.messages.hosts import HostBeat, HostStatus

MAX_HOSTS = 1000  # of one robot: a wrong program must not make one for each number it can think of
State = Literal["alive", "hung", "dead", "stopped"]


@dataclass
class Boot:
    """One start of a host."""

    name: str
    linked: bool = False
    heard_s: float = float("-inf")  # when something of it was last seen
    beat: HostBeat | None = None
    lanes: dict[str, int] = field(default_factory=dict)  # last number sent, as it says


@dataclass
class Host:
    """A host by its name: its boots that live, and the one that was heard of last."""

    boots: dict[str, Boot] = field(default_factory=dict)
    current: str = ""
    told: HostStatus | None = None


class HostWatch:
    """Watches the hosts of one robot. `now_s` is any clock that runs evenly."""

    def __init__(self, hung_s: float, starting_s: float) -> None:
        self._hung_s = hung_s
        self._starting_s = starting_s
        self._hosts: dict[str, Host] = {}
        self._looked_s = float("inf")

    def takes(self, host: str) -> bool:
        """Say whether a host is known, or one more can be."""
        return host in self._hosts or len(self._hosts) < MAX_HOSTS

    def linked(self, host: str, boot: str, alive: bool, now_s: float) -> None:
        """Take note of a liveliness token that came or ended."""
        known = self._boot(host, boot)
        if alive:
            self._hosts[host].current = boot
            known.heard_s = now_s
        known.linked = alive
        if not alive and self._hosts[host].current == boot:
            still = [b.name for b in self._hosts[host].boots.values() if b.linked]
            self._hosts[host].current = still[-1] if still else boot

    def beat(self, host: str, beat: HostBeat, now_s: float) -> None:
        """Take note of a host's beat."""
        known = self._boot(host, beat.boot)
        known.heard_s, known.beat, known.lanes = now_s, beat, dict(beat.lanes)
        self._hosts[host].current = beat.boot

    def restore(self, host: str, status: HostStatus, now_s: float) -> None:
        """Take up what stood of a host before the keeper's restart: it has until it would hang to show itself."""
        known = self._boot(host, status.boot)
        known.heard_s = now_s
        self._hosts[host].current = status.boot
        self._hosts[host].told = status

    def changes(self, now_s: float) -> Iterator[tuple[str, HostStatus]]:
        """Yield what is to be told anew, and take it as told. Who looks after a long absence of its own blames nobody for it."""
        away_s, self._looked_s = now_s - self._looked_s, now_s
        if away_s > self._hung_s:
            for _, boot in self.boots():
                boot.heard_s += away_s
        twice = self._components_twice()
        for name, host in self._hosts.items():
            status = self._status(host, twice, now_s)
            if status is not None and status != host.told and not _only_clocks_differ(status, host.told):
                host.told = status
                yield name, status

    def boots(self) -> Iterator[tuple[str, Boot]]:
        """Yield every boot that was heard of, with its host's name."""
        for name, host in self._hosts.items():
            for boot in host.boots.values():
                yield name, boot

    def statuses(self) -> dict[str, HostStatus]:
        """Return what was last told of each host."""
        return {name: host.told for name, host in self._hosts.items() if host.told is not None}

    def _boot(self, host: str, boot: str) -> Boot:
        boots = self._hosts.setdefault(host, Host()).boots
        if boot not in boots:
            boots[boot] = Boot(boot)
            gone = [b.name for b in boots.values() if not b.linked and b.name != boot]
            for old in gone[: max(0, len(boots) - 20)]:
                del boots[old]
        return boots[boot]

    def _status(self, host: Host, twice: dict[str, list[str]], now_s: float) -> HostStatus | None:
        boot = host.boots.get(host.current)
        if boot is None:
            return None
        told = host.told if host.told is not None and host.told.boot == boot.name else None
        state = self._state(boot, told, now_s)
        others = [b.name for b in host.boots.values() if b.linked and b is not boot]
        details = [f"another process has the same name, boot {name}" for name in others]
        beat = boot.beat
        if beat is None:
            return replace(
                told or HostStatus(state=state, boot=boot.name), state=state, detail="; ".join(details)[:4000]
            )
        if state == "alive":
            details += [f"{c} runs in {', '.join(twice[c])}" for c in beat.components if len(twice.get(c, ())) > 1]
        if abs(beat.offset_s) > CLOCK_OFF_S:
            details.append(clock_is_off(beat.offset_s))
        if beat.missed:
            details.append(f"{beat.missed} envelopes could not be had any more")
        return HostStatus(
            state=state,
            boot=boot.name,
            machine=beat.machine,
            pid=beat.pid,
            version=beat.version,
            components=beat.components,
            offset_s=round(beat.offset_s, 3),
            round_trip_s=round(beat.round_trip_s, 3),
            detail="; ".join(details)[:4000],
        )

    def _state(self, boot: Boot, told: HostStatus | None, now_s: float) -> State:
        silent_s = now_s - boot.heard_s
        if boot.linked:
            return "hung" if silent_s > (self._hung_s if boot.beat is not None else self._starting_s) else "alive"
        if (boot.beat is not None and boot.beat.leaving) or (told is not None and told.state == "stopped"):
            return "stopped"
        if boot.beat is None and told is not None and silent_s <= self._hung_s:
            return told.state  # the keeper was away, and it may still show itself
        return "dead"

    def _components_twice(self) -> dict[str, list[str]]:
        """Return which linked hosts run each component."""
        runs: dict[str, list[str]] = {}
        for name, host in self._hosts.items():
            boot = host.boots.get(host.current)
            if boot is not None and boot.linked and boot.beat is not None:
                for component in boot.beat.components:
                    runs.setdefault(component, []).append(name)
        return runs


def _only_clocks_differ(status: HostStatus, told: HostStatus | None) -> bool:
    """Say whether nothing but a little in the measured clock has changed: no news."""
    if told is None or abs(status.offset_s - told.offset_s) > 0.05:
        return False
    fields = ("state", "boot", "machine", "pid", "version", "components", "detail")
    return all(getattr(status, name) == getattr(told, name) for name in fields)
