"""Parameters of the joint estimate, with what each is for."""

from dataclasses import dataclass, field
from math import radians

from blackboard.parameters import require
from blackboard.uncertainty.theories import Theory
from knowledge_sources.line_estimates import NoiseFloor
from knowledge_sources.line_match import MatchLimits
from knowledge_sources.lines_in_question import QuestionParams


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLinesParams:
    """What wheels and sonars are wrong by, one sigma each; which echoes count; when two lines are one."""

    # what stays the same on a floor is estimated
    distance_scale_sigma: float = 0.03  # tyres, load
    turn_scale_sigma: float = 0.02  # width of the wheelbase
    drift_sigma_rad_per_m: float = 0.005  # wheels of unequal size: 3 degrees in 10 m
    latency_s: float = 0.05  # of sonar stamps: a ring takes part of a second to fire, and a stamp is never early
    latency_sigma_s: float = 0.05  # 0 where the latency is known
    # what changes from metre to metre
    distance_noise_m: float = 0.01  # for each root of a metre
    heading_noise_rad: float = 0.005  # for each root of a metre
    turn_noise_rad: float = 0.01  # for each root of a radian turned

    range_sigma_m: float = 0.03  # an ordinary sonar's, and walls are not straight
    range_sigma_fraction: float = 0.005
    cone_sigma_fraction: float = 0.5  # of half the cone: how wide it hears depends on what echoes
    max_range_m: float = 6.0  # further cones cover too much
    incidence_rad: float = radians(35)  # beyond it a wall throws sound away
    end_margin_m: float = 0.15  # so far beyond the end that is known a wall may still echo
    least_m: float = (
        1.0  # a shorter line may be furniture or a round thing: it moves with the state, and does not move it
    )
    gate_sigmas: float = (
        2.0  # of a line's own echoes nearly all are within one: what is beyond two is rather of something else
    )
    unsure_m: float = 0.15  # an echo that the state cannot foretell better than that says too little of whose it is
    step_m: float = (
        0.1  # echoes of one sensor from nearly the same place err alike: the next counts after moving so far
    )
    step_rad: float = 0.1
    max_turn_radps: float = (
        0.3  # turning faster than 17 degrees a second, the stamp of an echo does not tell its direction
    )
    remember_m: float = 0.2  # so far apart are the past poses that are kept: forty of them
    remember_rad: float = 0.4  # as a wall in one cone comes into the next
    beams: int = 12  # of a laser: as many as a ring of sonars has
    confidence: float = 0.999  # what all echoes of a scan say together is refused beyond this bound

    # echoes of a line to one side of it, a scan each: a shift of one sigma is found in some ten scans, chance does it once in 2500
    drag_slack_sigmas: float = 0.5
    drag_limit_sigmas: float = 6.0

    match_confidence: float = 0.99  # an observed line and a known one within this bound are one
    apart_m: float = 0.25  # nearer to each other than that two walls that face one way are one, badly seen
    apart_rad: float = radians(15)
    gap_m: float = MatchLimits().gap_m
    theta_floor_rad: float = NoiseFloor().theta_rad
    rho_floor_m: float = NoiseFloor().rho_m
    elsewhere_m: float = QuestionParams().elsewhere_m
    least_views: int = QuestionParams().least_views
    misses: int = QuestionParams().misses
    misses_of_new: int = QuestionParams().misses_of_new
    theory: Theory = QuestionParams().theory
    question: QuestionParams = field(init=False)
    floor: NoiseFloor = field(init=False)

    def __post_init__(self) -> None:
        for name in (
            "distance_scale_sigma",
            "turn_scale_sigma",
            "drift_sigma_rad_per_m",
            "latency_s",
            "latency_sigma_s",
            "distance_noise_m",
            "heading_noise_rad",
            "turn_noise_rad",
            "range_sigma_fraction",
            "cone_sigma_fraction",
        ):
            require(0.0 <= getattr(self, name) <= 1.0, name, getattr(self, name), "[0, 1]")
        for name in ("range_sigma_m", "unsure_m", "theta_floor_rad", "rho_floor_m"):
            require(0.0 < getattr(self, name) <= 1.0, name, getattr(self, name), "(0, 1]")
        for name in (
            "least_m",
            "max_turn_radps",
            "end_margin_m",
            "step_m",
            "step_rad",
            "remember_m",
            "remember_rad",
            "gap_m",
            "apart_m",
            "apart_rad",
        ):
            require(0.0 <= getattr(self, name) <= 100.0, name, getattr(self, name), "[0, 100]")
        for name in ("confidence", "match_confidence"):
            require(0.5 <= getattr(self, name) < 1.0, name, getattr(self, name), "[0.5, 1)")
        require(1 <= self.beams <= 10_000, "beams", self.beams, "[1, 10000]")
        object.__setattr__(self, "question", QuestionParams.of(self))
        require(0.0 < self.max_range_m <= 1000.0, "max_range_m", self.max_range_m, "(0, 1000] metres")
        require(0.0 <= self.incidence_rad < 1.5, "incidence_rad", self.incidence_rad, "[0, 1.5)")
        require(0.0 <= self.drag_slack_sigmas <= 10.0, "drag_slack_sigmas", self.drag_slack_sigmas, "[0, 10]")
        require(0.0 < self.drag_limit_sigmas <= 1000.0, "drag_limit_sigmas", self.drag_limit_sigmas, "(0, 1000]")
        require(0.0 < self.gate_sigmas <= 10.0, "gate_sigmas", self.gate_sigmas, "(0, 10]")
        object.__setattr__(self, "floor", NoiseFloor(theta_rad=self.theta_floor_rad, rho_m=self.rho_floor_m))
