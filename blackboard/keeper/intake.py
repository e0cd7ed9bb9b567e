"""What zenoh's threads leave for the keeper's own loop: bounded, so that a flood costs the flooder's posts and not the keeper."""

from threading import Condition
from typing import Generic, TypeVar

T = TypeVar("T")


class Intake(Generic[T]):
    """A queue of so many things and bytes; `put` from any thread, `drain` from one."""

    def __init__(self, limit: int, limit_bytes: int) -> None:
        self._limit = limit
        self._limit_bytes = limit_bytes
        self._items: list[T] = []
        self._bytes = 0
        self._ready = Condition()
        self._waiting = False
        self.overflowed = 0  # dropped, since too much was waiting

    def put(self, item: T, size_bytes: int = 0) -> None:
        """Leave something; where too much waits already, it is dropped and counted."""
        with self._ready:
            if len(self._items) >= self._limit or self._bytes + size_bytes > self._limit_bytes:
                self.overflowed += 1
                return
            self._items.append(item)
            self._bytes += size_bytes
            if self._waiting:
                self._ready.notify()

    def drain(self, wait_s: float) -> list[T]:
        """Return all that has come, in order; wait for the first for so long."""
        with self._ready:
            if not self._items:
                self._waiting = True
                self._ready.wait(wait_s)
                self._waiting = False
            items, self._items = self._items, []
            self._bytes = 0
            return items
