"""What every recording gives, whatever its format: its sensors, its readings in the order of the file, and figures."""

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Generator
from dataclasses import dataclass

from blackboard.messages.sensing import LaserSensor, Odometry, SonarSensor
from sim.recordings.cones import Fan
from sim.recordings.ranges import Ranges


@dataclass(frozen=True, slots=True)
class Sweep:
    """One sweep of a laser; `ranges` as in `sim.recordings.ranges`, (fan.beams,)."""

    laser: int
    fan: Fan
    ranges: Ranges


@dataclass(frozen=True, slots=True)
class Echoes:
    """What some or all sonars heard together: `ranges[i]` is that of sonar number `sensors[i]`."""

    sensors: tuple[int, ...]
    ranges: Ranges


@dataclass(frozen=True, slots=True)
class Heard:
    """One thing that a recording holds, with its repaired stamp on the recording's clock."""

    stamp_s: float
    value: Odometry | Sweep | Echoes


class Recording(ABC):
    """A recording that was looked through once: it can be read, and its sensors and stamps are known.

    `fans[i]` says where the beams of laser i look. `first_s` and `last_s` give the first and last repaired stamp of each type
    of value. `counts` grows while `replay` runs; `notes` says what a user should know of how the file was taken.
    """

    def __init__(self) -> None:
        self.sonars: tuple[SonarSensor, ...] = ()
        self.lasers: tuple[LaserSensor, ...] = ()
        self.fans: tuple[Fan, ...] = ()
        self.first_s: dict[type[Odometry | Sweep | Echoes], float] = {}
        self.last_s: dict[type[Odometry | Sweep | Echoes], float] = {}
        self.counts: Counter[str] = Counter()
        self.notes: list[str] = []

    @abstractmethod
    def replay(self) -> Generator[Heard, None, None]:
        """Yield what was recorded, in the file's order; stamps never run back within one sensor."""

    def saw(self, type_: type[Odometry | Sweep | Echoes], first_s: float, last_s: float) -> None:
        """Note from when to when values of a type come."""
        self.first_s[type_] = min(first_s, self.first_s.get(type_, first_s))
        self.last_s[type_] = max(last_s, self.last_s.get(type_, last_s))
