"""Listening to a running board from a person's side: what comes waits in a bounded queue; this process never slows another."""

import time
from collections.abc import Iterator
from queue import Empty, Full, Queue

from blackboard.link.session import Arrived, Session

MOST_WAITING = 50_000  # messages; a terminal that is slower than the board loses what is beyond
LOOK_S = 0.5  # how often the link is looked at while nothing comes


class Listener:
    """What comes under a key expression, from now on."""

    def __init__(self, session: Session, expression: str, most: int = MOST_WAITING) -> None:
        self._session = session
        self._queue: Queue[Arrived] = Queue(most)
        self.dropped = 0  # what came faster than it was taken
        session.subscribe(expression, self._note)

    def take(self, timeout_s: float) -> list[Arrived]:
        """Return what waits; wait for the first for so long."""
        taken: list[Arrived] = []
        try:
            taken.append(self._queue.get(timeout=timeout_s))
            while True:
                taken.append(self._queue.get_nowait())
        except Empty:
            return taken

    def until(self, end_s: float | None) -> Iterator[Arrived | None]:
        """Yield what comes until `end_s` on the monotonic clock, for ever unless given; None now and then while nothing comes."""
        while True:
            left_s = LOOK_S if end_s is None else min(LOOK_S, end_s - time.monotonic())
            if left_s <= 0:
                return
            came = self.take(left_s)
            yield from came
            if not came:
                yield None

    @property
    def connected(self) -> bool:
        """Say whether the keeper is reached at this moment."""
        return self._session.connected

    def _note(self, arrived: Arrived) -> None:
        try:
            self._queue.put_nowait(arrived)
        except Full:
            self.dropped += 1
