"""Who holds an executor, and when it is let go (Andersson 1999, section 8.2).

A manager is gone when it is silent for `lease_s` while the way to it is open: the keeper's heartbeats come. While they do not (the
keeper restarts, the network is cut) nothing can be known of it, and the executor holds out for `cut_s`.
"""

from dataclasses import dataclass

from blackboard.parameters import require

OPEN_S = 0.6  # the keeper's heartbeats come 5 times a second; less than the shortest hang_s, or who falls silent with it would hang
LONGEST_TICK_S = 0.5  # a longer one is this process's own silence


@dataclass(frozen=True, slots=True, kw_only=True)
class LeashParams:
    """How long an executor goes on without its manager."""

    lease_s: float = 10.0
    cut_s: float = 30.0  # a keeper is back within seconds; a robot alone for longer is nobody's

    def __post_init__(self) -> None:
        require(1.0 <= self.lease_s <= 3600, "lease_s", self.lease_s, "[1, 3600] seconds")
        require(1.0 <= self.cut_s <= 86_400, "cut_s", self.cut_s, "[1, 86400] seconds")


@dataclass(frozen=True, slots=True, kw_only=True)
class Leash:
    """The manager that holds an executor (empty: none), and for how long it and the keeper have been silent."""

    manager: str = ""
    silent_s: float = 0.0
    keeper_silent_s: float = 0.0

    @property
    def open(self) -> bool:
        """Say whether heartbeats could come."""
        return self.keeper_silent_s < OPEN_S


def passed(leash: Leash, tick_s: float) -> Leash:
    """Return the leash a tick later, nothing having been heard meanwhile."""
    tick_s = min(tick_s, LONGEST_TICK_S)
    silent_s = leash.silent_s + (tick_s if leash.open else 0.0)
    return Leash(manager=leash.manager, silent_s=silent_s, keeper_silent_s=leash.keeper_silent_s + tick_s)


def let_go(leash: Leash, params: LeashParams) -> str:
    """Return why an executor is to let go of everything; empty while it is held or free."""
    if not leash.manager:
        return ""
    if leash.silent_s > params.lease_s:
        return f"the manager was silent for {leash.silent_s:.0f} s"
    if leash.keeper_silent_s > params.cut_s:
        return f"the keeper was silent for {leash.keeper_silent_s:.0f} s"
    return ""
