"""What a map builder says of the way the robot came, looking back on all of it."""

from blackboard.messages.base import Count, Fraction, Message
from blackboard.messages.geometry import PackedArray, check_array


class CorrectedPath(Message, frozen=True, kw_only=True):
    """The whole way in the map frame, as it looks from the end: `poses` is float64 (n, 4): stamp_s, x_m, y_m, heading_rad.

    `closures` loops of `candidates` places that were met again agree with their neighbours. Of the `seen_again` echoes that
    another pass over the same place could check, it contradicts `contradicted_fraction`; `closed` says whether the one is
    enough and the other little enough to believe the map, or the drift was too large to find the places again.
    """

    poses: PackedArray
    closures: Count
    candidates: Count
    seen_again: Count
    contradicted_fraction: Fraction
    closed: bool

    def __post_init__(self) -> None:
        check_array(self.poses, "float64", (None, 4), "poses")
