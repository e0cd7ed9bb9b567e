"""When a robot's sensors are due, and its readings until somebody asks for them."""

from collections.abc import Mapping
from math import ceil
from typing import Any

from blackboard.component import Reading
from sim.kept_state import as_record
from sim.sensor_models import TICKS_PER_S


class Schedule:
    """Counts the readings of each sensor, and holds back those that come late."""

    def __init__(self) -> None:
        self._counts: dict[tuple[str, int], int] = {}
        self._late: list[tuple[int, Reading[Any]]] = []
        self._come: list[tuple[int, Reading[Any]]] = []  # by the step in which they came

    def state(self) -> object:
        """Return all of it, to be pickled at once."""
        return dict(vars(self))

    def resume(self, state: object) -> None:
        """Go on from a state."""
        vars(self).update(as_record(state))

    def skip(self, rates_hz: Mapping[tuple[str, int], float], tick: int) -> None:
        """Begin after a step as if all that was due until then had come."""
        self._counts = {sensor: ceil((tick + 1) / TICKS_PER_S * hz) for sensor, hz in rates_hz.items()}

    def is_due(self, sensor: str, number: int, rate_hz: float, tick: int) -> bool:
        """Say whether a sensor's next reading is due, and count it."""
        count = self._counts.get((sensor, number), 0)
        if tick < round(count * TICKS_PER_S / rate_hz):
            return False
        self._counts[(sensor, number)] = count + 1
        return True

    def give(self, reading: Reading[Any], tick: int, latency_s: float = 0.0) -> None:
        """Take a reading of this step."""
        if latency_s > 0.0:
            self._late.append((tick + round(latency_s * TICKS_PER_S), reading))
        else:
            self._come.append((tick, reading))

    def give_late(self, tick: int) -> None:
        """Let those come that were held back until this step."""
        if self._late:
            self._come += [(tick, reading) for due, reading in self._late if due <= tick]
            self._late = [(due, reading) for due, reading in self._late if due > tick]

    def take(self, last: int) -> list[Reading[Any]]:
        """Return what came up to a step and was not yet asked for."""
        taken = [reading for tick, reading in self._come if tick <= last]
        self._come = [(tick, reading) for tick, reading in self._come if tick > last]
        return taken
