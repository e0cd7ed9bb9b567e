"""When a trigger fires: what has come since it last did."""

from typing import Generic, TypeVar

from blackboard.component import Trigger
from blackboard.entry import Entry
from blackboard.messages.base import Message

M = TypeVar("M", bound=Message)


class Condition(Generic[M]):
    """A trigger with what it has seen since it last fired."""

    def __init__(self, trigger: Trigger[M]) -> None:
        self.trigger = trigger
        self._units = 0
        self._fired_s: float | None = None

    @property
    def state(self) -> tuple[int, float | None]:
        """What it has seen: units, and when it last fired."""
        return self._units, self._fired_s

    @state.setter
    def state(self, seen: tuple[int, float | None]) -> None:
        self._units, self._fired_s = seen

    def holds(self, entry: Entry[M], now_s: float) -> bool:
        trigger = self.trigger
        if not trigger.conditional:
            return True
        self._units += 1 if trigger.count is None else trigger.count(entry.value)
        if self._units < trigger.every:
            return False
        if self._fired_s is not None and now_s - self._fired_s < trigger.min_interval_s:
            return False
        if trigger.when is not None and not trigger.when(entry):
            return False
        self._units = 0
        self._fired_s = now_s
        return True
