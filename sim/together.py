"""Simulated robots in one world: time passes for all of them at once, step by step.

In each step the world changes and people walk, then the robots drive, in their order, then all sense. Who drives later finds the
others where they have gone to already: 13 mm on at 0.5 m/s.
"""

from collections.abc import Sequence
from math import floor
from typing import Protocol

from sim.sensor_models import TICKS_PER_S
from sim.surroundings import Surroundings


class Member(Protocol):
    """What a robot does in each step."""

    def surroundings(self) -> Surroundings:
        """Return its world as it is at first, with nobody's robot in it."""

    def enter(self, around: Surroundings) -> None:
        """Stand at the start, in these surroundings."""

    def move(self, dt_s: float) -> None:
        """Drive."""

    def sense(self, tick: int) -> None:
        """Take the readings that are due, and keep them until asked for."""


class Together:
    """The robots of a world and its time. The world is that of the first."""

    def __init__(self, members: Sequence[Member]) -> None:
        self.members = members
        self.begin()

    def begin(self) -> None:
        """Begin anew: the same again, for all."""
        self.around = self.members[0].surroundings()
        self.tick = -1
        for member in self.members:
            member.enter(self.around)

    def advance(self, until_s: float) -> int:
        """Let time pass for all until `until_s`, where it has not yet; return the step which that is."""
        last = floor(until_s * TICKS_PER_S + 1e-6)
        dt_s = 1.0 / TICKS_PER_S
        for tick in range(self.tick + 1, last + 1):
            self.tick = tick
            if tick:
                self.around.pass_time(tick / TICKS_PER_S, dt_s)
                for member in self.members:
                    member.move(dt_s)
            for member in self.members:
                member.sense(tick)
        return last
