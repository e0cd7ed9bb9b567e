"""What is in doubt and what is done about it: verdicts on hypotheses, resolution tasks, changes, objects with a part."""

from math import pi
from typing import Annotated, Literal

from msgspec import Meta

from blackboard.messages.base import Angle, Count, Fraction, Length, Message, Name, Seconds, Text
from blackboard.messages.geometry import Point

Extent = tuple[float, float, float, float]


class Verdict(Message, frozen=True, kw_only=True):
    """What a theory of uncertainty makes of the endorsements of a hypothesis, given by its key; it stands as long as that does.

    `lacking` names what nobody speaks for yet; that may be seen from near `look_from`, or will show by `wait_until_s`.
    """

    hypothesis: Name
    theory: Literal["endorsements", "certainty-factors", "dempster-shafer", "bayes", "fuzzy"]
    outcome: Literal["confirmed", "denied", "unresolved"]
    belief: Fraction
    plausibility: Fraction
    lacking: Annotated[tuple[Name, ...], Meta(max_length=100)] = ()
    place: Point | None = None
    look_from: Point | None = None
    wait_until_s: Seconds | None = None

    def extent(self) -> Extent | None:
        return None if self.place is None else self.place.extent()


class ResolutionTask(Message, frozen=True, kw_only=True):
    """What is to be done to resolve a hypothesis (its key): look at `place` again, from `stand` if known, or wait and see.

    It is not worth going there before `not_before_s`; what is open at `until_s` is given up.
    """

    hypothesis: Name
    todo: Literal["look again", "wait and see"]
    outcome: Literal["open", "confirmed", "denied", "given up"]
    opened_s: Seconds
    not_before_s: Seconds
    until_s: Seconds
    place: Point | None = None
    stand: Point | None = None
    closed_s: Seconds | None = None
    detail: Text = ""

    def extent(self) -> Extent | None:
        return None if self.place is None else self.place.extent()


class Change(Message, frozen=True, kw_only=True):
    """The map and what is seen differ: something appeared where floor was, or what stood there is gone.

    Once `accepted`, that is how the world is.
    """

    change: Literal["appeared", "gone"]
    place: Point
    size_m: Length
    first_s: Seconds
    accepted: bool = False

    def extent(self) -> Extent:
        half = self.size_m / 2
        return (self.place.x_m - half, self.place.y_m - half, self.place.x_m + half, self.place.y_m + half)


class TwoPartObject(Message, frozen=True, kw_only=True):
    """A round body with a part on one side, as a mug has a handle: `part_bearing_rad` says where it is, once it was seen.

    `looked_rad` is how much of the way round was looked at for it.
    """

    model: Name
    place: Point
    body_radius_m: Length
    part_bearing_rad: Angle | None = None
    looked_rad: Annotated[float, Meta(ge=0.0, le=2 * pi + 1e-9)] = 0.0
    scans: Count = 0

    def extent(self) -> Extent:
        x, y, r = self.place.x_m, self.place.y_m, self.body_radius_m
        return (x - r, y - r, x + r, y + r)
