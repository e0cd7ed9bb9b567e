"""What looking back on a whole drive comes to, and whether to believe it."""

from dataclasses import dataclass

from knowledge_sources.laser_graph.odometry_model import OdometryModel
from knowledge_sources.laser_graph.poses import Floats

CONTRADICTED_AT_MOST = 0.2  # with keyframes off by 0.1 m it is a sixth, by 0.2 m a quarter; in wrong maps half and more
FITTING_AT_LEAST = (
    0.15  # where a drive closed, it is a fifth for cones in clutter and most elsewhere; in wrong maps a tenth
)


@dataclass(frozen=True, eq=False)
class Solution:
    """Keyframes (n, 3) in the map, odometry's errors as they look from the end, what closed the loops and what speaks against.

    Of the `seen_again` echoes that another pass over the same place could check, it contradicts `contradicted_fraction`.
    """

    poses: Floats
    model: OdometryModel
    closures: int
    candidates: int
    seen_again: int
    contradicted_fraction: float

    @property
    def fitting_fraction(self) -> float:
        """How many of the places that seem to be met again look like it; 1 where there are none."""
        return self.closures / self.candidates if self.candidates else 1.0

    @property
    def closed(self) -> bool:
        """Say whether the passes over each place agree, or there was no second one."""
        return self.contradicted_fraction <= CONTRADICTED_AT_MOST and self.fitting_fraction >= FITTING_AT_LEAST
