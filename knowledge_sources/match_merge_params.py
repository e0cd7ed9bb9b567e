"""Parameters of match/merge, with what each is for."""

from dataclasses import dataclass, field

from blackboard.parameters import require
from blackboard.uncertainty.theories import Theory
from knowledge_sources.line_estimates import NoiseFloor
from knowledge_sources.line_match import MatchLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchMergeParams:
    """When two lines are one, when a new one counts, and when an old one has gone."""

    wait_for_re_reference: bool = True  # false in a mission without one
    k: float = MatchLimits().k
    gap_m: float = MatchLimits().gap_m
    theta_floor_rad: float = NoiseFloor().theta_rad
    rho_floor_m: float = NoiseFloor().rho_m
    elsewhere_m: float = (
        0.5  # so far the robot must have moved for another look: what cross-talk made is then elsewhere
    )
    least_views: int = 3  # on the way through one batch, from which a line must have been in view to be missed
    misses: int = 8  # in a row: a finder that finds half of what is there misses so often once in 256 times
    misses_of_new: int = 4  # of a line not confirmed yet
    theory: Theory = "endorsements"  # that weighs the reasons for and against lines
    limits: MatchLimits = field(init=False)
    floor: NoiseFloor = field(init=False)

    def __post_init__(self) -> None:
        require(0.0 < self.theta_floor_rad <= 1.0, "theta_floor_rad", self.theta_floor_rad, "(0, 1]")
        require(0.0 < self.rho_floor_m <= 1.0, "rho_floor_m", self.rho_floor_m, "(0, 1] metres")
        require(self.elsewhere_m >= 0.0, "elsewhere_m", self.elsewhere_m, "0 and more")
        for name in ("least_views", "misses", "misses_of_new"):
            require(getattr(self, name) >= 1, name, getattr(self, name), "1 and more")
        object.__setattr__(self, "limits", MatchLimits(k=self.k, gap_m=self.gap_m))
        object.__setattr__(self, "floor", NoiseFloor(theta_rad=self.theta_floor_rad, rho_m=self.rho_floor_m))
