"""Lanes: how entries travel, by what they are for. What is posted in one lane by one host arrives in order.

Nothing in a lane ever waits for a slow reader: what does not fit is dropped on the way and asked for again, except commands,
of which only the newest is of use.
"""

from dataclasses import dataclass
from typing import Any, Literal, get_args

from blackboard.kinds import LEVELLED_PANELS, Kind

Lane = Literal["command", "signal", "knowledge", "large", "control"]
LANES: tuple[Lane, ...] = get_args(Lane)


@dataclass(frozen=True, slots=True)
class Quality:
    """How a lane travels. `priority` is zenoh's name; `express` goes at once instead of in batches; `repaired`: what was missed
    is asked for.
    """

    priority: str
    express: bool
    repaired: bool


QUALITY: dict[Lane, Quality] = {
    "command": Quality("REAL_TIME", express=True, repaired=False),
    "signal": Quality("INTERACTIVE_HIGH", express=True, repaired=True),
    "knowledge": Quality("DATA_HIGH", express=False, repaired=True),  # comes in bursts, which fit into batches only
    "large": Quality("DATA_LOW", express=False, repaired=True),
    "control": Quality("DATA", express=False, repaired=True),
}


def lane_of(kind: Kind[Any]) -> Lane:
    """Return the lane that a kind's entries travel in."""
    return "large" if kind.large else lane_of_place(f"{kind.panel}/{kind.level or kind.name}")


def lane_of_place(place: str) -> Lane:
    """Return the lane of what is not large and belongs to a panel and level, or panel and kind."""
    panel, _, level = place.partition("/")
    if panel == "commands":
        return "command"
    if panel == "control":
        return "control"
    return "signal" if level == "signal" and panel in LEVELLED_PANELS else "knowledge"
