"""The lines that stand, looked up for a batch of observed lines: which of them matches which."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from blackboard.messages.geometry import Point
from blackboard.messages.model import LineMatch, ModelLine
from blackboard.uncertainty.matrices import Array
from knowledge_sources.line_estimates import LineEstimate, from_model_line
from knowledge_sources.line_match import Difference, MatchLimits, difference, matches
from knowledge_sources.pose_correction import pose_error_seen


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observed:
    """A line of the newest batch: its id, the estimate, and where its points were sensed from, on average."""

    id: str
    line: LineEstimate
    from_x_m: float
    from_y_m: float


def best_match(
    observed: LineEstimate, lines: Mapping[str, ModelLine], at: tuple[float, float], pose: Array, limits: MatchLimits
) -> tuple[str, Difference] | None:
    """Return the nearest of those lines that match, by normal distance; of equal ones the first.

    The pose's covariance (3, 3) at the robot's place `at` adds to every difference.
    """
    error = pose_error_seen(observed.theta_rad, observed.x_m, observed.y_m, at, pose)
    best: tuple[str, Difference] | None = None
    for id_, model in lines.items():
        reach = observed.half_length_m + model.half_length_m + limits.gap_m + 1.0
        middle_x, middle_y = (model.start.x_m + model.end.x_m) / 2, (model.start.y_m + model.end.y_m) / 2
        if abs(middle_x - observed.x_m) > reach or abs(middle_y - observed.y_m) > reach:
            continue
        inherited = np.diag([model.inherited_sigma_theta_rad**2, model.inherited_sigma_rho_m**2])
        found = difference(observed, from_model_line(model), error + inherited)
        if matches(observed, found, limits) and (best is None or found.distance < best[1].distance):
            best = (id_, found)
    return best


def match_lines(
    observed: Sequence[Observed],
    model: Mapping[str, ModelLine],
    at: tuple[float, float],
    pose: Array,
    limits: MatchLimits,
) -> tuple[LineMatch, ...]:
    """Return the matches of a batch, with covariances that leave the pose's out."""
    found = []
    for seen in observed:
        best = best_match(seen.line, model, at, pose, limits)
        if best is None:
            continue
        id_, gap = best
        line = model[id_]
        inherited = np.diag([line.inherited_sigma_theta_rad**2, line.inherited_sigma_rho_m**2])
        own = seen.line.covariance + gap.model.covariance_at(-gap.along_m) + inherited
        found.append(
            LineMatch(
                observed=seen.id,
                model=id_,
                theta_rad=gap.model.theta_rad,
                middle=Point(x_m=seen.line.x_m, y_m=seen.line.y_m),
                turn_rad=gap.turn_rad,
                offset_m=gap.offset_m,
                covariance=(float(own[0, 0]), float(own[0, 1]), float(own[1, 1])),
                model_sigma_theta_rad=line.sigma_theta_rad,
                model_sigma_rho_m=line.sigma_rho_m,
            )
        )
    return tuple(found)
