"""Ctrl-C and SIGTERM for verbs that run until they are told to end."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def when_told_to_end(hear: Callable[[], None]) -> Iterator[None]:
    """Call `hear` at Ctrl-C and SIGTERM; afterwards they do again what they did before."""
    before = {number: signal.signal(number, lambda *_: hear()) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
