"""Parameters of match/merge, with what each is for."""

from dataclasses import dataclass, field

from blackboard.parameters import require
from blackboard.uncertainty.theories import Theory
from knowledge_sources.line_estimates import NoiseFloor
from knowledge_sources.line_match import MatchLimits
from knowledge_sources.lines_in_question import QuestionParams


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchMergeParams:
    """When two lines are one, when a new one counts, and when an old one has gone."""

    wait_for_re_reference: bool = True  # false in a mission without one
    k: float = MatchLimits().k
    gap_m: float = MatchLimits().gap_m
    theta_floor_rad: float = NoiseFloor().theta_rad
    rho_floor_m: float = NoiseFloor().rho_m
    elsewhere_m: float = QuestionParams().elsewhere_m
    least_views: int = QuestionParams().least_views
    misses: int = QuestionParams().misses
    misses_of_new: int = QuestionParams().misses_of_new
    theory: Theory = QuestionParams().theory
    question: QuestionParams = field(init=False)
    limits: MatchLimits = field(init=False)
    floor: NoiseFloor = field(init=False)

    def __post_init__(self) -> None:
        require(0.0 < self.theta_floor_rad <= 1.0, "theta_floor_rad", self.theta_floor_rad, "(0, 1]")
        require(0.0 < self.rho_floor_m <= 1.0, "rho_floor_m", self.rho_floor_m, "(0, 1] metres")
        object.__setattr__(self, "question", QuestionParams.of(self))
        object.__setattr__(self, "limits", MatchLimits(k=self.k, gap_m=self.gap_m))
        object.__setattr__(self, "floor", NoiseFloor(theta_rad=self.theta_floor_rad, rho_m=self.rho_floor_m))
