"""The mission's clock across processes: kept by the keeper, read here from this process's own clock and an offset.

The offset is measured by round trips: the keeper's answer is taken for the middle of the way there and back, and of the last
measurements the one with the shortest way counts (as NTP's clock filter does).
"""

from collections import deque
from dataclasses import dataclass
from typing import Annotated

import msgspec

from blackboard.errors import LinkError
from blackboard.messages.base import Seconds

KEPT = 8  # measurements: a clock drifts by less than a millisecond while so many are taken
MEASURE_EVERY_S = 2.0
CLOCK_OFF_S = 0.5  # a wall clock further off than this is told: logs of two machines cannot be compared any more


class ClockAnswer(msgspec.Struct, kw_only=True, frozen=True):
    """The keeper's answer: the mission's clock (None: nobody has begun it), its own wall clock, and mission seconds per second."""

    now_s: Seconds | None
    wall_s: Seconds
    pace: Annotated[float, msgspec.Meta(gt=0.0, le=1e4)] = 1.0


class ClockQuestion(msgspec.Struct, kw_only=True, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Ask for the clock; the robot's host begins it: at `begin`, with `pace`."""

    begin: float | None = None
    pace: float = 1.0


@dataclass(frozen=True, slots=True)
class Measurement:
    """One round trip, on this process's monotonic clock, and what it says."""

    round_trip_s: float
    zero_s: float  # the mission's clock where the monotonic clock is 0, as of `pace`
    wall_offset_s: float  # this host's wall clock minus the keeper's


class MissionClock:
    """The mission's clock, never running back."""

    def __init__(self) -> None:
        self._measured: deque[Measurement] = deque(maxlen=KEPT)
        self._pace = 1.0
        self._now_s = float("-inf")
        self.began_wall_s: float | None = None  # when it was 0, by the keeper's wall clock: each run has another

    def measured(self, asked_s: float, came_s: float, wall_s: float, answer: ClockAnswer) -> None:
        """Take in an answer: asked and come by the monotonic clock, and this host's wall clock when it came."""
        middle_s = 0.5 * (asked_s + came_s)
        if answer.now_s is None:
            return
        self.began_wall_s = answer.wall_s - answer.now_s / answer.pace
        if answer.pace != self._pace:
            self._measured.clear()
            self._pace = answer.pace
        wall_offset_s = wall_s - (came_s - middle_s) - answer.wall_s
        self._measured.append(Measurement(came_s - asked_s, answer.now_s - answer.pace * middle_s, wall_offset_s))

    @property
    def running(self) -> bool:
        """Say whether the mission's clock has begun."""
        return bool(self._measured)

    @property
    def pace(self) -> float:
        """Mission seconds per second."""
        return self._pace

    @property
    def best(self) -> Measurement:
        """The measurement that counts; raise LinkError before there is one."""
        if not self._measured:
            raise LinkError("the mission's clock has not begun: the robot's host begins it")
        return min(self._measured, key=lambda m: m.round_trip_s)

    def at(self, monotonic_s: float) -> float:
        """Return the mission's clock at a time of this process's monotonic clock."""
        self._now_s = max(self._now_s, self.best.zero_s + self._pace * monotonic_s)
        return self._now_s


def clock_is_off(wall_offset_s: float) -> str:
    """Return what to say of a machine whose wall clock is off; the mission's own clock does not depend on it."""
    way = "ahead of" if wall_offset_s > 0 else "behind"
    return f"its clock is {abs(wall_offset_s):.1f} s {way} the keeper's; set it by NTP"
