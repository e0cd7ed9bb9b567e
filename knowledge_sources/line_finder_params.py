"""Parameters of the line finder, with what each is for."""

from dataclasses import dataclass
from math import pi, radians
from typing import Literal

from blackboard.parameters import require


@dataclass(frozen=True, slots=True, kw_only=True)
class LineFinderParams:
    """How lines are sought, and what a line must show for itself.

    What follows the first empty line is for methods "tangent" and "places", what follows the second for the one or the other.
    """

    method: Literal["tangent", "axis", "places"] = (
        "tangent"  # "places": points of a map, sensed from nobody knows where
    )
    keep_batches: int = 1000  # four hours of twelve sonars at 5 Hz; some 6,000 lines of about 1 kB
    alpha_step_rad: float = radians(1.0)  # the thesis's
    rho_step_m: float = 0.05  # the thesis's
    reach_m: float = 10.0  # largest rho: a sonar's reach (the thesis's lab: 5 m)
    min_votes: int = 10  # fewer do not prove a line however empty the rest
    chance_sigmas: float = 7.0  # each strong wall adds chance votes around its own cell, so three is too few
    cluster_fraction: float = 0.5  # of the mean of the earlier max-min distances: the thesis's
    line_distance_m: float = 0.10  # two cells of rho: what clustering leaves uncertain
    min_support: int = 10  # each of five places twice
    min_length_m: float = 0.25

    cluster_resolution_m: float = (
        0.3  # lines this far apart, 2.9 m out where the steps of alpha and rho are equal, stay apart
    )
    fit_distance_m: float = 0.05  # three to five deviations of a sonar's noise
    max_spread_m: float = 0.02  # twice a sonar's noise: echoes that spread more are of no flat wall
    max_tilt_rad: float = radians(1.3)  # so that two deviations are less than 3 degrees
    max_tilt_per_place_rad: float = radians(0.15)  # the fewer places prove a line, the surer its direction must be
    max_bend: float = 6.0  # F statistic; chance gives 4 one time in a hundred, and the best of many breaks is tried
    min_bent_spread_m: float = 0.0  # points that spread no more are not asked whether they bend
    min_places: int = 5  # two things always lie on a line, and three or four may by chance
    tolerance_sigmas: float = 2.0  # how far an echo may lie from where its wall would have sent it
    passes: int = 1  # another seeks in what the first left: a few lines more for twice the time

    max_incidence_rad: float = radians(60.0)  # so far off its normal a rough wall answers a sonar (a smooth one to 30)
    max_beam_incidence_rad: float = radians(80.0)  # further off a laser's spot is smeared over too much of the wall
    contradiction_margin_m: float = 0.06  # five deviations of a sonar's noise
    max_contradicted_fraction: float = 0.02  # of the support: cross-talk and what moves
    leftovers: int = (
        4000  # echoes of cones that no line claimed, searched together each time that half are new; 0: none
    )
    window_m: float = 5.0  # a room: a wall outvotes what else is in it; halved as long as a line fits in twice
    around_m: float = 0.15  # places so near show which way their wall runs: three times what a wall on a map is thick
    max_slenderness: float = 0.5  # places more than half as broad as long, a corner's or a chair's, show no direction
    place_turn_rad: float = radians(30.0)  # a wall may run so far off what its places show: short of half a right angle
    close_m: float = 0.1  # places so near leave no gap: a laser's beams of half a degree are so far apart at 11 m
    min_closed_fraction: float = 0.5  # of a line's length: the rest may be gaps

    def __post_init__(self) -> None:
        require(
            radians(0.1) <= self.alpha_step_rad <= radians(10.0), "alpha_step_rad", self.alpha_step_rad, "0.1 to 10 deg"
        )
        require(0.005 <= self.rho_step_m <= 1.0, "rho_step_m", self.rho_step_m, "0.005 to 1")
        require(self.rho_step_m < self.reach_m <= 100.0, "reach_m", self.reach_m, "rho_step_m to 100")
        require(0.0 < self.cluster_fraction <= 1.0, "cluster_fraction", self.cluster_fraction, "(0, 1]")
        require(self.min_support >= 3, "min_support", self.min_support, "3 and more")
        require(0.0 < self.max_incidence_rad <= pi / 2, "max_incidence_rad", self.max_incidence_rad, "(0, pi/2]")
        require(
            0.0 < self.max_beam_incidence_rad <= pi / 2,
            "max_beam_incidence_rad",
            self.max_beam_incidence_rad,
            "(0, pi/2]",
        )
        require(0.0 < self.place_turn_rad <= pi / 2, "place_turn_rad", self.place_turn_rad, "(0, pi/2]")
        for name in ("max_slenderness", "min_closed_fraction"):
            require(0.0 <= getattr(self, name) <= 1.0, name, getattr(self, name), "[0, 1]")
        for name in ("keep_batches", "min_votes", "min_places", "passes"):
            require(getattr(self, name) >= 1, name, getattr(self, name), "1 and more")
        for name in (
            "line_distance_m",
            "cluster_resolution_m",
            "fit_distance_m",
            "max_spread_m",
            "max_tilt_rad",
            "max_tilt_per_place_rad",
            "max_bend",
            "window_m",
            "around_m",
            "close_m",
        ):
            require(getattr(self, name) > 0.0, name, getattr(self, name), "more than 0")
        for name in (
            "chance_sigmas",
            "min_length_m",
            "tolerance_sigmas",
            "contradiction_margin_m",
            "max_contradicted_fraction",
            "min_bent_spread_m",
        ):
            require(getattr(self, name) >= 0.0, name, getattr(self, name), "0 and more")
