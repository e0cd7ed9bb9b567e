"""What every message is: a frozen, keyword-only record whose fields are checked against their types and limits."""

from typing import Annotated

from msgspec import Meta, Struct

FAR_M = 1e6  # no coordinate lies further from its origin
LONG_S = 1e10  # no stamp lies further from the clock's zero (covers Unix time)


class Message(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Base of every value that stands on the board.

    Limits are declared in the annotations below and checked when a value is posted and when one is decoded, not when it is
    built: a component may build freely and learns of a fault where it posts.
    """

    def extent(self) -> "tuple[float, float, float, float] | None":
        """Return the box (x_min, y_min, x_max, y_max) in metres, map frame, that the value covers; None if it has no place."""
        return None


Metres = Annotated[float, Meta(ge=-FAR_M, le=FAR_M)]
Length = Annotated[float, Meta(ge=0.0, le=FAR_M)]
Range = Annotated[float, Meta(ge=0.0, le=1000.0)]
Angle = Annotated[float, Meta(ge=-6.283185307179587, le=6.283185307179587)]
Seconds = Annotated[float, Meta(ge=-LONG_S, le=LONG_S)]
Duration = Annotated[float, Meta(ge=0.0, le=LONG_S)]
Speed = Annotated[float, Meta(ge=-100.0, le=100.0)]
TurnRate = Annotated[float, Meta(ge=-100.0, le=100.0)]
Fraction = Annotated[float, Meta(ge=0.0, le=1.0)]
Count = Annotated[int, Meta(ge=0, le=2**53)]
Index = Annotated[int, Meta(ge=0, le=9999)]
Name = Annotated[str, Meta(min_length=1, max_length=200)]
Text = Annotated[str, Meta(max_length=4000)]
