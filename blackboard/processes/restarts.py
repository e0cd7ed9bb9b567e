"""When a process that ended is started again."""

from collections.abc import Sequence
from typing import Literal

Restart = Literal["always", "on-failure", "never"]
FIRST_S = 0.0  # the first time at once: a robot waits for it
LATER_S = 0.25  # doubled with every further end inside the span
LONGEST_S = 5.0


def pause_s(
    policy: Restart, failed: bool, ends_s: Sequence[float], now_s: float, limit: int, within_s: float
) -> float | None:
    """Return how long to wait before starting it again; None: it stays down.

    `ends_s` are the stamps at which it ended unexpectedly, this time included; more than `limit` within `within_s` are too many.
    """
    if policy == "never" or (policy == "on-failure" and not failed):
        return None
    recent = sum(1 for end_s in ends_s if now_s - end_s < within_s)
    if recent > limit:
        return None
    return FIRST_S if recent <= 1 else min(LONGEST_S, LATER_S * 2.0 ** (recent - 2))
